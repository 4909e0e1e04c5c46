"""A vote of the last frames on each place ahead, with neither regions nor tracks nor a ground.

Places lie a metre apart along the direction of the last two poses. In each of the last six frames a place
has a vote if enough of the words around it have its disparity. The first place with four votes is warned of,
so a frame has one warning at most. It knows of no free space.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from vista.chain import Step
from vista.engine import SCALE, Disparity
from vista.geometry import Array, Calibration, Pose
from vista.history import FrameRecord
from vista.pipeline import ID_PLACE, Nearest, Obstacle

from vista_eval.fly import judged

PLACES_M = np.arange(8.0, 53.0)
FRAMES, VOTES = 6, 4
RADIUS_M = 1.6
EVERY_PX = 2
LEAST_WORDS, LEAST_SHARE = 3, 0.02  # that a vote takes; the share is of all pixels around the place
NEAR_PX, NEAR_SHARE = 0.75, 0.03  # of the place's disparity
NEAREST_M = 1.0  # along the optical axis, of a place that is looked at

Kept = tuple[Disparity, Pose]  # words, world_from_camera


def vote(camera: Calibration, steps: Iterable[Step]) -> Iterator[FrameRecord]:
    """The records of a flight, with this for all that is in the way."""
    kept: deque[Kept] = deque(maxlen=FRAMES)
    for step in steps:
        if step.world_from_camera is not None:
            kept.append((step.result.words, step.world_from_camera))
        yield with_warning(judged(step), camera, first_place_m(camera, kept))


def first_place_m(camera: Calibration, kept: deque[Kept]) -> Array | None:
    """(3,), in the world."""
    if len(kept) < VOTES:
        return None
    (_, before), (_, now) = kept[-2], kept[-1]
    travel_m = now.translation_m - before.translation_m
    length_m = float(np.linalg.norm(travel_m))
    if length_m == 0.0:
        return None
    for along_m in PLACES_M:
        place_m = now.translation_m + along_m / length_m * travel_m
        if sum(votes(camera, words, pose, place_m) for words, pose in kept) >= VOTES:
            return place_m
    return None


def votes(camera: Calibration, words: Disparity, pose: Pose, place_m: Array) -> bool:
    x_m, y_m, z_m = pose.rotation.T @ (place_m - pose.translation_m)
    if z_m < NEAREST_M:
        return False
    u_px, v_px = camera.cx + camera.focal_px * x_m / z_m, camera.cy + camera.focal_px * y_m / z_m
    radius_px = camera.focal_px * RADIUS_M / z_m
    rows, columns = (
        np.arange(
            max(int(np.ceil(middle - radius_px)), 0), int(min(middle + radius_px, size - 1)) + 1, EVERY_PX
        )
        for middle, size in ((v_px, camera.height), (u_px, camera.width))
    )
    around = (rows[:, np.newaxis] - v_px) ** 2 + (columns - u_px) ** 2 <= radius_px**2
    seen = words[np.ix_(rows, columns)][around]
    place_px = camera.focal_px * camera.baseline_m / z_m
    here = np.abs(seen / SCALE - place_px) <= max(NEAR_PX, NEAR_SHARE * place_px)
    return int(here.sum()) >= max(LEAST_WORDS, LEAST_SHARE * len(seen))


def with_warning(record: FrameRecord, camera: Calibration, place_m: Array | None) -> FrameRecord:
    obstacles, nearest = [], Nearest.made()
    if place_m is not None and record.world_from_camera is not None:
        sight_m = place_m - record.world_from_camera.translation_m
        distance_m = float(np.linalg.norm(sight_m))
        along = np.outer(sight_m, sight_m) / distance_m**2
        dz_m = distance_m**2 / (camera.focal_px * camera.baseline_m)
        told = {
            "id": ID_PLACE,
            "position_m": place_m,
            "distance_m": distance_m,
            "covariance_m2": (NEAR_PX * dz_m) ** 2 * along + RADIUS_M**2 / 3.0 * (np.eye(3) - along),
        }
        box = {"extent_m": (2.0 * RADIUS_M, 2.0 * RADIUS_M), "kind": "place", "in_collision_volume": True}
        obstacles.append(Obstacle.made(confirmed=True, **told, **box))
        nearest = Nearest.made(valid=True, time_to_collision_s=np.nan, **told)
    outcome = record.outcome.but(nearest_collision=nearest, obstacle_count=len(obstacles), path_seen_m=0.0)
    items = np.array([one.memory for one in obstacles], record.items.dtype)
    return replace(record, outcome=outcome, items=items)
