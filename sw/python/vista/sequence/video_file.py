"""One video file through OpenCV: the times of its frames, and its frames by their number."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError

os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # its own lines would come on top of ours
NOT_READABLE = "not readable as a video: damaged, truncated, or of a codec that OpenCV does not have here"
SHARE_OF_PERIOD = 0.5  # how far a time may be off before it counts as that of another frame


class VideoFile:
    """Frames are decoded one after the other; going back starts again at the first one, because seeking is
    not exact in every container."""

    def __init__(self, path: Path) -> None:
        """InputError: not readable, truncated, or nothing in it."""
        self.path = path
        self._check_content()
        packets_ms = self._packet_times_ms()
        self.count = len(packets_ms)
        if self.count == 0:
            raise InputError(path, NOT_READABLE)
        self._gap_ms = float(np.max(np.diff(packets_ms))) if self.count > 1 else 0.0
        self._check_whole(packets_ms)
        self._rewind()
        first_ms = self._decode(0)
        self._times_ms = [ms - packets_ms[0] + first_ms for ms in packets_ms]
        self._timed = bool(np.all(np.isfinite(packets_ms)) and np.all(np.diff(packets_ms) > 0.0))

    def read_size(self) -> tuple[int, int]:
        """(width, height) of the frames."""
        height, width = self.read_grey(0).shape
        return width, height

    def times_ns(self) -> list[int]:
        """Times of the frames, from 0 at the start of the file, as the container has them."""
        if not self._timed:
            raise InputError(self.path, "has no times that increase; give the frames per second, --rate")
        return [round(1e6 * ms) for ms in self._times_ms]

    def read_grey(self, index: int) -> NDArray[np.uint8]:
        """Colour turns grey as that of images does."""
        if index < self._at:
            self._rewind()
        while self._at < index - 1:
            if not self._capture.grab():
                raise self._undecodable(index)
            self._at += 1
        if self._at < index:
            self._decode(index)
        return self._frame

    def _check_content(self) -> None:
        try:
            if self.path.stat().st_size == 0:
                raise InputError(self.path, "empty file")
        except OSError as error:
            raise InputError(self.path, (error.strerror or "cannot be read").lower()) from None

    def _open(self) -> cv2.VideoCapture:
        try:
            capture = cv2.VideoCapture(str(self.path), cv2.CAP_FFMPEG)
        except cv2.error:
            raise InputError(self.path, NOT_READABLE) from None
        if not capture.isOpened():
            raise InputError(self.path, NOT_READABLE)
        return capture

    def _packet_times_ms(self) -> list[float]:
        """Times in the order of showing, without decoding the frames. Sets how many frames the container
        states."""
        capture = self._open()
        stated, rate = capture.get(cv2.CAP_PROP_FRAME_COUNT), capture.get(cv2.CAP_PROP_FPS)
        self._stated_ms = 1e3 * stated / rate if stated > 0.0 and rate > 0.0 else 0.0
        self._stated = max(round(stated), 0) if np.isfinite(stated) else 0
        capture.set(cv2.CAP_PROP_FORMAT, -1)  # packets as they are
        times_ms = []
        while capture.grab():
            times_ms.append(capture.get(cv2.CAP_PROP_POS_MSEC))
        return sorted(times_ms)

    def _check_whole(self, packets_ms: list[float]) -> None:
        """A file that ends early has fewer frames than its header states, and ends before the stated time.
        The number alone tells little: where the rate varies it is an estimate."""
        ends_ms = packets_ms[-1] - packets_ms[0] + self._gap_ms
        if self.count < self._stated and ends_ms < self._stated_ms - SHARE_OF_PERIOD * self._gap_ms:
            raise InputError(self.path, f"truncated: {self.count} of the {self._stated} frames are there")

    def _rewind(self) -> None:
        self._capture = self._open()
        self._at = -1

    def _decode(self, index: int) -> float:
        """The next frame, which has to be this one; returns its time, in ms."""
        done, image = self._capture.read()
        if not done or image is None or image.dtype != np.uint8:
            raise self._undecodable(index)
        t_ms = self._capture.get(cv2.CAP_PROP_POS_MSEC)
        if index > 0 and self._timed and abs(t_ms - self._times_ms[index]) > SHARE_OF_PERIOD * self._gap_ms:
            raise self._undecodable(index)  # the decoder has dropped one, and this is a later one
        self._at = index
        grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        self._frame = np.asarray(grey, np.uint8)
        return t_ms

    def _undecodable(self, index: int) -> InputError:
        return InputError(self.path, f"frame {index} of {self.count} cannot be decoded: damaged or truncated")
