"""The point where a collision volume that travels along a path first meets a surface.

The volume is what a ball of the collision radius sweeps, its centre on the path: it touches the point that
lies `along` the path and `aside` of it when its centre is at along - sqrt(radius^2 - aside^2). A wall across
the path is met where the path meets it, a slope of inclination a where the ball rests on it, radius cos(a)
below the path.

Ground that is flown along is not met: the ball is no larger than a share of the distance between the path and
the nearest of the ground that is seen, up to the first that is seen beneath the path. A camera that rolls or
turns sees what is nearest along the path in a corner of its image, beside the path and so farther from it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CLEARANCE_SHARE = 0.8
NEAREST_SHARE = 1.02  # of the distance along the path of the nearest that is seen beneath it
BENEATH_SHARE = 0.9  # of its distance from the path, by which a point beneath it is lower

Floats = NDArray[np.floating]


def contact(aside_m: Floats, along_m: Floats, radius_m: float, count: int) -> NDArray[np.intp] | None:
    """Which `count` of a thing's points are met first; None: fewer lie within the radius."""
    within = np.flatnonzero((aside_m <= radius_m) & (along_m > 0.0))
    if len(within) < count:
        return None
    center_m = along_m[within] - np.sqrt(radius_m**2 - aside_m[within] ** 2)
    return within[np.argpartition(center_m, count - 1)[:count]]


def ground_radius_m(aside_m: Floats, along_m: Floats, drop_m: Floats, radius_m: float) -> float:
    """The radius of the ball for the ground whose points these are: all that are seen; drop_m: how much lower
    than the path each is."""
    ahead = along_m > 0.0
    if not ahead.any():
        return radius_m
    beneath = ahead & (drop_m >= BENEATH_SHARE * aside_m)
    first_m = along_m[beneath if beneath.any() else ahead].min()
    near = ahead & (along_m <= NEAREST_SHARE * first_m)
    return min(radius_m, CLEARANCE_SHARE * float(aside_m[near].min()))
