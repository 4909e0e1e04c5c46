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
NOT_OPENED = "no camera that OpenCV can open: not there, or in use"

Image = NDArray[np.uint8]


class Device(Protocol):
    """One camera."""

    def read(self) -> Image | None:
        """Blocks until there is a picture, grey. None: it has failed."""
        ...

    def close(self) -> None: ...


class Capture:
    """A device of OpenCV. Raises InputError when it does not open."""

    def __init__(self, name: str, size_px: tuple[int, int] | None = None) -> None:
        """size_px: (width, height) to ask for; not every device listens. None: as it comes up."""
        try:
            self._capture = cv2.VideoCapture(int(name) if name.isdecimal() else name)
        except cv2.error:  # such as a number that is none of a device
            raise InputError(name, NOT_OPENED) from None
        if not self._capture.isOpened():
            raise InputError(name, NOT_OPENED)
        if size_px is not None:
            self._capture.set(cv2.CAP_PROP_FRAME_WIDTH, size_px[0])
            self._capture.set(cv2.CAP_PROP_FRAME_HEIGHT, size_px[1])
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)  # older pictures are of no use; not all drivers listen

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
    def size_px(self) -> tuple[int, int]:
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
            index, said = 0, False
            while not stopped.is_set():
                skipped = self.skipped
                pair = self._pair(stopped)
                if pair is not None:
                    left, right, taken_ns = pair
                    yield Shot(Frame(index, taken_ns, left, right, None), taken_ns)
                    index += 1
                elif not said and self.skipped > skipped + 1 and not stopped.is_set():
                    tell(
                        " and ".join(self._names), f"no two pictures within {1e-6 * self._tolerance_ns:g} ms"
                    )
                said = pair is None and (said or self.skipped > skipped + 1)
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
        width = self.size_px[0]
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
                self._reopen(k, stopped, image)

    def _reopen(self, k: int, stopped: Event, image: Image | None) -> None:
        """image: what it delivers instead of pictures of its size, if anything."""
        device, self._devices[k] = self._devices[k], None
        if device is not None:
            device.close()
            reason = (
                "lost" if image is None else f"delivers {extent(image.shape)}, before {extent(self._shape)}"
            )
            tell(self._names[k], f"{reason}; trying to open it again")
        if stopped.wait(REOPEN_S):
            return
        try:
            self._devices[k] = self._open(self._names[k])
        except InputError:
            return
        tell(self._names[k], "back")

    def _open_all(self) -> tuple[int, int]:
        """The shape of the pictures of each device."""
        shapes: list[tuple[int, int]] = []
        for name in self._names:
            device = self._open(name)
            self._devices.append(device)
            image = device.read()
            if image is None:
                raise InputError(name, "delivers no picture")
            shapes.append((image.shape[0], image.shape[1]))
        if shapes[0] != shapes[-1]:
            others = f"{self._names[0]} {extent(shapes[0])}"
            raise InputError(self._names[-1], f"delivers {extent(shapes[-1])}, {others}")
        if len(shapes) == 1 and shapes[0][1] % 2:
            raise InputError(self._names[0], f"delivers {extent(shapes[0])}, no two views side by side")
        return shapes[0]


def extent(shape: tuple[int, ...]) -> str:
    return f"{shape[1]}x{shape[0]} px"


def tell(name: str, text: str) -> None:
    print(f"vista: {name}: {text}", file=sys.stderr, flush=True)
