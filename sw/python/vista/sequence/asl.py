"""EuRoC ASL layout: mav0/cam0, mav0/cam1 with sensor.yaml, data.csv and data/; poses in
mav0/state_groundtruth_estimate0/data.csv (optional).

The camera's pose is the body's pose, interpolated to the image time, times T_BS of cam0. Frames outside the
time of the poses are left out, and a note says how many. Images are paired by their times.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vista.errors import InputError
from vista.geometry import CameraModel, Lens, Pose, RawCalibration, camera_matrix, is_rotation
from vista.sequence.options import Options
from vista.sequence.pairing import pair_by_time
from vista.sequence.text import check_increasing, data_lines, finite_row, timestamp_ns
from vista.sequence.trajectory import Sample, Trajectory, make_sample, with_poses
from vista.sequence.types import FrameFiles, Sequence
from vista.sequence.yaml_file import image_size, numbers, read_table

NAME = "EuRoC ASL"
TAKES = frozenset({"pair_tolerance_ms"})
POSES = Path("state_groundtruth_estimate0/data.csv")
UP_WORLD = np.array([0.0, 0.0, 1.0])  # the data set's reference frame R is aligned with gravity
LENS_OF: dict[str, Lens] = {"radial-tangential": "pinhole", "radtan": "pinhole", "equidistant": "fisheye"}


def recognises(folder: Path) -> bool:
    return (folder / "mav0").is_dir() or (folder.name == "mav0" and (folder / "cam0").is_dir())


def open_source(folder: Path, options: Options) -> Sequence:
    root = folder / "mav0" if (folder / "mav0").is_dir() else folder
    left, body_from_left = read_sensor(root / "cam0" / "sensor.yaml")
    right, body_from_right = read_sensor(root / "cam1" / "sensor.yaml")
    left_images = _read_image_list(root / "cam0")
    right_images = _read_image_list(root / "cam1")
    left_ns, right_ns = list(left_images), list(right_images)
    pairs = pair_by_time(left_ns, right_ns, options.pair_tolerance_ms, root / "cam1" / "data.csv")
    frames = tuple(
        FrameFiles(at, left_ns[at], left_images[left_ns[at]], right_images[right_ns[partner]], None)
        for at, partner in pairs.indices
    )
    notes, up_world = pairs.notes, None
    if options.of_source and (root / POSES).exists():
        frames, left_out = with_poses(frames, read_trajectory(root / POSES), root / POSES, body_from_left)
        notes, up_world = notes + left_out, UP_WORLD
    right_from_left = body_from_right.inverse() @ body_from_left
    calibration = RawCalibration(left, right, right_from_left, str(root / "cam1" / "sensor.yaml"))
    return Sequence(root.resolve().parent.name, NAME, calibration, frames, up_world, notes)


def read_sensor(path: Path) -> tuple[CameraModel, Pose]:
    """Camera and body_from_camera (T_BS) of a sensor.yaml."""
    table = read_table(path)
    width, height = image_size(path, numbers(path, table, "resolution", {2}))
    model = table.get("camera_model", "pinhole")
    if model != "pinhole":
        raise InputError(path, f"camera_model {model} is not known, only pinhole")
    fx, fy, cx, cy = numbers(path, table, "intrinsics", {4})
    lens = LENS_OF.get(str(table.get("distortion_model")))
    if lens is None:
        raise InputError(path, "distortion_model is neither radial-tangential nor equidistant")
    counts = {4} if lens == "fisheye" else {4, 5}
    distortion = tuple(numbers(path, table, "distortion_coefficients", counts))
    if fx <= 0.0 or fy <= 0.0:
        raise InputError(path, "focal lengths must be positive")
    T_BS = np.array(numbers(path, table, "T_BS", {16})).reshape(4, 4)
    if not is_rotation(T_BS[:3, :3]):
        raise InputError(path, "T_BS does not hold a rotation")
    camera = CameraModel(width, height, camera_matrix(fx, fy, cx, cy), distortion, lens)
    return camera, Pose(T_BS[:3, :3], T_BS[:3, 3])


def _read_image_list(camera: Path) -> dict[int, Path]:
    """Image of each time in data.csv; every file is there."""
    images: dict[int, Path] = {}
    previous_ns = None
    for culprit, line in data_lines(camera / "data.csv"):
        time, comma, name = line.partition(",")
        if not comma or not name.strip():
            raise InputError(culprit, "expected: timestamp,filename")
        t_ns = timestamp_ns(culprit, time)
        check_increasing(culprit, previous_ns, t_ns)
        previous_ns = t_ns
        images[t_ns] = camera / "data" / name.strip()
        if not images[t_ns].is_file():
            raise InputError(images[t_ns], f"no such file, listed in {culprit}")
    if not images:
        raise InputError(camera / "data.csv", "lists no images")
    return images


def read_trajectory(path: Path) -> Trajectory:
    """Body poses: timestamp, position, quaternion (w, x, y, z); further columns are not read."""
    samples: list[Sample] = []
    for culprit, line in data_lines(path):
        fields = line.split(",")
        if len(fields) < 8:
            raise InputError(
                culprit, f"{len(fields)} columns, expected timestamp, position (3), quaternion (4)"
            )
        t_ns = timestamp_ns(culprit, fields[0])
        check_increasing(culprit, samples[-1].t_ns if samples else None, t_ns)
        values = np.array(finite_row(culprit, fields[1:8], 7))
        samples.append(make_sample(culprit, t_ns, values[:3], values[3:]))
    if not samples:
        raise InputError(path, "holds no poses")
    return Trajectory(samples)
