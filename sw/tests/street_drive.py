"""A real street (KITTI odometry 00, 51 frames): what stands there, where the car drove, and the chain on it.

The things were picked by eye in the images; their places are those of the images' own stereo at close range,
in the world of the poses (the first camera: x right, y down, z forward). The path is the camera's positions
of the frame and of all later frames, joined by straight lines; where the recording ends it goes on straight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from shared_data import SHARED_DATA
from vista import parameters
from vista.chain import make_chain, run_frame
from vista.geometry import Array
from vista.pipeline import Obstacle, Result
from vista.sequence import open_sequence

SEQUENCE = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
OFF_PATH_M = 2.0
STRAIGHT_M = 5.0  # over this way the last direction of the path is measured
ENDLESS_M = 1000.0
CAR_HALF_WIDTH_M = 1.0
CAMERA_HEIGHT_M = 1.65


@dataclass(frozen=True)
class Thing:
    name: str
    x_m: float
    z_m: float
    first: int  # frames in which it is in view and has been for long enough to be confirmed
    last: int

    @property
    def frames(self) -> range:
        return range(self.first, self.last + 1)


THINGS = (
    Thing("parked car, left behind", 3.3, 12.9, 3, 6),
    Thing("parked car ahead", 2.8, 36.2, 4, 24),
    Thing("billboard", -8.2, 15.4, 3, 4),
    Thing("first tree", -3.2, 13.2, 3, 8),
    Thing("second tree", -3.8, 26.8, 4, 17),
    Thing("third tree", -4.6, 40.8, 6, 28),
    Thing("fourth tree", -3.9, 54.7, 17, 42),
    Thing("tree at the scaffolding", 8.2, 45.6, 5, 29),
    Thing("conifer", -13.2, 41.1, 8, 22),
    Thing("near lamp post", -3.0, 20.3, 4, 14),
    Thing("far lamp post", -3.5, 47.7, 7, 34),
    Thing("warning sign", 3.2, 42.7, 17, 32),
)


def driven_path_m() -> np.ndarray:
    """(frames, 3): where the camera was."""
    return np.array([frame.world_from_camera.translation_m for frame in open_sequence(SEQUENCE).frames])


def run_street(values: parameters.Values) -> list[Result]:
    sequence = open_sequence(SEQUENCE)
    chain = make_chain(sequence, "golden", values, threads=1)
    return [run_frame(chain, files).result for files in sequence.frames]


def ids_at(thing: Thing, result: Result, away_m: float) -> set[int]:
    """Confirmed obstacles at the thing's place, as far as stereo tells at that range."""
    return {
        o.id
        for o in result.obstacles
        if o.confirmed
        and abs(o.position_m[0] - thing.x_m) < 1.0 + 0.02 * away_m
        and abs(o.position_m[2] - thing.z_m) < 1.0 + 0.06 * away_m
    }


def common_ids(thing: Thing, results: list[Result], path_m: Array) -> set[int]:
    """Ids that the thing has in each frame in which it is in view."""
    return set.intersection(*(ids_at(thing, results[i], thing.z_m - path_m[i, 2]) for i in thing.frames))


def ghosts_on_the_road(results: list[Result], path_m: Array) -> list[tuple[int, int, float, float]]:
    """(frame, id, x, z) of confirmed obstacles in the space that the car's own body swept later."""
    ghosts = []
    for frame, result in enumerate(results):
        for o in result.obstacles:
            x, y, z = o.position_m
            if not o.confirmed or not path_m[frame, 2] < z < path_m[-1, 2]:
                continue
            nearest = path_m[np.argmin(np.abs(path_m[:, 2] - z))]
            if abs(x - nearest[0]) < CAR_HALF_WIDTH_M and abs(y - nearest[1]) < CAMERA_HEIGHT_M:
                ghosts.append((frame, o.id, round(x, 1), round(z, 1)))
    return ghosts


@dataclass(frozen=True)
class Aside:
    """A warning of what the vehicle did not meet."""

    frame: int
    id: int
    distance_m: float  # from the camera
    aside_m: float  # between the obstacle and the path driven next
    beyond: bool  # the recording ended before the vehicle came to it


def warnings_beside_the_path(results: list[Result], path_m: Array) -> list[Aside]:
    """path_m: (frames, 3), where the camera was."""
    found, direction = [], last_direction(path_m)
    for frame, result in enumerate(results):
        for o in result.obstacles:
            if not (o.confirmed and o.in_collision_volume):
                continue
            aside_m = aside_of(o, path_m[frame:], direction)
            if aside_m > OFF_PATH_M:
                beyond = bool(direction @ (o.position_m - path_m[-1]) > 0.0)
                found.append(Aside(frame, o.id, o.distance_m, round(aside_m, 2), beyond))
    return found


def last_direction(path_m: Array) -> Array:
    """The direction of travel at the end of the path: from the last position that lies STRAIGHT_M before
    it."""
    away_m = np.linalg.norm(path_m - path_m[-1], axis=1)
    before = np.flatnonzero(away_m >= STRAIGHT_M)
    step = path_m[-1] - path_m[before[-1] if len(before) else 0]
    return step / max(float(np.linalg.norm(step)), 1e-9)


def aside_of(obstacle: Obstacle, path_m: Array, direction: Array) -> float:
    """Distance of the obstacle's rectangle from the path, metres. direction: in which the path goes on."""
    position_m, (width_m, height_m) = obstacle.position_m, obstacle.extent_m
    sight = (position_m - path_m[0])[[0, 2]]
    across = np.array([-sight[1], sight[0]]) / max(float(np.hypot(*sight)), 1e-9)
    path_m = np.vstack([path_m, path_m[-1] + ENDLESS_M * direction])
    start, step = path_m[:-1], np.diff(path_m, axis=0)
    length2 = np.maximum(np.einsum("ij,ij->i", step, step), 1e-12)
    nearest = np.inf
    for share in np.linspace(-0.5, 0.5, 21):  # of its width
        point_m = position_m + share * width_m * np.array([across[0], 0.0, across[1]])
        along = np.clip(np.einsum("ij,ij->i", point_m - start, step) / length2, 0.0, 1.0)
        gap = point_m - (start + along[:, np.newaxis] * step)
        above = np.maximum(np.abs(gap[:, 1]) - 0.5 * height_m, 0.0)
        nearest = min(nearest, float(np.sqrt(gap[:, 0] ** 2 + above**2 + gap[:, 2] ** 2).min()))
    return nearest


def warned_frames(results: list[Result]) -> int:
    return sum(any(o.confirmed and o.in_collision_volume for o in result.obstacles) for result in results)


def coasting_share(results: list[Result]) -> float:
    """The share of the confirmed obstacle-frames in which the obstacle was not seen; NaN without any."""
    confirmed = [o.coasting for result in results for o in result.obstacles if o.confirmed]
    return float(np.mean(confirmed)) if confirmed else float("nan")
