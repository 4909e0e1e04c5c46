"""A scene of the Middlebury stereo data sets: one pair, judged by itself.

2014 and 2021: im0.png, im1.png and calib.txt with both cameras, `doffs` (how many pixels further right the
principal point of the right camera lies: Z = f B / (d + doffs)) and the baseline in millimetres.
Rectification takes doffs out. The scenes before have im2 and im6, or view1 and view5, and no calibration, so
that a calibration.toml is needed.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from vista.errors import InputError
from vista.geometry import Array, CameraModel, Pose, RawCalibration
from vista.sequence.image import EXTENSIONS, read_size
from vista.sequence.options import Options
from vista.sequence.pairs import read_calibration_file
from vista.sequence.text import data_lines, finite, finite_row
from vista.sequence.types import FrameFiles, Sequence

NAME = "Middlebury"
TAKES = frozenset({"calibration"})
IMAGES = (("im0", "im1"), ("im2", "im6"), ("view1", "view5"))
DOFFS_TOLERANCE_PX = 0.01  # calib.txt has three digits
MATRIX = re.compile(r"\[([^;]*);([^;]*);([^;]*)\]")


def recognises(path: Path) -> bool:
    return _pair(path) is not None


def open_source(folder: Path, options: Options) -> Sequence:
    pair = _pair(folder)
    assert pair is not None  # recognised
    size = read_size(pair[0])
    own, toml = folder / "calib.txt", options.calibration or folder / "calibration.toml"
    if options.calibration is None and own.exists():
        calibration = read_calibration(own, size)
    elif toml.exists():
        calibration = read_calibration_file(toml, size).calibration
    else:
        raise InputError(own, f"no such file, and no {toml}; give --calibration")
    frame = FrameFiles(0, 0, *pair, None)
    return Sequence(folder.resolve().name, NAME, calibration, (frame,), stills=True)


def _pair(folder: Path) -> tuple[Path, Path] | None:
    for left, right in IMAGES:
        for extension in EXTENSIONS:
            paths = folder / (left + extension), folder / (right + extension)
            if all(path.is_file() for path in paths):
                return paths
    return None


def read_calibration(path: Path, size: tuple[int, int]) -> RawCalibration:
    """size: (width, height) of the images."""
    entries: dict[str, tuple[str, str]] = {}
    for culprit, line in data_lines(path):
        key, _, value = line.partition("=")
        entries[key.strip()] = culprit, value.strip()
    for key in ("cam0", "cam1", "doffs", "baseline", "width", "height"):
        if key not in entries:
            raise InputError(path, f"{key} is missing")
    left, right = (_matrix(*entries[key]) for key in ("cam0", "cam1"))
    doffs_px, baseline_mm, *stated = (
        finite(*entries[key]) for key in ("doffs", "baseline", "width", "height")
    )
    if tuple(stated) != size:
        raise InputError(path, f"is for images of {stated[0]:g}x{stated[1]:g}, these are {size[0]}x{size[1]}")
    if abs(right[0, 2] - left[0, 2] - doffs_px) > DOFFS_TOLERANCE_PX:
        difference = right[0, 2] - left[0, 2]
        raise InputError(entries["doffs"][0], f"doffs is {doffs_px:g}, but cam0 and cam1 say {difference:g}")
    if baseline_mm <= 0.0:
        raise InputError(entries["baseline"][0], f"baseline is {baseline_mm:g} mm, must be positive")
    motion = Pose(np.eye(3), np.array([-baseline_mm / 1000.0, 0.0, 0.0]))
    return RawCalibration(CameraModel(*size, left), CameraModel(*size, right), motion, str(path))


def _matrix(culprit: str, text: str) -> Array:
    rows = MATRIX.fullmatch(text)
    if rows is None:
        raise InputError(culprit, "expected a matrix [f 0 cx; 0 f cy; 0 0 1]")
    matrix = np.array([finite_row(culprit, row.split(), 3) for row in rows.groups()])
    if matrix[0, 0] <= 0.0 or matrix[1, 1] <= 0.0 or not np.array_equal(matrix[2], [0.0, 0.0, 1.0]):
        raise InputError(culprit, "expected a matrix [f 0 cx; 0 f cy; 0 0 1] with positive focal lengths")
    return matrix
