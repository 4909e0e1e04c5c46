"""What one frame found and an autopilot is told of: from its record, or from a line of obstacles.jsonl."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.geometry import Array
from vista.health.finding import State
from vista.history import FrameRecord
from vista.obstacle_line import version
from vista.pipeline import Directions, Nearest
from vista.result_folder import OBSTACLES
from vista.sequence.text import check_increasing, read_text

TIME_END_NS = 2**62
FARTHEST_M = 1e6


@dataclass(frozen=True)
class Board:
    """An obstacle as the camera sees it."""

    id: int
    position_camera_m: tuple[float, float, float]
    width_m: float
    height_m: float


@dataclass(frozen=True)
class Collision:
    """The nearest one."""

    id: int
    position_camera_m: tuple[float, float, float]
    velocity_camera_m_s: tuple[float, float, float]  # zeros: not known
    time_s: float  # from the time of the frame; 0: not known


@dataclass(frozen=True)
class Sighting:
    """A frame; numbers that were not finite are NaN."""

    t_ns: int
    health: State
    reason: str
    obstacles: tuple[Board, ...]  # confirmed ones
    directions: Directions
    collision: Collision | None


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
    """Makes what an autopilot is told of a frame. Its line gives the same, rounded as the line is."""
    reasons, directions, nearest = record.health.reasons, record.directions, record.nearest_collision
    return Sighting(
        record.t_ns,
        record.health.state,
        str(reasons[0]) if reasons else "",
        tuple(
            Board(int(o.id), _vector(record.in_camera(o.position_m)), *o.extent_m)
            for o in record.obstacles
            if o.confirmed
        ),
        _nothing_seen()
        if directions is None
        else Directions(directions.up_camera, _clipped(directions.free_m), _clipped(directions.blocked_m)),
        None if nearest is None else _collision_of(nearest, record),
    )


def _collision_of(nearest: Nearest, record: FrameRecord) -> Collision:
    velocity_m_s = record.velocity_camera_m_s
    return Collision(
        int(nearest.id),
        _vector(record.in_camera(nearest.position_m)),
        (0.0, 0.0, 0.0) if velocity_m_s is None else _vector(velocity_m_s),
        nearest.time_to_collision_s or 0.0,
    )


def _vector(values: Array) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z


def _nothing_seen() -> Directions:
    return Directions(None, *np.zeros((2, Directions.COLUMNS), np.float32))


def _clipped(distances_m: Any) -> NDArray[np.float32]:
    return np.asarray(np.clip(np.nan_to_num(distances_m, nan=0.0, posinf=0.0), 0.0, FARTHEST_M), np.float32)


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
    reasons = line["health"]["reasons"]
    return Sighting(
        _integer(line["t_ns"], 0, TIME_END_NS),
        State(line["health"]["state"]),
        str(reasons[0]) if reasons else "",
        tuple(_board(o) for o in line["obstacles"] if o["confirmed"]),
        _directions(line["directions"]),
        _collision(line),
    )


def _board(obstacle: dict[str, Any]) -> Board:
    width_m, height_m = (_number(x) for x in obstacle["extent_m"])
    return Board(_id(obstacle["id"]), _point(obstacle["position_camera_m"]), width_m, height_m)


def _collision(line: dict[str, Any]) -> Collision | None:
    nearest, velocity = line["nearest_collision"], line["velocity_camera_m_s"]
    if nearest is None:
        return None
    time_s = nearest["time_to_collision_s"]
    return Collision(
        _id(nearest["id"]),
        _point(nearest["position_camera_m"]),
        (0.0, 0.0, 0.0) if velocity is None else _point(velocity),
        0.0 if time_s is None else _number(time_s),
    )


def _directions(line: dict[str, Any] | None) -> Directions:
    if line is None:
        return _nothing_seen()
    up_camera = line["up_camera"]
    return Directions(
        None if up_camera is None else np.array(_point(up_camera)),
        _columns(line, "free_m"),
        _columns(line, "blocked_m"),
    )


def _columns(line: dict[str, Any], name: str) -> NDArray[np.float32]:
    """The values of all columns; the line has only those of which something is known."""
    given = [_number(x) for x in line[name]]
    start, end = Directions.FIRST_DEG, Directions.FIRST_DEG + Directions.COLUMNS
    first = _integer(line["first_deg"], start, end) - start
    if first + len(given) > Directions.COLUMNS:
        raise OverflowError(f"more {name} than columns")
    distances_m = np.zeros(Directions.COLUMNS, np.float32)
    distances_m[first : first + len(given)] = _clipped(given)
    return distances_m


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
