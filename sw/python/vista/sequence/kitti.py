"""KITTI odometry layout: the folder sequences/NN with image_0, image_1 (grey) or else image_2, image_3
(colour), calib.txt and times.txt; poses of the camera of image_0 in ../../poses/NN.txt (optional), 3x4
row-major."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vista.errors import InputError
from vista.geometry import Array, CameraModel, Pose, RawCalibration, is_rotation
from vista.sequence.image import EXTENSIONS, read_size
from vista.sequence.options import Options
from vista.sequence.text import check_increasing, data_lines, finite_row, seconds_ns
from vista.sequence.types import FrameFiles, Sequence

NAME = "KITTI odometry"
TAKES: frozenset[str] = frozenset()
# Folders of the left and the right images, and their projections in calib.txt.
CAMERAS = (("image_0", "image_1", "P0", "P1"), ("image_2", "image_3", "P2", "P3"))


def recognises(folder: Path) -> bool:
    in_colour = (folder / "image_2").is_dir() and (folder / "calib.txt").is_file()
    return in_colour or (folder / "image_0").is_dir()


def open_source(folder: Path, options: Options) -> Sequence:
    left, right, *keys = next(camera for camera in CAMERAS if (folder / camera[0]).is_dir())
    left_images = sorted(p for p in (folder / left).iterdir() if p.suffix.lower() in EXTENSIONS)
    if not left_images:
        raise InputError(folder / left, "holds no images")
    right_images = [folder / right / path.name for path in left_images]
    for path in right_images:
        if not path.is_file():
            raise InputError(path, "no such file: the right image is missing")

    times_ns = read_times(folder / "times.txt")
    _check_count(folder / "times.txt", "times", len(times_ns), len(left_images))
    number = folder.resolve().name
    poses_path = folder / ".." / ".." / "poses" / f"{number}.txt"
    poses: list[Pose] | list[None] = [None] * len(left_images)
    if options.of_source and poses_path.exists():
        grey_from_left = _grey_from_left(folder / "calib.txt", keys[0])
        poses = [pose @ grey_from_left for pose in read_poses(poses_path)]
        _check_count(poses_path, "poses", len(poses), len(left_images))

    frames = (
        FrameFiles(index, *of_frame)
        for index, of_frame in enumerate(zip(times_ns, left_images, right_images, poses, strict=True))
    )
    calibration = read_calibration(folder / "calib.txt", read_size(left_images[0]), (keys[0], keys[1]))
    name = f"{folder.resolve().parent.parent.name}/{number}"
    return Sequence(name, NAME, calibration, tuple(frames))


def _check_count(path: Path, what: str, count: int, frames: int) -> None:
    if count != frames:
        raise InputError(path, f"{count} {what} for {frames} frames")


def read_calibration(
    path: Path, size: tuple[int, int], keys: tuple[str, str] = ("P0", "P1")
) -> RawCalibration:
    """P0 and P1 map the left camera's frame to pixels: P1 = K1 [I | t], t = (-baseline_m, 0, 0). keys: their
    names in the file."""
    P0, P1 = _projections(path, keys)
    K0, K1 = P0[:, :3], P1[:, :3]
    translation_m = _place_m(P1) - _place_m(P0)
    if translation_m[0] >= 0.0:
        raise InputError(
            path, f"baseline is {-translation_m[0] + 0.0:g} m, must be positive ({keys[1]} against {keys[0]})"
        )
    return RawCalibration(
        CameraModel(*size, K0), CameraModel(*size, K1), Pose(np.eye(3), translation_m), str(path)
    )


def _projections(path: Path, keys: tuple[str, ...]) -> list[Array]:
    found: dict[str, Array] = {}
    for culprit, line in data_lines(path):
        key, _, numbers = line.partition(":")
        if key in keys:
            found[key] = np.array(finite_row(culprit, numbers.split(), 12)).reshape(3, 4)
            _check_intrinsics(culprit, found[key])
    for key in keys:
        if key not in found:
            raise InputError(path, f"{key} is missing")
    return [found[key] for key in keys]


def _place_m(P: Array) -> Array:
    """t of P = K [I | t]: from the camera of image_0, to which the poses belong, to this one."""
    return np.asarray(np.linalg.solve(P[:, :3], P[:, 3]))


def _grey_from_left(path: Path, key: str) -> Pose:
    return Pose(np.eye(3), -_place_m(_projections(path, (key,))[0]))


def _check_intrinsics(culprit: str, P: Array) -> None:
    fx, fy = P[0, 0], P[1, 1]
    if fx <= 0.0 or fy <= 0.0 or P[0, 1] != 0.0 or not np.array_equal(P[1:, 0], [0.0, 0.0]) or P[2, 2] != 1.0:
        raise InputError(
            culprit, "no projection matrix of a camera with positive focal lengths and without skew"
        )


def read_times(path: Path) -> list[int]:
    times_ns: list[int] = []
    for culprit, line in data_lines(path):
        t_ns = seconds_ns(culprit, line)
        check_increasing(culprit, times_ns[-1] if times_ns else None, t_ns)
        times_ns.append(t_ns)
    return times_ns


def read_poses(path: Path) -> list[Pose]:
    poses = []
    for culprit, line in data_lines(path):
        matrix = np.array(finite_row(culprit, line.split(), 12)).reshape(3, 4)
        if not is_rotation(matrix[:, :3]):
            raise InputError(culprit, "does not hold a rotation")
        poses.append(Pose(matrix[:, :3], matrix[:, 3]))
    return poses
