"""EuRoC ASL layout: mav0/cam0, mav0/cam1 with sensor.yaml, data.csv and data/; poses in
mav0/state_groundtruth_estimate0/data.csv (optional).

The camera's pose is the body's pose, interpolated to the image time, times T_BS of cam0. Frames outside the
time of the poses are left out. A left and a right image belong together when each is the nearest in time to
the other, within a tolerance; images without a partner are left out. Notes say how many.
"""

from __future__ import annotations

from bisect import bisect_left
from pathlib import Path

import numpy as np

from vista.errors import InputError
from vista.geometry import CameraModel, Lens, Pose, RawCalibration, camera_matrix, is_rotation
from vista.sequence.text import check_increasing, data_lines, finite_row, timestamp_ns
from vista.sequence.trajectory import Sample, Trajectory, make_sample
from vista.sequence.types import FrameFiles, Sequence
from vista.sequence.yaml_file import numbers, read_table

POSES = Path("state_groundtruth_estimate0/data.csv")
UP_WORLD = np.array([0.0, 0.0, 1.0])  # the data set's reference frame R is aligned with gravity
PERIOD_SHARE = 0.1  # of the frame period: how far the times of a pair may lie apart, if not stated otherwise,
MAX_TOLERANCE_NS = 5_000_000  # and at most
LENS_OF: dict[str, Lens] = {"radial-tangential": "pinhole", "radtan": "pinhole", "equidistant": "fisheye"}


def recognises(folder: Path) -> bool:
    return (folder / "mav0").is_dir() or (folder.name == "mav0" and (folder / "cam0").is_dir())


def open_folder(folder: Path, pair_tolerance_ms: float | None = None) -> Sequence:
    """pair_tolerance_ms: how far the times of left and right image may lie apart; None: a tenth of the frame
    period, at most 5 ms."""
    root = folder / "mav0" if (folder / "mav0").is_dir() else folder
    left, body_from_left = read_sensor(root / "cam0" / "sensor.yaml")
    right, body_from_right = read_sensor(root / "cam1" / "sensor.yaml")
    left_images = _read_image_list(root / "cam0")
    right_images = _read_image_list(root / "cam1")
    tolerance_ns = _default_tolerance_ns(list(left_images))
    if pair_tolerance_ms is not None:
        tolerance_ns = round(1e6 * pair_tolerance_ms)
    pairs = pair_times(list(left_images), list(right_images), tolerance_ns)
    if not pairs:
        reason = f"no right image within {tolerance_ns / 1e6:g} ms of any left one"
        raise InputError(root / "cam1" / "data.csv", reason)
    notes = _pairing_notes(pairs, len(left_images), len(right_images), tolerance_ns)
    trajectory = read_trajectory(root / POSES) if (root / POSES).exists() else None

    frames = []
    for index, (t_ns, left_path) in enumerate(left_images.items()):
        if t_ns not in pairs:
            continue
        world_from_body = trajectory.at(t_ns) if trajectory else None
        if trajectory and world_from_body is None:
            continue
        world_from_camera = world_from_body @ body_from_left if world_from_body else None
        frames.append(FrameFiles(index, t_ns, left_path, right_images[pairs[t_ns]], world_from_camera))
    if not frames:
        raise InputError(root / POSES, f"covers the time of none of the {len(pairs)} frames")
    left_out = len(pairs) - len(frames)
    if left_out:
        notes.append(f"{left_out} of {len(pairs)} frames lie outside the time of {root / POSES}")
    right_from_left = body_from_right.inverse() @ body_from_left
    calibration = RawCalibration(left, right, right_from_left, str(root / "cam1" / "sensor.yaml"))
    name = root.resolve().parent.name
    up_world = UP_WORLD if trajectory else None
    return Sequence(name, "EuRoC ASL", calibration, tuple(frames), up_world, tuple(notes))


def pair_times(left_ns: list[int], right_ns: list[int], tolerance_ns: int) -> dict[int, int]:
    """Right time of each left one, where each is the other's nearest and they are within the tolerance. Both
    lists increase."""
    pairs = {}
    for t_ns in left_ns:
        partner_ns = _nearest(right_ns, t_ns)
        if abs(partner_ns - t_ns) <= tolerance_ns and _nearest(left_ns, partner_ns) == t_ns:
            pairs[t_ns] = partner_ns
    return pairs


def _nearest(times_ns: list[int], t_ns: int) -> int:
    after = bisect_left(times_ns, t_ns)
    return min(times_ns[max(after - 1, 0) : after + 1], key=lambda other_ns: abs(other_ns - t_ns))


def _default_tolerance_ns(times_ns: list[int]) -> int:
    if len(times_ns) < 2:
        return MAX_TOLERANCE_NS
    return min(round(PERIOD_SHARE * float(np.median(np.diff(times_ns)))), MAX_TOLERANCE_NS)


def _pairing_notes(pairs: dict[int, int], left: int, right: int, tolerance_ns: int) -> list[str]:
    notes = []
    apart_ns = [abs(right_ns - left_ns) for left_ns, right_ns in pairs.items() if right_ns != left_ns]
    if apart_ns:
        furthest = f"they differ by up to {max(apart_ns) / 1e6:g} ms"
        notes.append(f"{len(apart_ns)} of {len(pairs)} pairs have images of two times; {furthest}")
    alone = left + right - 2 * len(pairs)
    if alone:
        within = f"within {tolerance_ns / 1e6:g} ms"
        notes.append(f"{alone} of {left + right} images have no partner {within} and are left out")
    return notes


def read_sensor(path: Path) -> tuple[CameraModel, Pose]:
    """Camera and body_from_camera (T_BS) of a sensor.yaml."""
    table = read_table(path)
    width, height = (int(value) for value in numbers(path, table, "resolution", {2}))
    fx, fy, cx, cy = numbers(path, table, "intrinsics", {4})
    lens = LENS_OF.get(str(table.get("distortion_model")))
    if lens is None:
        raise InputError(path, "distortion_model is neither radial-tangential nor equidistant")
    counts = {4} if lens == "fisheye" else {4, 5}
    distortion = tuple(numbers(path, table, "distortion_coefficients", counts))
    if width < 1 or height < 1 or fx <= 0.0 or fy <= 0.0:
        raise InputError(path, "resolution and focal lengths must be positive")
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
