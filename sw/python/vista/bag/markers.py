"""Obstacles as markers of RViz: a box and a label for each, in the frame of reference of the camera."""

from __future__ import annotations

from typing import Any

import numpy as np

from vista.bag.scene import WHITE, boards
from vista.bag.types import Messages
from vista.geometry import Array
from vista.history import FrameRecord

MARKER, MARKERS = "visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray"
CUBE, TEXT_VIEW_FACING = 1, 9
ADD, DELETEALL = 0, 3
TEXT_M = 0.5  # height of the letters
NOTHING = np.empty(0, np.uint8)
Triple = tuple[float, float, float]


def markers(messages: Messages, record: FrameRecord) -> Any:
    """Makes markers of the confirmed obstacles; those of the frame before are deleted."""
    made = [_marker(messages, record.t_ns, 0, action=DELETEALL)]
    for number, board in enumerate(boards(record)):
        made.append(
            _marker(messages, record.t_ns, number, CUBE, board.position_m, board.size_m, board.colour, 0.6)
        )
        at, size = board.text_position_m, (0.0, 0.0, TEXT_M)
        made.append(
            _marker(messages, record.t_ns, number, TEXT_VIEW_FACING, at, size, WHITE, 1.0, board.text)
        )
    return messages.make(MARKERS, markers=made)


def _marker(
    messages: Messages,
    t_ns: int,
    number: int,
    kind: int = CUBE,
    position_m: Array | Triple = (0.0, 0.0, 0.0),
    size_m: Triple = (0.0, 0.0, 0.0),
    colour: Triple = WHITE,
    alpha: float = 0.0,
    text: str = "",
    action: int = ADD,
) -> Any:
    r, g, b = colour
    return messages.make(
        MARKER,
        header=messages.header(t_ns),
        ns="labels" if text else "obstacles",
        id=number,
        type=kind,
        action=action,
        pose=messages.pose(position_m),
        scale=messages.vector(size_m),
        color=messages.make("std_msgs/msg/ColorRGBA", r=r, g=g, b=b, a=alpha),
        lifetime=messages.make("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
        frame_locked=False,
        points=[],
        colors=[],
        texture_resource="",
        texture=messages.make(
            "sensor_msgs/msg/CompressedImage", header=messages.header(0, ""), format="", data=NOTHING
        ),
        uv_coordinates=[],
        text=text,
        mesh_resource="",
        mesh_file=messages.make("visualization_msgs/msg/MeshFile", filename="", data=NOTHING),
        mesh_use_embedded_materials=False,
    )
