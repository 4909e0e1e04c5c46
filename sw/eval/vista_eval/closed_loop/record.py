"""What is kept of a flight: a line of JSON a decision, and the same as an MCAP file for Foxglove."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from vista.errors import InputError
from vista.geometry import quaternion_from_rotation
from vista.output import write_atomically

from vista_eval.closed_loop.loop import Flight, Moment, time_ns
from vista_eval.closed_loop.outcome import outcome_of


def write_record(path: Path, flight: Flight, rival: str) -> None:
    """The first line is of the flight as a whole, each other one of a decision."""
    write_atomically(path, "".join(line + "\n" for line in lines_of(flight, rival)))


def lines_of(flight: Flight, rival: str) -> Iterator[str]:
    world = flight.world
    head = asdict(outcome_of(flight, rival)) | {
        "conditions": asdict(flight.conditions),
        "seed": world.seed,
        "route_m": world.route_m,
        "radius_m": world.radius_m,
        "wind_m_s": world.wind_m_s,
    }
    yield json.dumps(plain(head))
    for moment in flight.moments:
        yield json.dumps(plain(of_moment(moment)))


def of_moment(moment: Moment) -> dict[str, Any]:
    state, record, setpoint = moment.state, moment.record, moment.setpoint
    found: dict[str, Any] = {
        "t_s": moment.t_s,
        "position_m": state.position_m,
        "velocity_m_s": state.velocity_m_s,
        "heading_deg": math.degrees(state.heading_rad),
        "nearest_m": moment.near.distance_m,
        "nearest": moment.near.name,
        "action": moment.decision.action,
        "why": moment.decision.why,
        "setpoint": {
            "position_m": setpoint.position_m,
            "velocity_m_s": setpoint.velocity_m_s,
            "heading_deg": math.degrees(setpoint.heading_rad),
        },
    }
    if record is not None:
        warning = record.warning
        found |= {
            "frame": record.index,
            "path_seen_m": record.path_seen_m,
            "collision_m": None if warning is None else warning.distance_m,
            "collision_id": None if warning is None else warning.id,
            "health": str(record.health.state),
            "obstacles": len(record.things),
        }
    return found


def plain(value: Any) -> Any:
    """Makes what JSON takes: lists for arrays, null for what is not finite, to a tenth of a millimetre."""
    match value:
        case dict():
            return {name: plain(one) for name, one in value.items()}
        case list() | tuple():
            return [plain(one) for one in value]
        case np.ndarray():
            return plain(value.tolist())
        case float() | np.floating():
            return round(float(value), 4) if math.isfinite(value) else None
        case np.integer():
            return int(value)
    return value


# ---- MCAP ----

POSE_SCHEMA = {"type": "object", "title": "foxglove.PoseInFrame"}
IMAGE_SCHEMA = {"type": "object", "title": "foxglove.CompressedImage"}
MOMENT_SCHEMA = {"type": "object", "title": "vista.Moment"}


def write_mcap(path: Path, flight: Flight) -> None:
    """Poses and images by the schemas of Foxglove, decisions as the lines of the record. Raises InputError
    where the package mcap is missing."""
    try:
        from mcap.writer import Writer
    except ModuleNotFoundError:
        raise InputError("--mcap", "the package mcap is not installed: pip install mcap") from None
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="", library="vista")
        channels = {
            topic: writer.register_channel(
                topic,
                "json",
                writer.register_schema(schema["title"], "jsonschema", json.dumps(schema).encode()),
            )
            for topic, schema in (
                ("/pose", POSE_SCHEMA),
                ("/left", IMAGE_SCHEMA),
                ("/decision", MOMENT_SCHEMA),
            )
        }
        for moment in flight.moments:
            t_ns = time_ns(moment.t_s)
            for topic, message in messages_of(moment, t_ns).items():
                writer.add_message(channels[topic], t_ns, json.dumps(plain(message)).encode(), t_ns)
        writer.finish()


def messages_of(moment: Moment, t_ns: int) -> dict[str, dict[str, Any]]:
    stamp = {"sec": t_ns // 10**9, "nsec": t_ns % 10**9}
    w, x, y, z = quaternion_from_rotation(moment.state.rotation)
    place = dict(zip("xyz", moment.state.position_m, strict=True))
    found: dict[str, dict[str, Any]] = {
        "/pose": {
            "timestamp": stamp,
            "frame_id": "world",
            "pose": {"position": place, "orientation": {"x": x, "y": y, "z": z, "w": w}},
        },
        "/decision": of_moment(moment),
    }
    if moment.left is not None:
        done, jpeg = cv2.imencode(".jpg", moment.left)
        assert done
        data = base64.b64encode(jpeg.tobytes()).decode()
        found["/left"] = {"timestamp": stamp, "frame_id": "left", "data": data, "format": "jpeg"}
    return found
