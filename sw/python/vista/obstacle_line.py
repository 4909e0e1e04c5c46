"""One line of obstacles.jsonl: the obstacle map of a frame as JSON."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from vista.history import FrameRecord

if TYPE_CHECKING:
    from vista.pipeline import Nearest, Obstacle

# Digits after the point: below what the measurements carry, and enough for any unit test of a user's.
METRES = 3
SQUARE_METRES = 6
PIXELS = 2
DISPARITY_PX = 3
DEGREES = 1
SECONDS = 2


def obstacle_line(record: FrameRecord) -> str:
    """JSON without line break; a number that is not finite becomes null."""
    nearest = record.nearest_collision
    line = {
        "frame": record.index,
        "t_ns": record.t_ns,
        "processing_ms": _rounded(record.stage_ms["host"], 3),
        "regions": record.regions,
        "valid_fraction": _rounded(record.valid_fraction, 4),
        "obstacles": [_obstacle(obstacle) for obstacle in record.obstacles],
        "nearest_collision": None if nearest is None else _nearest(nearest),
    }
    return json.dumps(line, allow_nan=False)


def _obstacle(obstacle: Obstacle) -> dict[str, Any]:
    ellipse = obstacle.ellipse
    return {
        "id": int(obstacle.id),
        "confirmed": bool(obstacle.confirmed),
        "age_frames": int(obstacle.age_frames),
        "position_m": _rounded(obstacle.position_m, METRES),
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
    }


def _nearest(nearest: Nearest) -> dict[str, Any]:
    time_s = nearest.time_to_collision_s
    return {
        "id": int(nearest.id),
        "position_m": _rounded(nearest.position_m, METRES),
        "distance_m": _rounded(nearest.distance_m, METRES),
        "time_to_collision_s": None if time_s is None else _rounded(time_s, SECONDS),
    }


def _rounded(value: Any, digits: int) -> Any:
    if np.ndim(value) > 0:
        return [_rounded(item, digits) for item in value]
    number = float(value)
    return round(number, digits) + 0.0 if math.isfinite(number) else None
