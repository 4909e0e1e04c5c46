"""What vista-fly takes along: a rig, parameters, and frames if it is a recording (little-endian, unpadded).

head    char[8] "VISTAREC", uint32 version = 5, width, height, tables (how raw images are rectified: 0: they
        come rectified, 1: by a map, 2: by a control grid), rectify_rows, content (of a frame: 0: a raw pair,
        1: the rectified left image and words, 2: the rectified pair and words), stills (1: each frame shows
        another scene), number of parameters,
        double focal_px, cx, cy, baseline_m (rectified), left_from_rectified[9] (row-major rotation);
        of the raw right camera double fx, fy, cx, cy, distortion[8], rectified_from_right[9] (rotation),
        uint64 lens (0: pinhole, 1: fisheye), as vista/correction.h has them;
        char[192] what is wrong with the baseline, char[192] what with the calibration (empty: nothing)
then    parameters: char[48] "section.name", char[32] name of a choice (empty: a number), both zero-padded,
        double value (0 for a choice)
then    for the left and for the right camera, with a map: int16 (u, v)[height][width], whole pixels of the
        source, uint16 fraction[height][width], 32 * v + u in 1/32 px; with a grid: int16 (dx, dy) of each
        control point (doc/design/engine-contract.md)
then    frames to the end of the file: int64 t_ns, uint32 index, uint32 flags (1: poses begin anew, 2: there
        is a pose, 4: a direction), double rotation[9], translation_m[3] (world_from_camera: of the raw left
        camera, with words of the rectified one), up_world[3]; zeros where there is none;
        uint8 left[height][width], right[height][width] if there is one, and with words int16 disparities
        (1/16 px, negative = invalid) of each of stereo.levels levels, each half the size of the one before,
        rounded up
"""

from __future__ import annotations

import struct
import subprocess
from collections.abc import Sequence as Levels
from enum import IntEnum
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista import native, parameters
from vista.errors import InputError
from vista.geometry import Array, Calibration, Pose, rectified_rig
from vista.health.finding import Reason
from vista.health.monitor import HealthMonitor
from vista.output import check_replaceable, unwritable
from vista.rectify import Rectifier
from vista.sequence import Frame, Sequence

MAGIC, VERSION = b"VISTAREC", 5
HEAD = struct.Struct("<8s8I4d9d4d8d9dQ192s192s")
PARAMETER = struct.Struct("<48s32sd")
FRAME = struct.Struct("<q2I9d3d3d")
PROBLEMS = (Reason.BASELINE_IMPLAUSIBLE, Reason.CALIBRATION_MISFIT)
ANEW, HAS_POSE, HAS_UP = 1, 2, 4


class Content(IntEnum):
    """What a frame holds."""

    RAW = 0
    LEFT = 1
    PAIR = 2


def head_bytes(
    recorded: Sequence, rectifier: Rectifier, values: parameters.Values, content: Content = Content.RAW
) -> bytes:
    """Everything but frames: a rig, if none follow."""
    found = {finding.reason: finding.text for finding in HealthMonitor(recorded).of_run}
    tables = [_table_bytes(table) for table in rectifier.grids_or_maps]
    camera, right, flat = rectifier.calibration, rectifier.right, parameters.flat(values)
    head = HEAD.pack(
        MAGIC,
        VERSION,
        camera.width,
        camera.height,
        0 if not tables else 1 if rectifier.grids is None else 2,
        int(values["stereo"]["rectify_rows"]),
        content,
        recorded.stills,
        len(flat),
        camera.focal_px,
        camera.cx,
        camera.cy,
        camera.baseline_m,
        *rectifier.left_from_rectified.rotation.ravel(),
        *right.intrinsics_px,
        *right.distortion,
        *right.rectified_from_raw.ravel(),
        right.lens,
        *(found.get(reason, "").encode()[:191] for reason in PROBLEMS),
    )
    return head + b"".join(map(_parameter_bytes, flat.items())) + b"".join(tables)


def _parameter_bytes(item: tuple[str, Any]) -> bytes:
    name, value = item
    choice, number = (value, 0.0) if isinstance(value, str) else ("", float(value))
    return PARAMETER.pack(name.encode(), choice.encode(), number)


def _table_bytes(table: Any) -> bytes:
    """A control grid, or the two parts of a map."""
    if not isinstance(table, tuple):
        return bytes(table.astype("<i2").tobytes())
    whole, fraction = table
    return bytes(whole.astype("<i2").tobytes() + fraction.astype("<u2").tobytes())


class Recorder:
    """Writes a recording beside its target; leaving the `with` block puts it in place, whole frames only."""

    def __init__(
        self,
        path: Path,
        recorded: Sequence,
        rectifier: Rectifier,
        values: parameters.Values,
        content: Content = Content.RAW,
    ) -> None:
        self._path, self._content = path, content
        self._part = path.with_name(f".{path.name}.part")
        self._up_world = recorded.up_world
        self._levels = int(values["stereo"]["levels"]) if content != Content.RAW else 0
        head = head_bytes(recorded, rectifier, values, content)
        check_replaceable(path)
        try:
            self._stream = self._part.open("wb")
        except OSError as error:
            raise unwritable(self._path, error) from None
        self._write(head)
        self._frames = 0

    def write(self, frame: Frame, levels: Levels[NDArray[np.int16]] = (), anew: bool = False) -> None:
        """frame: raw, or rectified if its words are recorded; levels: the words of each; anew: the poses
        begin anew. Raises InputError when the file cannot be written."""
        if len(levels) != self._levels:
            raise ValueError(f"{len(levels)} levels in a recording of {self._levels}")
        head = frame_head(frame.t_ns, frame.index, anew, frame.world_from_camera, self._up_world)
        right = b"" if self._content == Content.LEFT else frame.right.tobytes()
        words = b"".join(level.astype("<i2", copy=False).tobytes() for level in levels)
        self._write(head + frame.left.tobytes() + right + words)
        self._frames += 1

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """A raw recording is whole or not there; of words, an image that cannot be read ends it."""
        over = self._content != Content.RAW and kind is not None and issubclass(kind, InputError)
        try:
            self._stream.close()
            if self._frames > 0 and (kind is None or over):
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


def rectified_source(camera: Calibration, stills: bool = False, up_world: Array | None = None) -> Sequence:
    """Cameras that give rectified pairs, as a source has them, without frames."""
    raw = rectified_rig(camera, "rectified cameras")
    return Sequence("rectified", "pairs", raw, frames=(), up_world=up_world, stills=stills)


def played(
    path: Path, passes: int, threads: int = 1, paced: bool = False
) -> tuple[dict[str, NDArray[np.float64]], list[str]]:
    """Plays a recording with vista-fly, all frames one after the other, or paced, as fast as they were taken,
    where a frame may give way to a newer one. Returns the milliseconds of each frame by stage and pass,
    and the lines of all frames. Raises InputError with what vista-fly says."""
    with TemporaryDirectory() as folder:
        times = Path(folder, "times.csv")
        command = [str(native.program_path("vista-fly", "build")), "--recording", str(path)]
        command += [] if paced else ["--all-frames"]
        command += ["--passes", str(passes), "--threads", str(threads), "--times", str(times), "--out", "-"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise InputError("vista-fly", done.stderr.strip().removeprefix("vista-fly: "))
        names = times.read_text().partition("\n")[0].split(",")
        table = np.loadtxt(times, delimiter=",", skiprows=1, ndmin=2)
    return dict(zip(names, table.T, strict=True)), done.stdout.splitlines()


def frame_head(t_ns: int, index: int, anew: bool, pose: Pose | None, up_world: Array | None) -> bytes:
    numbers = np.zeros(15)
    if pose is not None:
        numbers[:9], numbers[9:12] = pose.rotation.ravel(), pose.translation_m
    if up_world is not None:
        numbers[12:] = up_world
    flags = ANEW * anew | HAS_POSE * (pose is not None) | HAS_UP * (up_world is not None)
    return FRAME.pack(t_ns, index, flags, *numbers)
