"""A folder of pairs NAME_left.EXT / NAME_right.EXT with calibration.toml, and optionally times and poses.

calibration.toml for images that are already rectified:

    focal_px = 451.0345
    cx = 299.038          # principal point, px
    cy = 255.165
    baseline_m = 0.075

    stills = true         # may be left out: the pairs show unrelated scenes, each is judged by itself

and for cameras as calibrated, which are then rectified (cv2.stereoCalibrate's K, D, R and T):

    [left]                # and [right]
    fx_px = 524.614
    fy_px = 526.920
    cx = 312.451
    cy = 247.402
    distortion = [-0.36254, 0.17533, 0.0, 0.0]   # k1, k2, p1, p2[, k3[, k4, k5, k6]]; may be left out
    lens = "pinhole"      # may be left out; "fisheye" has k1 to k4 of cv2.fisheye
    [right_from_left]     # p_right = rotation p_left + translation_m
    rotation = [1.0, 0.0, 0.0,  0.0, 1.0, 0.0,  0.0, 0.0, 1.0]
    translation_m = [-0.12, 0.0, 0.0]

size_px = [640, 480] before the first table may say what images it belongs to; others are refused.
[body_from_left] and [body_from_right] with rotation and translation_m may say where the cameras are on the
vehicle, for other programs (vista calibrate); they have to agree with [right_from_left].

Optional files (tables.py): times.csv gives each pair its time, and the frames come in the order of the times;
without it the pairs come in the order of their names, ten a second. poses.csv gives poses of the left camera;
they are interpolated to the times of the pairs, so times.csv has to be there, too. Frames outside the time of
the poses are left out, and a note says how many. In calibration.toml, before the first table,

    up_world = [0.0, 0.0, 1.0]

may say where up is in the world of the poses; without it, up is opposite to the downward axis of the camera.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np

from vista.errors import InputError
from vista.geometry import (
    Array,
    Calibration,
    CameraModel,
    Lens,
    Pose,
    RawCalibration,
    camera_matrix,
    is_rotation,
    poses_agree,
    rectified_rig,
)
from vista.sequence.image import EXTENSIONS, read_size
from vista.sequence.options import BY_ODOMETRY, Options
from vista.sequence.tables import read_poses, read_times
from vista.sequence.text import read_text
from vista.sequence.trajectory import UNIT_TOLERANCE, with_poses
from vista.sequence.types import FrameFiles, Sequence

CALIBRATION, TIMES = "calibration.toml", "times.csv"
FRAME_PERIOD_NS = 100_000_000
OF_SEQUENCE = ("stills", "up_world", "size_px")  # keys of either form of calibration.toml
OF_BODY = ("body_from_left", "body_from_right")
BODY_TOLERANCE = 1e-6


NAME = "pairs"
TAKES = frozenset({"calibration"})


@dataclass(frozen=True)
class Described:
    """What calibration.toml says."""

    calibration: RawCalibration
    up_world: Array | None
    stills: bool


def recognises(folder: Path) -> bool:
    return folder.is_dir() and ((folder / CALIBRATION).exists() or any(_images(folder, "_left")))


def open_source(folder: Path, options: Options) -> Sequence:
    pairs = _find_pairs(folder)
    described = read_calibration_file(options.calibration or folder / CALIBRATION, read_size(pairs[0][0]))
    times_path, poses_path = folder / TIMES, folder / "poses.csv"
    times_ns = [index * FRAME_PERIOD_NS for index in range(len(pairs))]
    if times_path.exists():
        times_ns = read_times(times_path, [left.stem.removesuffix("_left") for left, _ in pairs])
    elif poses_path.exists() or not options.of_source:
        asking = BY_ODOMETRY if options.odometry else options.poses or "poses.csv"
        raise InputError(times_path, f"no such file: {asking} needs the times of the pairs")
    in_order = sorted(zip(times_ns, pairs, strict=True))
    frames = tuple(FrameFiles(index, t_ns, *pair, None) for index, (t_ns, pair) in enumerate(in_order))
    notes: tuple[str, ...] = ()
    if options.of_source and poses_path.exists():
        frames, notes = with_poses(frames, read_poses(poses_path), poses_path)
    name, stills = folder.resolve().name, described.stills
    return Sequence(name, NAME, described.calibration, frames, described.up_world, notes, stills)


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


def read_table(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(read_text(path))
    except tomllib.TOMLDecodeError as error:
        raise InputError(path, f"not readable as TOML: {error}") from None


def _flag(path: Path, table: dict[str, Any], key: str) -> bool:
    value = table.get(key, False)
    if not isinstance(value, bool):
        raise InputError(path, f"{key} must be true or false, not {value!r}")
    return value


def _direction(path: Path, table: dict[str, Any], key: str) -> Array | None:
    if key not in table:
        return None
    direction = np.array(_numbers(path, table, key, {3}))
    length = float(np.linalg.norm(direction))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise InputError(path, f"{key} must have the length 1")
    return np.asarray(direction / length)


def read_calibration_file(path: Path, size_px: tuple[int, int]) -> Described:
    """size_px: (width, height) of the images."""
    table = read_table(path)
    calibration = read_calibration(path, table, size_px)
    return Described(calibration, _direction(path, table, "up_world"), _flag(path, table, "stills"))


def read_calibration(path: Path, table: dict[str, Any], size_px: tuple[int, int]) -> RawCalibration:
    """Either form of calibration.toml; size_px: (width, height) of the images."""
    own_size = read_size_px(path, table)
    if own_size is not None and own_size != size_px:
        own, images = ("{}x{}".format(*one) for one in (own_size, size_px))
        raise InputError(path, f"is for images of {own} px, these have {images}")
    return _read_raw(path, table, size_px) if "left" in table else _read_rectified(path, table, size_px)


def _read_rectified(path: Path, table: dict[str, Any], size_px: tuple[int, int]) -> RawCalibration:
    _refuse_unknown(path, table, {"focal_px", "cx", "cy", "baseline_m", *OF_SEQUENCE})
    focal_px = _positive(path, table, "focal_px")
    baseline_m = _positive(path, table, "baseline_m")
    center_px = _number(path, table, "cx"), _number(path, table, "cy")
    return rectified_rig(Calibration(*size_px, focal_px, *center_px, baseline_m), str(path))


def _read_raw(path: Path, table: dict[str, Any], size_px: tuple[int, int]) -> RawCalibration:
    _refuse_unknown(path, table, {"left", "right", "right_from_left", *OF_BODY, *OF_SEQUENCE})
    left = _read_camera(path, _table(path, table, "left"), size_px)
    right = _read_camera(path, _table(path, table, "right"), size_px)
    right_from_left = _read_pose(path, table, "right_from_left")
    body = read_body_poses(path, table)
    if body is not None and not poses_agree(body[1].inverse() @ body[0], right_from_left, BODY_TOLERANCE):
        raise InputError(path, "body_from_left and body_from_right do not agree with right_from_left")
    return RawCalibration(left, right, right_from_left, str(path))


def read_size_px(path: Path, table: dict[str, Any]) -> tuple[int, int] | None:
    """The size of the images that the calibration is for, if it says so."""
    if "size_px" not in table:
        return None
    width, height = _numbers(path, table, "size_px", {2})
    if not (width >= 1.0 and height >= 1.0 and width.is_integer() and height.is_integer()):
        raise InputError(path, "size_px must hold two whole numbers")
    return int(width), int(height)


def read_body_poses(path: Path, table: dict[str, Any]) -> tuple[Pose, Pose] | None:
    """body_from_left and body_from_right, if the file has them."""
    if not any(key in table for key in OF_BODY):
        return None
    left, right = (_read_pose(path, table, key) for key in OF_BODY)
    return left, right


def _read_pose(path: Path, table: dict[str, Any], key: str) -> Pose:
    motion = _table(path, table, key)
    rotation = np.array(_numbers(path, motion, "rotation", {9})).reshape(3, 3)
    if not is_rotation(rotation):
        raise InputError(path, "rotation is not a rotation matrix")
    return Pose(rotation, np.array(_numbers(path, motion, "translation_m", {3})))


def _read_camera(path: Path, table: dict[str, Any], size_px: tuple[int, int]) -> CameraModel:
    _refuse_unknown(path, table, {"fx_px", "fy_px", "cx", "cy", "distortion", "lens"})
    lens = table.get("lens", "pinhole")
    if lens not in get_args(Lens):
        raise InputError(path, f"lens must be {' or '.join(get_args(Lens))}, not {lens!r}")
    fx, fy = _positive(path, table, "fx_px"), _positive(path, table, "fy_px")
    matrix = camera_matrix(fx, fy, _number(path, table, "cx"), _number(path, table, "cy"))
    if "distortion" not in table:
        return CameraModel(*size_px, matrix, lens=lens)
    counts = {4} if lens == "fisheye" else {4, 5, 8}
    return CameraModel(*size_px, matrix, tuple(_numbers(path, table, "distortion", counts)), lens)


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
