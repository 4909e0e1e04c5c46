"""The parameters of the node."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.exceptions import ParameterException
from rclpy.parameter import Parameter

from vista import parameters
from vista.command.arguments import load_parameters
from vista.engine import ENGINES
from vista.errors import InputError
from vista.geometry import Pose
from vista.sequence.trajectory import Trajectory, make_sample

NAMES = ("engine", "threads", "config", "poses", "pair_tolerance_ms", "body_from_camera", "image_transport")
OF_EVERY_NODE = ("use_sim_time", "start_type_description_service")
POSES = ("none", "topic", "odometry")
TRANSPORTS = ("raw", "compressed")  # as image_transport names them


@dataclass(frozen=True)
class Settings:
    engine: str
    threads: int
    values: parameters.Values
    tolerance_ms: float | None
    poses: str
    body_from_camera: Pose | None
    transport: str


def read_settings(node: Any) -> Settings:
    """Declares them; the node has to hold whatever was set. Raises InputError."""
    try:
        _warn_of_others(node)
        return _declared(node)
    except ParameterException as error:
        raise InputError("--ros-args", str(error)) from None


def _warn_of_others(node: Any) -> None:
    """A name that was mistyped would be ignored else. What is known is declared anew, with its type."""
    for name in node.list_parameters([], 0).names:
        if name in NAMES or name.startswith("qos_overrides."):
            node.undeclare_parameter(name)
        elif name not in OF_EVERY_NODE:
            node.get_logger().warning(f"parameter {name} is ignored; known: {', '.join(NAMES)}")


def _declared(node: Any) -> Settings:
    def declare(name: str, default: Any) -> Any:
        return node.declare_parameter(name, default).value

    engine, threads = declare("engine", "golden"), declare("threads", 1)
    config, poses = declare("config", ""), declare("poses", "none")
    transport = declare("image_transport", "raw")
    tolerance_ms = declare("pair_tolerance_ms", Parameter.Type.DOUBLE)
    mounting = declare("body_from_camera", Parameter.Type.DOUBLE_ARRAY)
    chosen = {
        "engine": (engine, ENGINES),
        "poses": (poses, POSES),
        "image_transport": (transport, TRANSPORTS),
    }
    for name, (value, choices) in chosen.items():
        if value not in choices:
            raise InputError(f"parameter {name}", f"{value!r} is none of {', '.join(choices)}")
    if threads < 1:
        raise InputError("parameter threads", f"{threads} is not a positive number")
    if tolerance_ms is not None and not 0.0 <= tolerance_ms <= 1e6:
        raise InputError("parameter pair_tolerance_ms", f"{tolerance_ms:g} is not from 0 to 1000000 ms")
    values = load_parameters(Path(config) if config else None, engine)
    body_from_camera = None if mounting is None else _pose("parameter body_from_camera", mounting)
    return Settings(engine, threads, values, tolerance_ms, poses, body_from_camera, transport)


def _pose(culprit: str, numbers: Any) -> Pose:
    """The pose that x y z qx qy qz qw state."""
    if len(numbers) != 7 or not np.all(np.isfinite(numbers)):
        raise InputError(culprit, "is not seven numbers: x y z (m), and the quaternion qx qy qz qw")
    x, y, z, w = numbers[3:]
    return Trajectory([make_sample(culprit, 0, np.array(numbers[:3]), np.array([w, x, y, z]))]).first()
