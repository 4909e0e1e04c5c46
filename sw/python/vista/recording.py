"""Recordings of what the host receives, for the replay program in C (little-endian, no padding).

    header  char[8] "VISTAREC", uint32 version = 4, uint32 width, uint32 height, uint32 parameter count,
            double focal_px, cx, cy, baseline_m, uint32 coarser levels (0: level 0 only)
    parameter  char[48] "section.name", char[32] name of a choice (empty: a number), both zero-padded,
            double value (0 for a choice)
    frame   int64 t_ns, uint32 anew (1: the host forgets what came before), uint32 has_pose, uint32 has_up,
            double rotation[9], translation_m[3] (world_from_camera; zeros without a pose),
            double up_world[3] (zeros without),
            uint8 left[height][width], int16 disparity[height][width] (1/16 px, negative = invalid),
            and the disparities of each coarser level, half the size of the one before, rounded up

Frames follow each other to the end of the file.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence as Levels
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from vista import parameters
from vista.errors import InputError
from vista.geometry import Calibration
from vista.output import check_replaceable, unwritable
from vista.sequence import Frame, Sequence

MAGIC = b"VISTAREC"
VERSION = 4
HEADER = struct.Struct("<8s4I4dI")
PARAMETER = struct.Struct("<48s32sd")
FRAME = struct.Struct("<q3I9d3d3d")


class Recorder:
    """Writes a recording beside its target; leaving the `with` block puts it in place, whole frames only."""

    def __init__(
        self, path: Path, sequence: Sequence, camera: Calibration, values: parameters.Values
    ) -> None:
        self._path = path
        self._part = path.with_name(f".{path.name}.part")
        self._up_world = sequence.up_world
        self._levels = values["stereo"]["levels"]
        check_replaceable(path)
        try:
            self._stream = self._part.open("wb")
        except OSError as error:
            raise unwritable(self._path, error) from None
        self._write(
            HEADER.pack(
                MAGIC,
                VERSION,
                camera.width,
                camera.height,
                sum(len(content) for content in values.values()),
                camera.focal_px,
                camera.cx,
                camera.cy,
                camera.baseline_m,
                self._levels - 1,
            )
        )
        for name, value in parameters.flat(values).items():
            choice, number = (value, 0.0) if isinstance(value, str) else ("", float(value))
            self._write(PARAMETER.pack(name.encode(), choice.encode(), number))
        self._frames = 0

    def write(self, frame: Frame, levels: Levels[NDArray[np.int16]], anew: bool) -> None:
        """frame: rectified; levels: the words of each; anew: the host was reset before it. Raises InputError
        when the file cannot be written."""
        if len(levels) != self._levels:
            raise ValueError(f"{len(levels)} levels in a recording of {self._levels}")
        pose, up = frame.world_from_camera, self._up_world
        numbers = np.zeros(15)
        if pose is not None:
            numbers[:9], numbers[9:12] = pose.rotation.ravel(), pose.translation_m
        if up is not None:
            numbers[12:] = up
        head = FRAME.pack(frame.t_ns, anew, pose is not None, up is not None, *numbers)
        words = b"".join(level.astype("<i2", copy=False).tobytes() for level in levels)
        self._write(head + frame.left.tobytes() + words)
        self._frames += 1

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._stream.close()
            if self._frames > 0 and (kind is None or issubclass(kind, InputError)):
                self._part.replace(self._path)
        except OSError as error:
            raise unwritable(self._path, error) from None
        finally:
            self._part.unlink(missing_ok=True)

    def _write(self, data: bytes) -> None:
        try:
            self._stream.write(data)
        except OSError as error:
            raise unwritable(self._path, error) from None
