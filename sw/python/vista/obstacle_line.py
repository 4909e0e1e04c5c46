"""One line of obstacles.jsonl: the obstacle map of a frame as JSON, described in obstacles.schema.json.

libvista writes it (vista/line.h), here as in vista-fly."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vista import native
from vista.geometry import Pose
from vista.history import FrameRecord

if TYPE_CHECKING:
    from vista.pipeline import Directions, Nearest, Obstacle


def schema_text() -> str:
    """The JSON Schema (draft 2020-12) of a line."""
    return Path(__file__).with_name("obstacles.schema.json").read_text(encoding="utf-8")


def version() -> int:
    """The version of the lines."""
    return int(native.load("vista")[1].VISTA_LINE_VERSION)


def obstacle_fields(record: FrameRecord) -> dict[str, Any]:
    """What the line of a frame holds; a number that is not finite is None."""
    fields: dict[str, Any] = json.loads(obstacle_line(record))
    return fields


def obstacle_line(record: FrameRecord, all_tracks: bool = False) -> str:
    """The fields as JSON without line break. all_tracks: also the tracks that are not confirmed."""
    ffi, lib = native.load("vista")
    kept, result = _result(ffi, lib, record)
    names = [ffi.new("char[]", str(reason).encode()) for reason in record.health.reasons]
    state = _numbers("health_state")[str(record.health.state)]
    health = ffi.new("vista_line_health *", (state, len(names), names))
    directions = ffi.NULL if record.directions is None else _directions(ffi, record.directions)
    capacity, length = int(lib.VISTA_LINE_BYTES), ffi.new("size_t *")
    while True:
        text = ffi.new("char[]", capacity)
        about = (record.index, record.t_ns, all_tracks)
        status = lib.vista_line_write(result, directions, health, *about, text, capacity, length)
        if status != lib.VISTA_ERROR_MEMORY:
            break
        capacity *= 2
    if status != lib.VISTA_OK:
        raise ValueError(ffi.string(lib.vista_status_text(status)).decode())
    del kept
    return bytes(ffi.buffer(text, length[0] - 1)).decode()


@cache
def _numbers(enum: str) -> dict[str, int]:
    """Names of the values of a C enum, such as world_verdict, and the values."""
    ffi, lib = native.load("vista")
    name_of = getattr(lib, f"vista_{enum}_name")
    count = getattr(lib, f"VISTA_{enum.upper()}_COUNT")
    return {ffi.string(name_of(k)).decode(): k for k in range(count)}


def _result(ffi: Any, lib: Any, record: FrameRecord) -> tuple[Any, Any]:
    """vista_result, as far as the line asks for it, and what it points to."""
    obstacles = ffi.new("vista_obstacle[]", len(record.obstacles))
    for target, obstacle in zip(obstacles, record.obstacles, strict=True):
        _fill(ffi, target, obstacle)
    result, pose = ffi.new("vista_result *"), record.world_from_camera
    result.obstacles, result.obstacle_count = obstacles, len(record.obstacles)
    result.obstacle_bytes = ffi.sizeof("vista_obstacle")
    if record.nearest_collision is not None:
        result.nearest_collision = _nearest(record.nearest_collision)
    motion = result.motion
    motion.known, motion.velocity_known = record.motion_known, record.velocity_m_s is not None
    motion.source = lib.VISTA_MOTION_UNTOLD if pose is None else lib.VISTA_MOTION_POSE
    pose = pose or Pose()
    motion.pose.rotation, motion.pose.translation_m = _list(pose.rotation), _list(pose.translation_m)
    if record.velocity_m_s is not None:
        motion.velocity_m_s = _list(record.velocity_m_s)
    result.valid_fraction, result.region_count = record.valid_fraction, record.regions
    result.host_ms, result.path_seen_m = record.stage_ms["host"], record.path_seen_m
    return obstacles, result


def _fill(ffi: Any, target: Any, obstacle: Obstacle) -> None:
    e = obstacle.ellipse
    target.id, target.age_frames = int(obstacle.id), int(obstacle.age_frames)
    target.confirmed, target.coasting = bool(obstacle.confirmed), bool(obstacle.coasting)
    target.world = _numbers("world_verdict")[obstacle.world]
    target.kind = _numbers("obstacle_kind")[obstacle.kind]
    target.position_m, target.covariance_m2 = _list(obstacle.position_m), _list(obstacle.covariance_m2)
    target.distance_m, target.extent_m = obstacle.distance_m, _list(obstacle.extent_m)
    target.ellipse.center_u_px, target.ellipse.center_v_px = e.center_u, e.center_v
    target.ellipse.axis_a_px, target.ellipse.axis_b_px = e.axis_a, e.axis_b
    target.ellipse.angle_deg, target.disparity_px = e.angle_deg, obstacle.disparity_px
    target.in_collision_volume = bool(obstacle.in_collision_volume)


def _nearest(nearest: Nearest) -> dict[str, Any]:
    seconds = nearest.time_to_collision_s
    return {
        "valid": True,
        "id": int(nearest.id),
        "position_m": _list(nearest.position_m),
        "distance_m": nearest.distance_m,
        "time_to_collision_s": math.nan if seconds is None else seconds,
        "covariance_m2": _list(nearest.covariance_m2),
    }


def _directions(ffi: Any, directions: Directions) -> Any:
    columns = {"free_m": directions.free_m.tolist(), "blocked_m": directions.blocked_m.tolist()}
    c = ffi.new("vista_directions *", columns)
    if directions.up_camera is not None:
        c.up_known, c.up_camera = True, _list(directions.up_camera)
    return c


def _list(values: Any) -> list[float]:
    return [float(value) for value in np.ravel(values)]
