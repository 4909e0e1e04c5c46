"""KITTI odometry layout: the folder sequences/NN with image_0, image_1, calib.txt and times.txt; poses in
../../poses/NN.txt (optional): left-camera poses, 3x4 row-major."""

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


def recognises(folder: Path) -> bool:
    return (folder / "image_0").is_dir()


def open_source(folder: Path, options: Options) -> Sequence:
    left_images = sorted(p for p in (folder / "image_0").iterdir() if p.suffix.lower() in EXTENSIONS)
    if not left_images:
        raise InputError(folder / "image_0", "holds no images")
    right_images = [folder / "image_1" / path.name for path in left_images]
    for path in right_images:
        if not path.is_file():
            raise InputError(path, "no such file: the right image is missing")

    times_ns = read_times(folder / "times.txt")
    _check_count(folder / "times.txt", "times", len(times_ns), len(left_images))
    number = folder.resolve().name
    poses_path = folder / ".." / ".." / "poses" / f"{number}.txt"
    poses: list[Pose] | list[None] = [None] * len(left_images)
    if options.of_source and poses_path.exists():
        poses = read_poses(poses_path)
        _check_count(poses_path, "poses", len(poses), len(left_images))

    frames = (
        FrameFiles(index, *of_frame)
        for index, of_frame in enumerate(zip(times_ns, left_images, right_images, poses, strict=True))
    )
    calibration = read_calibration(folder / "calib.txt", read_size(left_images[0]))
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
    projections: dict[str, Array] = {}
    for culprit, line in data_lines(path):
        key, _, numbers = line.partition(":")
        if key in keys:
            projections[key] = np.array(finite_row(culprit, numbers.split(), 12)).reshape(3, 4)
            _check_intrinsics(culprit, projections[key])
    for key in keys:
        if key not in projections:
            raise InputError(path, f"{key} is missing")
    P0, P1 = (projections[key] for key in keys)
    K0, K1 = P0[:, :3], P1[:, :3]
    translation_m = np.linalg.solve(K1, P1[:, 3]) - np.linalg.solve(K0, P0[:, 3])
    if translation_m[0] >= 0.0:
        raise InputError(
            path, f"baseline is {-translation_m[0] + 0.0:g} m, must be positive ({keys[1]} against {keys[0]})"
        )
    return RawCalibration(
        CameraModel(*size, K0), CameraModel(*size, K1), Pose(np.eye(3), translation_m), str(path)
    )


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
