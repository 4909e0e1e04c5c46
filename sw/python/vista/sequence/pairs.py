"""A folder of pairs NAME_left.EXT / NAME_right.EXT with calibration.toml; no poses: a still camera, 10 Hz.

calibration.toml for images that are already rectified:

    focal_px = 451.0345
    cx = 299.038          # principal point, px
    cy = 255.165
    baseline_m = 0.075

and for cameras as calibrated, which are then rectified (cv2.stereoCalibrate's K, D, R and T):

    [left]                # and [right]
    fx_px = 524.614
    fy_px = 526.920
    cx = 312.451
    cy = 247.402
    distortion = [-0.36254, 0.17533, 0.0, 0.0]   # k1, k2, p1, p2[, k3]; may be left out
    [right_from_left]     # p_right = rotation p_left + translation_m
    rotation = [1.0, 0.0, 0.0,  0.0, 1.0, 0.0,  0.0, 0.0, 1.0]
    translation_m = [-0.12, 0.0, 0.0]
"""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from vista.errors import InputError
from vista.geometry import CameraModel, Pose, RawCalibration, camera_matrix, is_rotation
from vista.sequence.image import EXTENSIONS, read_size
from vista.sequence.text import read_text
from vista.sequence.types import FrameFiles, Sequence

FRAME_PERIOD_NS = 100_000_000


def recognises(folder: Path) -> bool:
    return (folder / "calibration.toml").exists() or any(_images(folder, "_left"))


def open_folder(folder: Path) -> Sequence:
    pairs = _find_pairs(folder)
    calibration = read_calibration(folder / "calibration.toml", read_size(pairs[0][0]))
    frames = (
        FrameFiles(index, index * FRAME_PERIOD_NS, left, right, None)
        for index, (left, right) in enumerate(pairs)
    )
    return Sequence(folder.resolve().name, "pairs", calibration, tuple(frames))


def _images(folder: Path, side: str) -> list[Path]:
    return sorted(p for p in folder.iterdir() if p.suffix.lower() in EXTENSIONS and p.stem.endswith(side))


def _find_pairs(folder: Path) -> list[tuple[Path, Path]]:
    lefts = _images(folder, "_left")
    pairs = [(left, left.with_stem(left.stem.removesuffix("_left") + "_right")) for left in lefts]
    for _, right in pairs:
        if not right.is_file():
            raise InputError(right, "no such file: the right image is missing")
    paired = {right for _, right in pairs}
    for right in _images(folder, "_right"):
        if right not in paired:
            left = right.with_stem(right.stem.removesuffix("_right") + "_left")
            raise InputError(left, "no such file: the left image is missing")
    if not pairs:
        raise InputError(folder, "holds no images NAME_left.EXT, NAME_right.EXT")
    return pairs


def read_calibration(path: Path, size: tuple[int, int]) -> RawCalibration:
    """Either form of calibration.toml; size: (width, height) of the images."""
    try:
        table = tomllib.loads(read_text(path))
    except tomllib.TOMLDecodeError as error:
        raise InputError(path, f"not readable as TOML: {error}") from None
    return _read_raw(path, table, size) if "left" in table else _read_rectified(path, table, size)


def _read_rectified(path: Path, table: dict[str, Any], size: tuple[int, int]) -> RawCalibration:
    _refuse_unknown(path, table, {"focal_px", "cx", "cy", "baseline_m"})
    focal_px = _positive(path, table, "focal_px")
    baseline_m = _positive(path, table, "baseline_m")
    matrix = camera_matrix(focal_px, focal_px, _number(path, table, "cx"), _number(path, table, "cy"))
    camera = CameraModel(*size, matrix)
    return RawCalibration(camera, camera, Pose(np.eye(3), np.array([-baseline_m, 0.0, 0.0])), str(path))


def _read_raw(path: Path, table: dict[str, Any], size: tuple[int, int]) -> RawCalibration:
    _refuse_unknown(path, table, {"left", "right", "right_from_left"})
    left = _read_camera(path, _table(path, table, "left"), size)
    right = _read_camera(path, _table(path, table, "right"), size)
    motion = _table(path, table, "right_from_left")
    rotation = np.array(_numbers(path, motion, "rotation", {9})).reshape(3, 3)
    if not is_rotation(rotation):
        raise InputError(path, "rotation is not a rotation matrix")
    translation_m = np.array(_numbers(path, motion, "translation_m", {3}))
    return RawCalibration(left, right, Pose(rotation, translation_m), str(path))


def _read_camera(path: Path, table: dict[str, Any], size: tuple[int, int]) -> CameraModel:
    _refuse_unknown(path, table, {"fx_px", "fy_px", "cx", "cy", "distortion"})
    fx, fy = _positive(path, table, "fx_px"), _positive(path, table, "fy_px")
    matrix = camera_matrix(fx, fy, _number(path, table, "cx"), _number(path, table, "cy"))
    if "distortion" not in table:
        return CameraModel(*size, matrix)
    return CameraModel(*size, matrix, tuple(_numbers(path, table, "distortion", {4, 5})))


def _refuse_unknown(path: Path, table: dict[str, Any], known: set[str]) -> None:
    unknown = sorted(table.keys() - known)
    if unknown:
        raise InputError(path, f"unknown key {unknown[0]}; known: {', '.join(sorted(known))}")


def _table(path: Path, table: dict[str, Any], key: str) -> dict[str, Any]:
    value = table.get(key)
    if not isinstance(value, dict):
        raise InputError(path, f"table [{key}] is missing")
    return value


def _finite(path: Path, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(path, f"{key} is no finite number: {value}")
    return float(value)


def _number(path: Path, table: dict[str, Any], key: str) -> float:
    if key not in table:
        raise InputError(path, f"{key} is missing")
    return _finite(path, key, table[key])


def _positive(path: Path, table: dict[str, Any], key: str) -> float:
    value = _number(path, table, key)
    if value <= 0.0:
        raise InputError(path, f"{key} is {value:g}, must be positive")
    return value


def _numbers(path: Path, table: dict[str, Any], key: str, counts: set[int]) -> list[float]:
    values = table.get(key)
    if not isinstance(values, list) or len(values) not in counts:
        raise InputError(path, f"{key} must be a list of {' or '.join(map(str, sorted(counts)))} numbers")
    return [_finite(path, key, value) for value in values]
