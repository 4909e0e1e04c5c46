"""The message types of a bag, and the small ones that many of them hold."""

from __future__ import annotations

from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from vista.bag.foxglove import DEFINITIONS, PACKAGE
from vista.errors import InputError
from vista.geometry import Array, quaternion_from_rotation

WORLD = "world"  # REP 103: z is up
CAMERA = "left_camera_optical"  # x to the right, y down, z forward
NS = 1_000_000_000
NO_ROTATION = np.eye(3)
END_S = 2**31  # what a time of ROS can hold


def make_typestore() -> Any:
    """Those of ROS 2 Humble, with Foxglove's."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, PACKAGE + name))
    return store


class Messages:
    """Makes messages by the names of their types."""

    def __init__(self, camera_frame: str = CAMERA) -> None:
        """camera_frame: the name of the left camera's frame of reference."""
        self.store = make_typestore()
        self.camera_frame = camera_frame

    def make(self, type_name: str, /, **fields: Any) -> Any:
        """type_name: such as sensor_msgs/msg/Image; every field has to be given."""
        return self.store.types[type_name](**fields)

    def time(self, t_ns: int) -> Any:
        """Raises InputError for a time that ROS has no room for."""
        if t_ns // NS >= END_S:
            raise InputError(
                "--bag", f"the time {t_ns // NS} s is beyond those of ROS, which end at {END_S} s"
            )
        return self.make("builtin_interfaces/msg/Time", sec=t_ns // NS, nanosec=t_ns % NS)

    def header(self, t_ns: int, frame_id: str | None = None) -> Any:
        """frame_id: None is the left camera's."""
        frame_id = self.camera_frame if frame_id is None else frame_id
        return self.make("std_msgs/msg/Header", stamp=self.time(t_ns), frame_id=frame_id)

    def point(self, position_m: Any) -> Any:
        x, y, z = map(float, position_m)
        return self.make("geometry_msgs/msg/Point", x=x, y=y, z=z)

    def vector(self, vector: Any) -> Any:
        x, y, z = map(float, vector)
        return self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)

    def quaternion(self, rotation: Array) -> Any:
        w, x, y, z = map(float, quaternion_from_rotation(rotation))
        return self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def pose(self, position_m: Any, rotation: Array = NO_ROTATION) -> Any:
        return self.make(
            "geometry_msgs/msg/Pose",
            position=self.point(position_m),
            orientation=self.quaternion(rotation),
        )
