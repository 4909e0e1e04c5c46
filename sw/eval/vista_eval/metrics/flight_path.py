"""The path that the aircraft flies from a frame on, and what lies how far along and beside it.

A straight path is the whole flight's direction of travel. A true one leads through the true positions of the
frames that follow; beyond the last one it goes on with the speed and the turn rate of the flight's last two
seconds. An aircraft that gusts or its own sway move about seems to turn for a while, the more so the slower
it flies: the turn goes on only if the last second, the last two and the last four agree that there is one, to
one side.

It is followed as far as the host follows its own (motion.h): for the length of the collision volume, up to
where it has left its tangent by the collision radius over the uncertainty of its curvature, and for a quarter
of a circle at most.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.geometry import Array, Pose

from vista_eval.metrics.rules import CURVATURE_UNCERTAINTY, SPEED_MIN_M_S, TURN_MIN_DEG_S

CYLINDER_RADIUS_M, CYLINDER_LENGTH_M = 2.0, 100.0
LATEST_S = 2.0  # that speed and turn rate beyond the last frame are taken from
AGREEING_S = (1.0, 2.0, 4.0)  # in all of which, as far as they have been flown, a turn turns
FEWEST_POSITIONS = 3  # fewer tell nothing of a turn
TANGENT_M = 5.0  # flown, over which a path's direction is taken
SIMPLIFIED_M = 0.01  # that corners left out are beside the path

Floats = NDArray[np.floating]


@dataclass(frozen=True)
class Straight:
    """A path from the camera along a direction, without end."""

    direction: Array  # unit vector, world

    def measure(
        self, world_from_camera: Pose, x: Floats, y: Floats, depth_m: Floats
    ) -> tuple[Floats, Floats]:
        """Metres beside the path and along it, of points on rays (x, y, 1)."""
        d = (world_from_camera.rotation.T @ self.direction).astype(np.float32)
        along_m = depth_m * (x * d[0] + y * d[1] + d[2])
        square_m2 = depth_m**2 * (x * x + y * y + 1)
        return np.sqrt(np.maximum(square_m2 - along_m**2, 0)), along_m


@dataclass(frozen=True)
class Curved:
    """A chain of chords, which goes on straight before its start and beyond its end."""

    corners_m: Array  # (n, 3) world
    times_s: Array  # (n,) from now on

    @property
    def length_m(self) -> float:
        return float(np.linalg.norm(np.diff(self.corners_m, axis=0), axis=1).sum())

    @property
    def speed_m_s(self) -> float:
        """The mean speed over its whole length; 0 of a camera that stands."""
        duration_s = self.times_s[-1] - self.times_s[0]
        return self.length_m / float(duration_s) if duration_s > 0.0 else 0.0

    def height_m(self, along_m: Floats) -> Floats:
        """How high in the world the path is, at distances along it."""
        flown_m = np.cumsum(np.linalg.norm(np.diff(self.corners_m, axis=0), axis=1))
        return np.interp(along_m, np.concatenate([[0.0], flown_m]), self.corners_m[:, 2])

    def relative_to(self, velocity_m_s: Array) -> Curved:
        """The path as something sees it that moves with this velocity, and is now where it is now."""
        return replace(self, corners_m=self.corners_m - self.times_s[:, np.newaxis] * velocity_m_s)

    def measure(
        self, world_from_camera: Pose, x: Floats, y: Floats, depth_m: Floats
    ) -> tuple[Floats, Floats]:
        rays = np.stack([x, y, np.ones_like(x)], axis=-1) * depth_m[:, np.newaxis]
        points_m = rays @ world_from_camera.rotation.T.astype(np.float32)
        return self.beside(points_m, world_from_camera.translation_m)

    def beside(self, points_m: Floats, origin_m: Array) -> tuple[Floats, Floats]:
        """Metres beside the path and along it, of (n, 3) points given from an origin; infinite and 0 of what
        lies farther than REACH_M, along each axis of the world, from every chord."""
        corners_m = (self.corners_m - origin_m).astype(np.float32)
        aside_m = np.full(len(points_m), np.inf, np.float32)
        along_m = np.zeros(len(points_m), np.float32)
        near = (points_m >= corners_m.min(axis=0) - REACH_M) & (points_m <= corners_m.max(axis=0) + REACH_M)
        around = np.flatnonzero(near.all(axis=1))
        axis = int(np.argmax(np.ptp(corners_m, axis=0)))  # along it each chord has a slice of what is around
        around = around[np.argsort(points_m[around, axis])]
        places_m = points_m[around, axis]
        flown_m = 0.0
        for k, (start_m, end_m) in enumerate(pairwise(corners_m)):
            length_m = float(np.linalg.norm(end_m - start_m))
            if length_m == 0.0:
                continue
            low_m, high_m = sorted((start_m[axis], end_m[axis]))
            here = around[slice(*np.searchsorted(places_m, (low_m - REACH_M, high_m + REACH_M)))]
            direction = (end_m - start_m) / length_m
            offset_m = points_m[here] - start_m
            on_chord_m = np.clip(
                offset_m @ direction,
                -np.inf if k == 0 else 0.0,
                np.inf if k == len(corners_m) - 2 else length_m,
            )
            distance_m = np.linalg.norm(offset_m - on_chord_m[:, np.newaxis] * direction, axis=1)
            nearer = distance_m < aside_m[here]
            aside_m[here[nearer]] = distance_m[nearer]
            along_m[here[nearer]] = flown_m + on_chord_m[nearer]
            flown_m += length_m
        return aside_m, along_m


REACH_M = 2.0 * CYLINDER_RADIUS_M
FlightPath = Straight | Curved


def flight_direction(poses: list[Pose]) -> Array:
    """Unit vector of the whole flight's travel, world; of a still camera its optical axis."""
    travel_m = poses[-1].translation_m - poses[0].translation_m
    length_m = float(np.linalg.norm(travel_m))
    return travel_m / length_m if length_m > 1e-6 else poses[0].rotation[:, 2]


def true_paths(poses: list[Pose], times_ns: tuple[int, ...]) -> list[Curved]:
    """The path that is flown from each frame on; poses: of the left camera, true."""
    positions_m = np.array([pose.translation_m for pose in poses])
    times_s = (np.array(times_ns) - times_ns[0]) / 1e9
    beyond_m, beyond_s = _beyond(positions_m, times_s)
    all_m, all_s = np.concatenate([positions_m, beyond_m]), np.concatenate([times_s, beyond_s])
    paths = []
    for k, pose in enumerate(poses):
        if len(beyond_m):
            paths.append(_followed(all_m[k:], all_s[k:] - all_s[k]))
        else:
            end_m = pose.translation_m + CYLINDER_LENGTH_M * pose.rotation[:, 2]
            paths.append(Curved(np.array([pose.translation_m, end_m]), np.zeros(2)))
    return paths


def _beyond(positions_m: Array, times_s: Array) -> tuple[Array, Array]:
    """Positions and times after the last frame, for the length of the collision volume; none if it stands."""
    turns = _turns(positions_m, times_s)
    latest = times_s >= times_s[-1] - LATEST_S
    positions_m, times_s = positions_m[latest], times_s[latest]
    duration_s = float(times_s[-1] - times_s[0])
    travel_m = positions_m[-1] - positions_m[0]
    if duration_s <= 0.0 or float(np.linalg.norm(travel_m)) < SPEED_MIN_M_S * duration_s:
        return np.zeros((0, 3)), np.zeros(0)
    speed_m_s = float(np.linalg.norm(np.diff(positions_m, axis=0), axis=1).sum()) / duration_s
    turn_rad_s = _turn_rate(positions_m, times_s) if turns else np.zeros(3)
    direction = travel_m / np.linalg.norm(travel_m)  # that of the middle of the time
    direction = _turned(direction, turn_rad_s * 0.5 * duration_s)
    step_s = min(duration_s / (len(times_s) - 1), 1.0 / speed_m_s)
    steps = int(np.ceil(CYLINDER_LENGTH_M / (speed_m_s * step_s)))
    position_m, found = positions_m[-1], []
    for k in range(steps):
        position_m = position_m + speed_m_s * step_s * _turned(direction, turn_rad_s * (k + 0.5) * step_s)
        found.append(position_m)
    return np.array(found), times_s[-1] + step_s * np.arange(1, steps + 1)


def _turns(positions_m: Array, times_s: Array) -> bool:
    """Whether the flight ends in a turn. Where fewer seconds were flown, the longer times are all of them."""
    rates = [
        _turn_rate(positions_m[latest], times_s[latest])
        for latest in (times_s >= times_s[-1] - latest_s for latest_s in AGREEING_S)
        if np.count_nonzero(latest) >= FEWEST_POSITIONS
    ]
    return all(float(rate @ rates[-1]) > 0.0 for rate in rates)


def _turn_rate(positions_m: Array, times_s: Array) -> Array:
    """Axis times rate in rad/s of the direction of travel between the two halves of the time; 0 where it is
    less than what counts as a turn."""
    middle_s = 0.5 * (times_s[0] + times_s[-1])
    middle_m = np.array([np.interp(middle_s, times_s, along) for along in positions_m.T])
    first, second = middle_m - positions_m[0], positions_m[-1] - middle_m
    axis = np.cross(first, second)
    sine_size = float(np.linalg.norm(axis))
    least_rad_s = np.radians(TURN_MIN_DEG_S)
    rate_rad_s = float(np.arctan2(sine_size, first @ second)) / (middle_s - times_s[0])
    return axis / sine_size * rate_rad_s if rate_rad_s >= least_rad_s else np.zeros(3)


def _turned(direction: Array, rotation: Array) -> Array:
    return np.asarray(cv2.Rodrigues(rotation)[0] @ direction, np.float64)


def _followed(corners_m: Array, times_s: Array) -> Curved:
    """The path up to where the host gives up following it."""
    flown_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners_m, axis=0), axis=1))])
    tangent = np.array([np.interp(TANGENT_M, flown_m, along) for along in corners_m.T]) - corners_m[0]
    tangent /= np.linalg.norm(tangent)
    offset_m = corners_m - corners_m[0]
    left_m = np.linalg.norm(offset_m - np.outer(offset_m @ tangent, tangent), axis=1)
    farthest_m = CYLINDER_RADIUS_M / CURVATURE_UNCERTAINTY
    ahead = np.diff(offset_m @ tangent, append=np.inf) > 0.0
    beyond = (flown_m > CYLINDER_LENGTH_M) | (left_m > farthest_m) | ~ahead
    last = max(int(np.argmax(beyond)) if beyond.any() else len(flown_m) - 1, 1)
    corners_m, times_s, flown_m = (
        corners_m[: last + 1].copy(),
        times_s[: last + 1].copy(),
        flown_m[: last + 1],
    )
    end_m = min(CYLINDER_LENGTH_M, flown_m[-1])
    corners_m[-1] = [np.interp(end_m, flown_m, along) for along in corners_m.T]
    times_s[-1] = np.interp(end_m, flown_m, times_s)
    kept = _corners(np.column_stack([corners_m, times_s]))
    return Curved(corners_m[kept], times_s[kept])


def _corners(points: Array) -> NDArray[np.intp]:
    """Those that a chain of chords needs to keep within SIMPLIFIED_M, or as many seconds, of all others
    (Douglas and Peucker)."""
    kept, waiting = {0, len(points) - 1}, [(0, len(points) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        chord = points[last] - points[first]
        between = points[first : last + 1] - points[first]
        share = (between @ chord / max(float(chord @ chord), 1e-12))[:, np.newaxis]
        off = np.linalg.norm(between - share * chord, axis=1)
        worst = int(np.argmax(off))
        if off[worst] > SIMPLIFIED_M:
            kept.add(first + worst)
            waiting += [(first, first + worst), (first + worst, last)]
    return np.array(sorted(kept))
