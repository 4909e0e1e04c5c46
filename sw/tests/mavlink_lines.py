"""Lines of obstacles.jsonl for `vista mavlink`: a thing that comes nearer, and what surrounds it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from obstacle_schema import VALIDATOR

PERIOD_NS = 50_000_000


def line(frame: int, **changes: Any) -> dict[str, Any]:
    """A frame of a healthy flight at 10 m/s: one thing ahead, free to both sides of it."""
    z_m = 30.0 - 0.5 * frame
    free_m = [100.0] * 29 + [25.0, 25.0] + [100.0] * 29
    blocked_m = [0.0] * 29 + [z_m, z_m] + [0.0] * 29
    directions = {"up_camera": [0.0, -1.0, 0.0], "first_deg": -30, "free_m": free_m, "blocked_m": blocked_m}
    content: dict[str, Any] = {
        "version": 2,
        "frame": frame,
        "t_ns": 10**9 + PERIOD_NS * frame,
        "processing_ms": 1.0,
        "regions": 5,
        "valid_fraction": 0.5,
        "motion": "known",
        "health": {"state": "healthy", "reasons": []},
        "obstacles": [obstacle(1, [0.0, 0.0, z_m])],
        "nearest_collision": {
            "id": 1,
            "position_m": [0.0, 0.0, 30.0],
            "position_camera_m": [0.0, 0.0, z_m],
            "covariance_m2": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            "distance_m": z_m,
            "time_to_collision_s": z_m / 10.0,
            "probability": 0.98,
        },
        "path_seen_m": 50.0,
        "velocity_camera_m_s": [0.0, 0.0, 10.0],
        "directions": directions,
    }
    content |= changes
    return content


def obstacle(number: int, position_camera_m: list[float], **changes: Any) -> dict[str, Any]:
    content = {
        "id": number,
        "confirmed": True,
        "age_frames": 9,
        "position_m": [0.0, 0.0, 30.0],
        "position_camera_m": position_camera_m,
        "covariance_m2": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "distance_m": 30.0,
        "extent_m": [0.4, 2.0],
        "ellipse_px": {"center": [1.0, 1.0], "axes": [2.0, 1.0], "angle_deg": 0.0},
        "disparity_px": 5.0,
        "in_collision_volume": True,
        "coasting": False,
        "world": "stands",
        "kind": "thing",
    }
    return content | changes


def write_lines(path: Path, lines: list[dict[str, Any]], valid: bool = True) -> Path:
    for content in lines if valid else []:
        VALIDATOR.validate(content)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join(json.dumps(content) + "\n" for content in lines))
    return path
