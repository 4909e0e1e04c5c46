"""Cameras through OpenCV: one whose picture holds both views side by side, or a device for each view.

A device is what cv2.VideoCapture opens: a number or a path of V4L2, an address, a pipeline of GStreamer.
Frames are timed when they arrive, since few cameras say when they expose. A device that fails is opened again
until it is back.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from threading import Condition, Event, Thread
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.live.source import Shot
from vista.sequence import Frame

PAIR_TOLERANCE_MS = 5.0  # unless stated otherwise
REOPEN_S = 1.0
PAIR_S = 1.0  # after so long without a pair, say why
FAILURES = 3  # readings in a row: some drivers lose one
JOIN_S = 1.0

Image = NDArray[np.uint8]


class Device(Protocol):
    """One camera."""

    def read(self) -> Image | None:
        """Blocks until there is a picture, grey. None: it has failed."""
        ...

    def close(self) -> None: ...


class Capture:
    """A device of OpenCV. Raises InputError when it does not open, or has no pictures of the size."""

    def __init__(self, name: str, size: tuple[int, int] | None = None) -> None:
        """size: (width, height) of its pictures; None: as it comes up."""
        self._capture = cv2.VideoCapture(int(name) if name.isdecimal() else name)
        if not self._capture.isOpened():
            raise InputError(name, "no camera that OpenCV can open")
        if size is not None:
            self._ask_for(name, size)
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)  # older pictures are of no use; not all drivers listen

    def _ask_for(self, name: str, size: tuple[int, int]) -> None:
        """A driver may take the nearest size that it has, and says so afterwards."""
        sides = (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
        for side, pixels in zip(sides, size, strict=True):
            self._capture.set(side, pixels)
        given = [round(self._capture.get(side)) for side in sides]
        if tuple(given) != size:
            self.close()
            raise InputError(name, "delivers {}x{} px, not {}x{}".format(*given, *size))

    def read(self) -> Image | None:
        there, picture = self._capture.read()
        if not there:
            return None
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) if picture.ndim == 3 else picture
        return np.asarray(grey, np.uint8)

    def close(self) -> None:
        self._capture.release()


@dataclass(frozen=True)
class Picture:
    image: Image
    arrived_ns: int


class Cameras:
    """A source of a live run. Without poses: the host is told nothing of the aircraft's motion."""

    def __init__(
        self,
        names: Sequence[str],
        tolerance_ms: float,
        open_device: Callable[[str], Device] = Capture,
    ) -> None:
        """names: of the camera with both views, or of the left and the right one; tolerance_ms: how far two
        pictures of a pair may lie apart. Raises InputError for a device that does not open or deliver, and
        for two whose pictures differ in size."""
        self.skipped = 0  # pictures of one camera for which the other had none
        self._names, self._open = tuple(names), open_device
        self._tolerance_ns = int(1e6 * tolerance_ms)
        self._changed = Condition()
        self._newest: list[Picture | None] = [None] * len(names)
        self._devices: list[Device | None] = []
        try:
            self._shape = self._open_all()
        except InputError:
            self.close()
            raise

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) of the image of one camera."""
        height, width = self._shape
        return width // (1 if len(self._names) > 1 else 2), height

    def close(self) -> None:
        for device in self._devices:
            if device is not None:
                device.close()

    def shots(self, stopped: Event) -> Iterator[Shot]:
        threads = [
            Thread(target=self._watch, args=(k, stopped), name=name, daemon=True)
            for k, name in enumerate(self._names)
        ]
        for thread in threads:
            thread.start()
        try:
            index = 0
            while not stopped.is_set():
                pair = self._pair(stopped)
                if pair is not None:
                    left, right, taken_ns = pair
                    yield Shot(Frame(index, taken_ns, left, right, None), taken_ns)
                    index += 1
        finally:
            for thread in threads:
                thread.join(JOIN_S)  # one that hangs in its driver is left behind

    def _pair(self, stopped: Event) -> tuple[Image, Image, int] | None:
        """The next pair and the mean of its times. None: none came in a second."""
        deadline_s = time.monotonic() + PAIR_S
        with self._changed:
            while time.monotonic() < deadline_s and not stopped.is_set():
                if all(self._newest):
                    taken = self._matching()
                    if taken is not None:
                        return self._views(taken)
                self._changed.wait(0.1)
        return None

    def _matching(self) -> list[Picture] | None:
        """Takes the newest pictures if they belong together, else drops the older one."""
        pictures = [picture for picture in self._newest if picture is not None]
        times_ns = [picture.arrived_ns for picture in pictures]
        if max(times_ns) - min(times_ns) > self._tolerance_ns:
            self._newest[int(np.argmin(times_ns))] = None
            self.skipped += 1
            return None
        self._newest = [None] * len(self._newest)
        return pictures

    def _views(self, taken: list[Picture]) -> tuple[Image, Image, int]:
        width = self.size[0]
        left, right = taken[0].image, taken[-1].image
        if len(taken) == 1:
            left, right = left[:, :width], right[:, width:]
        times_ns = [picture.arrived_ns for picture in taken]
        return np.ascontiguousarray(left), np.ascontiguousarray(right), sum(times_ns) // len(times_ns)

    def _watch(self, k: int, stopped: Event) -> None:
        """Reads one device for good, and opens it again when it fails."""
        failures = 0
        while not stopped.is_set():
            device = self._devices[k]
            image = None if device is None else device.read()
            if image is not None and image.shape == self._shape:
                failures = 0
                with self._changed:
                    self._newest[k] = Picture(image, time.monotonic_ns())
                    self._changed.notify_all()
                continue
            failures += 1
            if device is None or failures >= FAILURES:
                failures = 0
                self._reopen(k, stopped)

    def _reopen(self, k: int, stopped: Event) -> None:
        device, self._devices[k] = self._devices[k], None
        if device is not None:
            device.close()
            print(f"vista: {self._names[k]}: lost; trying to open it again", file=sys.stderr, flush=True)
        if stopped.wait(REOPEN_S):
            return
        try:
            self._devices[k] = self._open(self._names[k])
        except InputError:
            return
        print(f"vista: {self._names[k]}: back", file=sys.stderr, flush=True)

    def _open_all(self) -> tuple[int, int]:
        """The shape of the pictures of each device."""
        shapes = []
        for name in self._names:
            device = self._open(name)
            self._devices.append(device)
            image = device.read()
            if image is None:
                raise InputError(name, "delivers no picture")
            shapes.append(image.shape)
        (height, width), (height_too, width_too) = shapes[0], shapes[-1]
        if (height, width) != (height_too, width_too):
            raise InputError(
                self._names[-1], f"delivers {width_too}x{height_too} px, {self._names[0]} {width}x{height}"
            )
        if len(shapes) == 1 and width % 2:
            raise InputError(self._names[0], f"delivers {width}x{height} px, no two views side by side")
        return height, width
