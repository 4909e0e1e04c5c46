"""What the formats of calibration files share."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from vista.errors import InputError
from vista.geometry import Array, CameraModel, Lens, Pose, camera_matrix, is_rotation

Table = dict[str, Any]


@dataclass(frozen=True)
class File:
    path: Path
    table: Table


@dataclass(frozen=True)
class Options:
    """What some formats do not say."""

    unit_m: float = 1.0  # of lengths
    size_px: tuple[int, int] | None = None  # of the images
    lens: Lens | None = None


def make_camera(
    path: Path | str,
    size: tuple[int, int],
    K: tuple[float, float, float, float],
    distortion: list[float],
    lens: Lens,
) -> CameraModel:
    """K: fx, fy, cx, cy."""
    if K[0] <= 0.0 or K[1] <= 0.0:
        raise InputError(path, "focal lengths must be positive")
    return CameraModel(*size, camera_matrix(*K), _known_distortion(path, distortion, lens), lens)


def _known_distortion(path: Path | str, values: list[float], lens: Lens) -> tuple[float, ...]:
    """Drops zeros at the end that only fill the places of a longer model."""
    if lens == "fisheye":
        if len(values) != 4:
            raise InputError(path, f"a fisheye lens has 4 numbers of distortion, not {len(values)}")
        return tuple(values)
    kept = list(values)
    while len(kept) > 4 and kept[-1] == 0.0:
        kept.pop()
    for count in (4, 5, 8):
        if len(kept) <= count:
            return (*kept, *[0.0] * (count - len(kept)))
    raise InputError(path, f"distortion of {len(kept)} numbers; known are k1, k2, p1, p2[, k3[, k4, k5, k6]]")


def intrinsics_of(path: Path, matrix: list[float]) -> tuple[float, float, float, float]:
    """fx, fy, cx, cy of a 3x3 matrix without skew."""
    K = np.array(matrix).reshape(3, 3)
    fx, fy, cx, cy = (float(K[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2)))
    if not np.array_equal(K, camera_matrix(fx, fy, cx, cy)):
        raise InputError(path, "the camera matrix is not fx 0 cx, 0 fy cy, 0 0 1")
    return fx, fy, cx, cy


def intrinsics(camera: CameraModel) -> list[float]:
    """fx, fy, cx, cy."""
    K = camera.matrix
    return [float(K[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2))]


def make_pose(path: Path, key: str, rotation: Array, translation_m: Array) -> Pose:
    if not is_rotation(rotation):
        raise InputError(path, f"{key} does not hold a rotation")
    return Pose(np.asarray(rotation, np.float64), np.asarray(translation_m, np.float64).ravel())


def matrix_pose(path: Path, key: str, values: list[float]) -> Pose:
    """The pose that a 4x4 matrix states, row by row."""
    T = np.array(values).reshape(4, 4)
    return make_pose(path, key, T[:3, :3], T[:3, 3])


def pose_matrix(pose: Pose) -> Array:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = pose.rotation, pose.translation_m
    return T


def only_radial_tangential(camera: CameraModel, most: int, format_name: str) -> list[float]:
    """The distortion of a lens for a format that has so many numbers for it."""
    if len(camera.distortion) > most:
        reason = f"its distortion of a pinhole has {most} numbers, this one {len(camera.distortion)}"
        raise InputError(f"--to {format_name}", f"{reason}; calibrate with --lens pinhole")
    return list(camera.distortion)


def dump_yaml(table: Table) -> str:
    return str(yaml.safe_dump(table, sort_keys=False, default_flow_style=None, width=110))


def floats(values: Array) -> list[float]:
    return [float(value) for value in np.asarray(values).ravel()]
