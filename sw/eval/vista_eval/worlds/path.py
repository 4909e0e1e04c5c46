"""The path of a flight as points, and how near to it something stands."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from vista_eval.render.course import Course
from vista_eval.render.scene import Cylinder, Mesh, Panel, Solid, Sphere, Thing, bounds_m

STEP_M = 0.5
AHEAD_M = 100.0  # as far as the collision volume reaches from the last frame
# Things stand at least that far off the path, and by that share of the distance ahead of the last frame more:
# gusts and sway turn the direction of flight by a degree, in one frame of a hundred by three.
CLEAR_M, CLEAR_PER_M = 4.5, 0.03


@dataclass(frozen=True)
class Path:
    points_m: np.ndarray  # (N, 3), from the first frame on, STEP_M apart
    clear_m: np.ndarray  # (N,) distance within which nothing may stand beside the path
    flown: int  # points up to the last frame

    def until(self, x_m: float) -> Path:
        """What comes before `x_m`."""
        kept = self.points_m[:, 0] <= x_m
        return replace(self, points_m=self.points_m[kept], clear_m=self.clear_m[kept])

    def y_m(self, x_m: float) -> float:
        return float(np.interp(x_m, self.points_m[:, 0], self.points_m[:, 1]))


def path_of(course: Course) -> Path:
    """Flown, and AHEAD_M further as the manoeuvre goes on in still air."""
    flown = np.array([course.state_at(k).world_from_body[:3, 3] for k in range(course.frames)])
    begin_s = -course.last_range_m / course.speed_m_s
    times_s = begin_s + np.linspace(0, AHEAD_M / course.speed_m_s, round(AHEAD_M / STEP_M))
    ahead = np.array([course.path_m(float(t)) for t in times_s])
    # A drift that is left at the last frame is gone where the path meets the target.
    left = np.clip(times_s / begin_s, 0, 1)[:, None]
    corners = np.vstack([flown, ahead[1:] + left[1:] * (flown[-1] - ahead[0])])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    at = np.arange(0.0, along[-1], STEP_M)
    points = np.stack([np.interp(at, along, column) for column in corners.T], axis=1)
    end_m = along[course.frames - 1]
    return Path(points, CLEAR_M + CLEAR_PER_M * np.maximum(0.0, at - end_m), int(np.sum(at <= end_m)))


def samples(solid: Solid) -> tuple[np.ndarray, float]:
    """Points on the solid about a step apart, and the radius of matter around each."""
    match solid:
        case Cylinder():
            return _between(np.array([solid.start_m]), np.array([solid.end_m])), solid.radius_m
        case Sphere():
            return np.array([solid.center_m]), solid.radius_m
        case Mesh():
            corners = solid.vertices_m[solid.faces].astype(float)
            return np.concatenate([solid.vertices_m.astype(float), *_inner(corners)]), 0.0
        case Panel():
            center = np.array(solid.center_m)
            return _flat(center, np.array(solid.half_right_m), np.array(solid.half_down_m)), 0.0
        case _:
            raise TypeError(f"{solid.name}: ground, which is beside no path")


def _between(start_m: np.ndarray, end_m: np.ndarray) -> np.ndarray:
    count = 2 + int(np.linalg.norm(end_m - start_m) / STEP_M)
    t = np.linspace(0, 1, count)[:, None]
    return start_m + t * (end_m - start_m)


def _flat(center_m: np.ndarray, half_u: np.ndarray, half_v: np.ndarray) -> np.ndarray:
    u, v = (np.linspace(-1, 1, 2 + int(2 * np.linalg.norm(half) / STEP_M)) for half in (half_u, half_v))
    grid = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    return center_m + grid @ np.stack([half_u, half_v])


def _inner(corners_m: np.ndarray) -> Iterator[np.ndarray]:
    """Points within those triangles (N, 3, 3) that are longer than a step."""
    sides = np.linalg.norm(corners_m - np.roll(corners_m, 1, axis=1), axis=2).max(axis=1)
    for corners, side in zip(corners_m[sides > STEP_M], sides[sides > STEP_M], strict=True):
        yield _weights(2 + int(side / STEP_M)) @ corners


@functools.cache
def _weights(count: int) -> np.ndarray:
    """(N, 3) barycentric coordinates of the points of a triangle with so many on each side."""
    t = np.linspace(0, 1, count)
    return np.array([(a, b, 1 - a - b) for a in t for b in t if a + b <= 1 + 1e-9])


def nearness_m(solid: Solid, path: Path) -> float:
    """The distance of the solid from the path less what has to be clear: negative in the way.

    Of what is far off, a lower bound."""
    low, high = bounds_m(solid)
    outside = np.maximum(np.maximum(low - path.points_m, path.points_m - high), 0.0)
    box_m = np.linalg.norm(outside, axis=1) - path.clear_m
    if not len(box_m) or box_m.min() > 0.0:
        return float(box_m.min(initial=np.inf))
    near = box_m <= 0.0
    points, radius_m = samples(solid)
    away_m = np.full(len(points), np.inf)
    for place, clear_m in zip(path.points_m[near], path.clear_m[near], strict=True):
        away_m = np.minimum(away_m, np.linalg.norm(points - place, axis=1) - clear_m)
    return float(away_m.min()) - radius_m


def stands_clear(thing: Thing, path: Path) -> bool:
    return all(nearness_m(solid, path) > 0.0 for solid in thing.solids)


def clear_of(path: Path, things: Iterable[Thing]) -> list[Thing]:
    """Those that leave the path free."""
    return [thing for thing in things if stands_clear(thing, path)]


def distance_m(thing: Thing, point_m: np.ndarray) -> float:
    """The distance from the nearest of the thing's solids."""
    parts = [samples(solid) for solid in thing.solids]
    return min(float(np.linalg.norm(points - point_m, axis=1).min()) - radius_m for points, radius_m in parts)
