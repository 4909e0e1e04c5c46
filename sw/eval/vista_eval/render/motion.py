"""Places the solids of a scene at a given time: things that move, and things that sway in the wind."""

from __future__ import annotations

import math
from dataclasses import replace
from zlib import crc32

import numpy as np

from vista_eval.render.scene import Cylinder, GroundStrip, HeightField, Mesh, Scene, Solid, Sway, Thing


def moves(thing: Thing) -> bool:
    return thing.sway is not None or any(thing.velocity_m_s)


def moved(solid: Solid, by_m: np.ndarray) -> Solid:
    match solid:
        case Mesh():
            return replace(solid, vertices_m=solid.vertices_m + by_m)
        case Cylinder():
            start, end = (tuple(np.add(point, by_m)) for point in (solid.start_m, solid.end_m))
            return replace(solid, start_m=start, end_m=end)
        case GroundStrip() | HeightField():
            raise ValueError(f"{solid.name}: the ground does not move")
        case _:
            return replace(solid, center_m=tuple(np.add(solid.center_m, by_m)))


def is_trunk(solid: Solid) -> bool:
    return isinstance(solid, Cylinder) and solid.start_m[2] != solid.end_m[2]


def sway_m(sway: Sway, solid: Solid, t_s: float) -> np.ndarray:
    """The sway to and fro, mostly across the flight; every solid in its own phase and a little off the
    frequency."""
    own = crc32(solid.name.encode()) / 2**32
    phase = 2 * math.pi * (own + (0.85 + 0.3 * own) * sway.frequency_hz * t_s)
    return sway.amplitude_m * np.array(
        [0.3 * math.sin(0.7 * phase), math.sin(phase), 0.2 * math.sin(1.3 * phase)]
    )


def solids_at(thing: Thing, t_s: float) -> tuple[Solid, ...]:
    """The solids of one thing, `t_s` after the last frame: before it, that is, `t_s` < 0."""
    if not moves(thing):
        return thing.solids
    travel_m = np.array(thing.velocity_m_s) * t_s
    offsets = [
        travel_m + sway_m(thing.sway, solid, t_s) if thing.sway and not is_trunk(solid) else travel_m
        for solid in thing.solids
    ]
    return tuple(moved(solid, offset) for solid, offset in zip(thing.solids, offsets, strict=True))


def is_static(scene: Scene) -> bool:
    return not any(moves(thing) for thing in scene.things)
