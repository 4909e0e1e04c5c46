"""What one frame found and an autopilot is told of: from its record, or from a line of obstacles.jsonl."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from vista import native
from vista.errors import InputError
from vista.health.finding import State
from vista.history import FrameRecord
from vista.obstacle_line import version
from vista.pipeline import Directions
from vista.result_folder import OBSTACLES
from vista.sequence.text import check_increasing, read_text
from vista.structs import names_of

TIME_END_NS = 2**62
FARTHEST_M = 1e6
LEVEL = (0.0, -1.0, 0.0)  # up, in a camera of which nothing is known


class Sighting:
    """A vista_mavlink_frame with what it points to; numbers that were not finite are NaN."""

    def __init__(self, t_ns: int, obstacles: int) -> None:
        """obstacles: how many have room."""
        self._ffi, _ = native.load("vista")
        self.obstacles = self._ffi.new("vista_mavlink_obstacle[]", obstacles)
        self.frame = self._ffi.new("vista_mavlink_frame *", {"t_ns": t_ns, "obstacles": self.obstacles})
        self.frame.directions.up_camera = LEVEL
        self.t_ns = t_ns

    def judge(self, state: str, reasons: list[Any]) -> None:
        """Says how far the frame can be trusted, and why."""
        self.frame.health = names_of("health_state").index(str(state))
        self._reason = self._ffi.new("char[]", str(reasons[0] if reasons else "").encode(errors="replace"))
        self.frame.reason = self._reason


def read_sightings(path: Path) -> list[Sighting]:
    """Reads a result folder of `vista run`, or of its obstacles.jsonl. InputError names the line."""
    file = path / OBSTACLES if path.is_dir() else path
    sightings: list[Sighting] = []
    for number, text in enumerate(read_text(file).splitlines(), start=1):
        culprit = f"{file}:{number}"
        sighting = sighting_of_line(culprit, text)
        check_increasing(culprit, sightings[-1].t_ns if sightings else None, sighting.t_ns)
        sightings.append(sighting)
    if not sightings:
        raise InputError(file, "holds no frame")
    return sightings


def sighting_of(record: FrameRecord) -> Sighting:
    """What a frame that is there tells. From its line comes the same, rounded as the line is."""
    ffi, lib = native.load("vista")
    sighting = Sighting(record.t_ns, len(record.items))
    room = sighting.obstacles, len(record.items)
    status = lib.vista_mavlink_frame_of(*record.in_c(), record.t_ns, *room, sighting.frame)
    native.check(ffi, lib, status)
    sighting.judge(record.health.state, record.health.reasons)
    return sighting


def sighting_of_line(culprit: str, text: str) -> Sighting:
    try:
        line = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError(culprit, "not a whole line of JSON") from None
    if not isinstance(line, dict) or line.get("version") != version():
        raise InputError(culprit, f"not a line of obstacles.jsonl in version {version()}")
    if "directions" not in line:
        raise InputError(culprit, "has no directions: run vista run again, with this version")
    try:
        return _sighting(line)
    except (AttributeError, LookupError, TypeError, ValueError, OverflowError) as error:
        problem = f"no {error}" if isinstance(error, KeyError) else str(error)
        raise InputError(culprit, f"not as obstacles.schema.json says: {problem}") from None


def _sighting(line: dict[str, Any]) -> Sighting:
    confirmed = [o for o in line["obstacles"] if o["confirmed"]]
    sighting = Sighting(_integer(line["t_ns"], 0, TIME_END_NS), len(confirmed))
    sighting.judge(State(line["health"]["state"]), line["health"]["reasons"])
    for board, obstacle in zip(sighting.obstacles, confirmed, strict=True):
        board.id, board.position_camera_m = _id(obstacle["id"]), _point(obstacle["position_camera_m"])
        board.width_m, board.height_m = (_number(x) for x in obstacle["extent_m"])
    sighting.frame.obstacle_count = len(confirmed)
    _read_collision(sighting.frame.collision, line)
    if line["directions"] is not None:
        _read_directions(sighting.frame.directions, line["directions"])
    return sighting


def _read_collision(collision: Any, line: dict[str, Any]) -> None:
    nearest, velocity = line["nearest_collision"], line["velocity_camera_m_s"]
    if nearest is None:
        return
    collision.valid, collision.id = True, _id(nearest["id"])
    collision.position_camera_m = _point(nearest["position_camera_m"])
    if velocity is not None:
        collision.velocity_camera_m_s = _point(velocity)
    time_s = nearest["time_to_collision_s"]
    collision.time_s = 0.0 if time_s is None else _number(time_s)


def _read_directions(directions: Any, told: dict[str, Any]) -> None:
    """Every column there is; the line has only those of which something is known."""
    directions.up_known = told["up_camera"] is not None
    if directions.up_known:
        directions.up_camera = _point(told["up_camera"])
    start, end = Directions.FIRST_DEG, Directions.FIRST_DEG + Directions.COLUMNS
    first = _integer(told["first_deg"], start, end) - start
    for name in ("free_m", "blocked_m"):
        given = np.array([_number(x) for x in told[name]])
        if first + len(given) > Directions.COLUMNS:
            raise OverflowError(f"more {name} than columns")
        columns = np.clip(np.nan_to_num(given, nan=0.0, posinf=0.0), 0.0, FARTHEST_M)
        for column, distance_m in enumerate(columns.tolist(), start=first):
            getattr(directions, name)[column] = distance_m


def _point(values: Any) -> tuple[float, float, float]:
    x, y, z = (_number(value) for value in values)
    return x, y, z


def _number(value: Any) -> float:
    """null stands for a number that was not finite."""
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{value!r} is no number")
    return float(value)


def _id(value: Any) -> int:
    return _integer(value, -(2**31), 2**31)


def _integer(value: Any, first: int, end: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError(f"{value!r} is no integer")
    if not first <= value < end:
        raise OverflowError(f"{value} is out of range")
    return value
