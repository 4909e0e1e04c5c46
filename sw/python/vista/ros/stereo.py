"""What cameras and odometry publish, turned into the shots of a live run.

All of it runs in the thread that spins.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event
from typing import Any

import numpy as np

from vista.errors import InputError
from vista.geometry import Pose, RawCalibration
from vista.live.source import Shot
from vista.ros.pairs import LEFT, RIGHT, LivePairs, TopicImage
from vista.ros.poses import LivePoses
from vista.sequence import FrameFiles, Sequence
from vista.sequence.asl import UP_WORLD
from vista.sequence.bag_topics import names_rectified
from vista.sequence.camera_info import pair_from_camera_info

HELD = 10  # pairs that wait for their poses, or for the calibration
SILENT_NS = 1_000_000_000


@dataclass(frozen=True)
class Names:
    """Topics after remapping, of the left and of the right camera."""

    images: tuple[str, str]
    infos: tuple[str, str]


class StereoTopics:
    """A source of a live run. It ends when the calibration changes; `sequence` waits for the next one."""

    def __init__(
        self,
        names: Names,
        spin: Callable[[], object],
        tell: Callable[[str], object],
        pairs: LivePairs,
        poses: LivePoses | None = None,
        odometry: bool = False,
    ) -> None:
        """spin: hands what came to the methods take_..., and returns within some 100 ms; tell: takes a line
        about bad messages, each once; poses: of a topic; odometry: they are estimated from the images."""
        self.frame_id = ""  # of the left images
        self._names, self._spin, self._tell = names, spin, tell
        self._pairs, self._poses, self._odometry = pairs, poses, odometry
        self._infos: list[Any] = [None, None]
        self._calibration: RawCalibration | None = None
        self._last: list[TopicImage | None] = [None, None]
        self._last_ns: list[int | None] = [None, None]  # their times, unless the clock went back since
        self._placeless: deque[tuple[TopicImage, TopicImage]] = deque()  # pairs whose poses are to come
        self._ready: deque[tuple[FrameFiles, int]] = deque(maxlen=HELD)  # with the time of arrival
        self._out_of_time = 0
        self._paired_ns = self._ready_ns = time.monotonic_ns()
        self._faults: dict[str, str] = {}  # by what is at fault
        self._told: set[str] = set()

    @property
    def skipped(self) -> int:
        """Images without a partner, and pairs without a pose."""
        return self._pairs.skipped + self._out_of_time

    # ---- what comes ----

    def take_info(self, side: int, info: Any) -> None:
        """A sensor_msgs/CameraInfo."""
        before, self._infos[side] = self._infos[side], info
        if None in self._infos or (before is not None and _content(info) == _content(before)):
            return
        self._calibration = None
        rectified = names_rectified(self._names.images[LEFT]), names_rectified(self._names.images[RIGHT])
        with self._blaming("camera_info"):
            left, right = self._infos
            self._calibration = pair_from_camera_info(left, right, self._names.infos, rectified)

    def take_image(self, side: int, message: Any) -> None:
        """A sensor_msgs/Image or a sensor_msgs/CompressedImage."""
        topic, before = self._names.images[side], self._last[side]
        number = 0 if before is None else before.number + 1
        image = TopicImage(topic, message, number, time.monotonic_ns())
        before_ns = self._last_ns[side]
        if image.t_ns == before_ns:
            self._blame(topic, f"{topic}: an image repeats the time of the one before, and is left out")
            return
        self._faults.pop(topic, None)
        if before_ns is not None and image.t_ns < before_ns:
            self._begin_anew()
        self._last[side], self._last_ns[side] = image, image.t_ns
        if side == LEFT:
            self.frame_id = str(message.header.frame_id).lstrip("/")
        pair = self._pairs.add(side, image)
        if pair is not None:
            self._paired_ns = image.arrived_ns
            self._placeless.append(pair)
            self._place_pairs()

    def take_odometry(self, message: Any) -> None:
        """A nav_msgs/Odometry."""
        assert self._poses is not None
        with self._blaming(self._poses.topic):
            self._poses.add(message)
        self._place_pairs()

    def _begin_anew(self) -> None:
        """The clock went back: what waits belongs to another time."""
        self._last_ns = [None, None]
        self._pairs.clear()
        self._placeless.clear()
        if self._poses is not None:
            self._poses.clear()

    def _place_pairs(self) -> None:
        """Those whose poses are known get ready; a pose is known once odometry has come that is as late."""
        while self._placeless and (self._poses is None or self._poses.reach(self._placeless[0][LEFT].t_ns)):
            left, right = self._placeless.popleft()
            pose = self._pose_at(left.t_ns)
            if self._poses is not None and pose is None:
                self._out_of_time += 1
                continue
            self._ready_ns = time.monotonic_ns()
            arrived_ns = max(left.arrived_ns, right.arrived_ns)
            self._ready.append((FrameFiles(left.number, left.t_ns, left, right, pose), arrived_ns))
        if len(self._placeless) > HELD:
            self._placeless.popleft()
            self._out_of_time += 1

    def _pose_at(self, t_ns: int) -> Pose | None:
        if self._poses is not None:
            with self._blaming("body"):
                return self._poses.at(t_ns, self.frame_id)
        return None

    # ---- what the live run asks for ----

    def sequence(self, interrupted: Callable[[], bool]) -> Sequence | None:
        """Waits for a calibration and a first pair, which tells whether poses come. None: interrupted."""
        while not interrupted():
            if self._calibration is not None and self._ready:
                up_world = None if self._poses is None else UP_WORLD
                first = (self._ready[0][0],)
                return Sequence("ROS 2", "ROS 2", self._calibration, first, up_world, odometry=self._odometry)
            self._spin()
        return None

    def refuse(self, error: InputError) -> None:
        """Drops what `sequence` gave, and waits for another calibration."""
        self._blame("camera_info", str(error))
        self._calibration = None

    def shots(self, stopped: Event) -> Iterator[Shot]:
        calibration = self._calibration
        while calibration is not None and calibration is self._calibration and not stopped.is_set():
            while self._ready:
                files, arrived_ns = self._ready.popleft()
                frame = None
                with self._blaming("image"):
                    frame = Sequence("", "", calibration, ()).read(files)
                if frame is not None:
                    yield Shot(frame, arrived_ns)
            self._spin()

    # ---- what is wrong ----

    def problem(self) -> str | None:
        """Why no frame has come for a second, or what is wrong with the last message of a kind."""
        now_ns = time.monotonic_ns()
        missing = [
            name
            for name, image in zip(self._names.images, self._last, strict=True)
            if image is None or now_ns - image.arrived_ns > SILENT_NS
        ]
        missing += [name for name, info in zip(self._names.infos, self._infos, strict=True) if info is None]
        if missing:
            return f"nothing comes on {', '.join(missing)}"
        if self._faults:
            return "; ".join(self._faults.values())
        if now_ns - self._paired_ns > SILENT_NS:
            tolerance_ms = 1e-6 * self._pairs.tolerance_ns
            left, right = self._names.images
            return f"{right}: no image within {tolerance_ms:g} ms of any of {left}"
        if self._poses is not None and now_ns - self._ready_ns > SILENT_NS:
            return f"{self._poses.topic}: no poses for the times of the images"
        return None

    @contextmanager
    def _blaming(self, kind: str) -> Iterator[None]:
        """Takes an InputError for a fault of that kind, and its absence for the end of one."""
        try:
            yield
        except InputError as error:
            self._blame(kind, str(error))
        else:
            self._faults.pop(kind, None)

    def _blame(self, kind: str, line: str) -> None:
        self._faults[kind] = line
        if line not in self._told:
            self._told.add(line)
            self._tell(line)


def _content(info: Any) -> tuple[object, ...]:
    """All but the header."""
    numbers = tuple(np.asarray(getattr(info, name)).tobytes() for name in "dkrp")
    roi = info.roi
    area = roi.x_offset, roi.y_offset, roi.width, roi.height
    return info.width, info.height, info.distortion_model, numbers, info.binning_x, info.binning_y, area
