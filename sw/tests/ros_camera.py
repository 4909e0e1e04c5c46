"""Two cameras that a test publishes to the node of ROS 2."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bag_cases as bags
import numpy as np
import sequence_cases as cases
from ros_process import MAKE, Bridge, Process, running_bridge
from source_cases import Recording
from vista.geometry import Pose
from vista.sequence import Frame


class Camera:
    """Two cameras that a test publishes, one pair after the other."""

    def __init__(self, bridge: Bridge, compressed: bool = False) -> None:
        self._compressed = compressed
        self.bridge, self.t_ns, self._count = bridge, 1_700_000_000_000_000_000, 0
        self._recording = Recording([], cases.RIG)

    def info(self, side: str, **changed: Any) -> None:
        frame = Frame(0, self.t_ns, *cases.texture_pair(0), Pose())
        told = bags.camera_info(MAKE, frame, self._recording, side, **changed)
        self.bridge.publish(f"/{side}/camera_info", told)

    def image(self, side: str, later_ns: int = 0, encoding: str = "mono8", rows: int | None = None) -> None:
        """rows: what is left of them."""
        pixels = cases.texture_pair(self._count)[side == "right"][:rows]
        channels = {"rgb8": 3, "bgr8": 3}.get(encoding, 1)
        pixels = np.repeat(pixels, channels, axis=1).reshape(*pixels.shape, channels).squeeze()
        message = bags.raw_image(MAKE, self.t_ns + later_ns, pixels, encoding)
        self.bridge.publish(f"/{side}/image_rect", message)

    def compressed_image(self, side: str, bytes_missing: int = 0) -> None:
        """A JPEG; bytes_missing: at its end."""
        pixels = cases.texture_pair(self._count)[side == "right"]
        message = bags.compressed_image(MAKE, self.t_ns, pixels, ".jpg")
        message.data = message.data[: len(message.data) - bytes_missing]
        self.bridge.publish(f"/{side}/image_rect/compressed", message)

    def pair(self, **of_right: Any) -> None:
        self._count += 1
        self.t_ns += 50_000_000
        image = self.compressed_image if self._compressed else self.image
        image("left")
        image("right", **of_right)


@contextmanager
def running_camera(folder: Path, compressed: bool = False) -> Iterator[Camera]:
    """The camera of a node that runs, and has found obstacles, or none, in one pair."""
    with running_bridge(folder) as bridge:
        bridge.hear("/vista/obstacles_json", "std_msgs/msg/String")
        bridge.hear("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        camera = Camera(bridge, compressed)
        camera.info("left")
        camera.info("right")
        camera.pair()
        bridge.wait_for("/vista/obstacles_json", 1)
        yield camera


def assert_goes_on(camera: Camera, node: Process) -> None:
    heard = len(camera.bridge.heard["/vista/obstacles_json"])
    camera.pair()
    camera.bridge.wait_for("/vista/obstacles_json", heard + 1)
    assert node.stop() == 0
    assert not [line for line in node.errors if "Traceback" in line]
