"""What a frame told, published: disparities, obstacles, health."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista.bag import views
from vista.bag.markers import MARKERS, markers
from vista.bag.types import Messages
from vista.geometry import Calibration
from vista.health.finding import State
from vista.live.loop import Seen
from vista.obstacle_line import obstacle_line
from vista.pipeline import Result
from vista.point_cloud import points_of

LINES, DISPARITY, POINTS = "~/obstacles_json", "disparity", "~/points"
BOXES, DIAGNOSTICS = "~/markers", "/diagnostics"
SILENT_NS = 1_000_000_000
TYPES = {
    LINES: "std_msgs/msg/String",
    DISPARITY: "stereo_msgs/msg/DisparityImage",
    POINTS: "sensor_msgs/msg/PointCloud2",
    BOXES: MARKERS,
    DIAGNOSTICS: "diagnostic_msgs/msg/DiagnosticArray",
}


class Publisher:
    """A listener of the live run."""

    def __init__(self, publishers: dict[str, Any], messages: Messages) -> None:
        """publishers: of rclpy, for each of TYPES; messages: with the name of the camera's frame."""
        self._publishers, self._messages = publishers, messages
        self._camera: Calibration | None = None
        self._candidates = 0
        self._published_ns = time.monotonic_ns()

    def silent(self) -> bool:
        return time.monotonic_ns() - self._published_ns > SILENT_NS

    def describe(self, camera: Calibration, candidates: int, frame_id: str) -> None:
        """Describes the frames that follow. camera: rectified; candidates: number of disparities; frame_id:
        the name of the camera's frame of reference."""
        self._camera, self._candidates = camera, candidates
        self._messages.camera_frame = frame_id

    def take(self, seen: Seen) -> None:
        """The most urgent first; what nobody has subscribed to is not made."""
        record, messages, camera = seen.record, self._messages, self._camera
        assert camera is not None
        t_ns, result = record.t_ns, seen.step.result
        if self._wanted(LINES):
            self._publish(LINES, messages.make(TYPES[LINES], data=obstacle_line(record)))
        if self._wanted(BOXES):
            self._publish(BOXES, markers(messages, record))
        if self._wanted(POINTS):
            points_m = surface_points_m(result, seen.step.frame.left, camera)
            self._publish(POINTS, views.cloud(messages, t_ns, points_m))
        if self._wanted(DISPARITY):
            self._publish(DISPARITY, views.disparity(messages, t_ns, result.words, camera, self._candidates))
        self._publish(DIAGNOSTICS, views.diagnostics(messages, record))
        self._published_ns = time.monotonic_ns()

    def tell_blind(self, t_ns: int, text: str) -> None:
        """Says in the diagnostics that there is no frame to judge by. t_ns: on the clock of ROS."""
        self._publish(DIAGNOSTICS, views.status(self._messages, t_ns, State.BLIND, text, {}))

    def _wanted(self, topic: str) -> bool:
        return bool(self._publishers[topic].get_subscription_count())

    def _publish(self, topic: str, message: Any) -> None:
        self._publishers[topic].publish(bytes(self._messages.store.serialize_cdr(message, TYPES[topic])))


def surface_points_m(result: Result, left: NDArray[np.uint8], camera: Calibration) -> NDArray[np.float32]:
    """(N, 3), in the frame of the camera: the pixels with a disparity in regions that were accepted."""
    accepted = np.array([verdict == "ACCEPTED" for verdict in result.verdict_of_region] + [False])
    words = np.where(accepted[result.region_of_pixel], result.words, 0)  # region -1 is the False at the end
    points = points_of(words, left, camera)
    return np.column_stack([points["x"], points["y"], points["z"]])
