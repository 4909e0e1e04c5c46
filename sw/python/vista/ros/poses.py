"""Poses of the left camera from a nav_msgs/Odometry that keeps coming."""

from __future__ import annotations

from collections import deque
from typing import Any

from vista.errors import InputError
from vista.geometry import Pose
from vista.sequence.bag_images import stamp_ns
from vista.sequence.bag_poses import pose_in
from vista.sequence.trajectory import Sample, Trajectory
from vista.sequence.transforms import sample_of

HELD = 1000  # samples


class LivePoses:
    def __init__(self, topic: str, body_from_camera: Pose | None) -> None:
        """body_from_camera: None where the topic holds the poses of the camera itself."""
        self.topic = topic
        self._body_from_camera = body_from_camera
        self._samples: deque[Sample] = deque(maxlen=HELD)
        self._body = ""

    def add(self, message: Any) -> None:
        """Raises InputError for a pose that is none."""
        t_ns = stamp_ns(message.header)
        sample = sample_of(self.topic, t_ns, pose_in(message))
        if self._samples and t_ns < self._samples[-1].t_ns:
            self._samples.clear()  # the clock went back
        if not self._samples or t_ns > self._samples[-1].t_ns:
            self._samples.append(sample)
        self._body = str(message.child_frame_id).lstrip("/")

    def clear(self) -> None:
        self._samples.clear()

    def reach(self, t_ns: int) -> bool:
        return bool(self._samples) and self._samples[-1].t_ns >= t_ns

    def at(self, t_ns: int, camera: str) -> Pose | None:
        """world_from_camera, between two samples; None before the first. camera: its frame of reference.

        Raises InputError where it is not known where the camera is on the body."""
        if self._body_from_camera is None and self._body != camera:
            raise InputError(
                self.topic,
                f"holds poses of {self._body!r}; the parameter body_from_camera has to say where the camera, "
                f"{camera!r}, is on it",
            )
        world_from_body = Trajectory(list(self._samples)).at(t_ns)
        if world_from_body is None or self._body_from_camera is None:
            return world_from_body
        return world_from_body @ self._body_from_camera
