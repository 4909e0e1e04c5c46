"""One line of obstacles.jsonl: the obstacle map of a frame as JSON, described in obstacles.schema.json."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vista.history import FrameRecord

if TYPE_CHECKING:
    from vista.pipeline import Directions, Nearest, Obstacle

VERSION = 2  # of the lines

# Digits after the point: below what the measurements carry, and enough for any unit test of a user's.
METRES = 3
SQUARE_METRES = 6
PIXELS = 2
DISPARITY_PX = 3
DEGREES = 1
SECONDS = 2
UNIT = 5  # components of a unit vector


def schema_text() -> str:
    """The JSON Schema (draft 2020-12) of a line."""
    return Path(__file__).with_name("obstacles.schema.json").read_text(encoding="utf-8")


def obstacle_line(record: FrameRecord, all_tracks: bool = False) -> str:
    """The fields as JSON without line break."""
    return json.dumps(obstacle_fields(record, all_tracks), allow_nan=False)


def obstacle_fields(record: FrameRecord, all_tracks: bool = False) -> dict[str, Any]:
    """What the line of a frame holds; a number that is not finite becomes None.

    all_tracks: also the tracks that are not confirmed.
    """
    nearest = record.nearest_collision
    return {
        "version": VERSION,
        "frame": record.index,
        "t_ns": record.t_ns,
        "processing_ms": _rounded(record.stage_ms["host"], 3),
        "regions": record.regions,
        "valid_fraction": _rounded(record.valid_fraction, 4),
        "motion": "known" if record.motion_known else "unknown",
        "health": {"state": record.health.state, "reasons": record.health.reasons},
        "obstacles": [
            _obstacle(obstacle, record) for obstacle in record.obstacles if obstacle.confirmed or all_tracks
        ],
        "nearest_collision": None if nearest is None else _nearest(nearest, record),
        "path_seen_m": _rounded(record.path_seen_m, METRES),
        "velocity_camera_m_s": _rounded_or_none(record.velocity_camera_m_s, METRES),
        "directions": None if record.directions is None else _directions(record.directions),
    }


def _obstacle(obstacle: Obstacle, record: FrameRecord) -> dict[str, Any]:
    ellipse = obstacle.ellipse
    return {
        "id": int(obstacle.id),
        "confirmed": bool(obstacle.confirmed),
        "age_frames": int(obstacle.age_frames),
        "position_m": _rounded(obstacle.position_m, METRES),
        "position_camera_m": _rounded(record.in_camera(obstacle.position_m), METRES),
        "covariance_m2": _rounded(obstacle.covariance_m2, SQUARE_METRES),
        "distance_m": _rounded(obstacle.distance_m, METRES),
        "extent_m": _rounded(obstacle.extent_m, METRES),
        "ellipse_px": {
            "center": _rounded((ellipse.center_u, ellipse.center_v), PIXELS),
            "axes": _rounded((ellipse.axis_a, ellipse.axis_b), PIXELS),
            "angle_deg": _rounded(ellipse.angle_deg, DEGREES),
        },
        "disparity_px": _rounded(obstacle.disparity_px, DISPARITY_PX),
        "in_collision_volume": bool(obstacle.in_collision_volume),
        "coasting": bool(obstacle.coasting),
        "world": obstacle.world.lower(),
        "kind": obstacle.kind,
    }


def _nearest(nearest: Nearest, record: FrameRecord) -> dict[str, Any]:
    time_s = nearest.time_to_collision_s
    return {
        "id": int(nearest.id),
        "position_m": _rounded(nearest.position_m, METRES),
        "position_camera_m": _rounded(record.in_camera(nearest.position_m), METRES),
        "covariance_m2": _rounded(nearest.covariance_m2, SQUARE_METRES),
        "distance_m": _rounded(nearest.distance_m, METRES),
        "time_to_collision_s": None if time_s is None else _rounded(time_s, SECONDS),
    }


def _directions(directions: Directions) -> dict[str, Any]:
    """Without the columns at both ends that are not free."""
    free = np.flatnonzero(directions.free_m)
    first, end = (int(free[0]), int(free[-1]) + 1) if len(free) else (0, 0)
    return {
        "up_camera": _rounded_or_none(directions.up_camera, UNIT),
        "first_deg": directions.FIRST_DEG + first,
        "free_m": _rounded(directions.free_m[first:end], METRES),
    }


def _rounded_or_none(value: Any, digits: int) -> Any:
    return None if value is None else _rounded(value, digits)


def _rounded(value: Any, digits: int) -> Any:
    if np.ndim(value) > 0:
        return [_rounded(item, digits) for item in value]
    number = float(value)
    return round(number, digits) + 0.0 if math.isfinite(number) else None
