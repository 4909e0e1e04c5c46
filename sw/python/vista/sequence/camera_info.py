"""The calibration of a pair from two sensor_msgs/CameraInfo.

K and D are those of the raw camera, R turns its frame of reference into the rectified one, and P is the
projection of the rectified one: P[0, 3] = -fx * (distance of this camera from the left one).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from vista.errors import InputError
from vista.geometry import Array, CameraModel, Lens, Pose, RawCalibration, is_rotation

LENS_OF: dict[str, Lens] = {
    "plumb_bob": "pinhole",
    "rational_polynomial": "pinhole",
    "equidistant": "fisheye",
    "fisheye": "fisheye",
}
COUNTS: dict[Lens, tuple[int, ...]] = {"pinhole": (4, 5, 8), "fisheye": (4,)}  # of coefficients


def pair_from_camera_info(
    left: Any, right: Any, names: tuple[str, str], rectified: tuple[bool, bool]
) -> RawCalibration:
    """names: of both, for messages; rectified: the images are, so that K, D and R no longer count."""
    cameras, rotations, offsets = [], [], []
    for info, name, done in zip((left, right), names, rectified, strict=True):
        size = _size(info, name)
        P = _matrix(info, "p", (3, 4), name)
        R = np.eye(3) if done else _matrix(info, "r", (3, 3), name)
        if not is_rotation(R):
            raise InputError(name, "R is not a rotation matrix")
        K = P[:, :3] if done else _matrix(info, "k", (3, 3), name)
        if not (K[0, 0] > 0.0 and K[1, 1] > 0.0 and P[0, 0] > 0.0 and P[1, 1] > 0.0):
            raise InputError(name, "the camera is not calibrated: no positive focal lengths in K and P")
        cameras.append(CameraModel(*size, K) if done else _camera(info, size, K, name))
        rotations.append(R)
        offsets.append(np.array([P[0, 3] / P[0, 0], P[1, 3] / P[1, 1], 0.0]))
    rotation = rotations[1].T @ rotations[0]
    translation_m = rotations[1].T @ (offsets[1] - offsets[0])
    return RawCalibration(cameras[0], cameras[1], Pose(rotation, translation_m), names[1])


def _field(info: Any, name: str) -> Any:
    return getattr(info, name, None) if hasattr(info, name) else getattr(info, name.upper())  # ROS 2, ROS 1


def _matrix(info: Any, name: str, shape: tuple[int, int], culprit: str) -> Array:
    values = np.asarray(_field(info, name), np.float64)
    if values.size != shape[0] * shape[1] or not np.all(np.isfinite(values)):
        raise InputError(culprit, f"{name.upper()} does not hold {shape[0]}x{shape[1]} finite numbers")
    return values.reshape(shape)


def _size(info: Any, culprit: str) -> tuple[int, int]:
    roi = info.roi
    full = (roi.x_offset, roi.y_offset) == (0, 0) and (roi.width, roi.height) in (
        (0, 0),
        (info.width, info.height),
    )
    if max(info.binning_x, info.binning_y) > 1 or not full:
        raise InputError(culprit, "binning or a region of interest; only whole images are read")
    return int(info.width), int(info.height)


def _camera(info: Any, size: tuple[int, int], K: Array, culprit: str) -> CameraModel:
    """The camera as it is, before rectification."""
    values = np.asarray(_field(info, "d"), np.float64)
    if not np.all(np.isfinite(values)):
        raise InputError(culprit, "D holds a number that is not finite")
    if len(values) == 0 or (info.distortion_model == "" and not np.any(values)):  # no lens is stated
        return CameraModel(*size, K)
    lens = LENS_OF.get(info.distortion_model)
    if lens is None:
        raise InputError(culprit, f"distortion {info.distortion_model!r} is not one of {', '.join(LENS_OF)}")
    counts = COUNTS[lens]
    count = next((count for count in counts if not np.any(values[count:])), counts[-1])
    known = " or ".join(map(str, counts))
    if len(values) < count or np.any(values[count:]):
        raise InputError(
            culprit,
            f"D holds {len(values)} numbers; {info.distortion_model} has {known}",
        )
    return CameraModel(*size, K, tuple(float(value) for value in values[:count]), lens)
