"""The calibration of a pair from two sensor_msgs/CameraInfo.

K and D are those of the raw camera, R turns its frame of reference into the rectified one, and P is the
projection of the rectified one: P[0, 3] = -fx * (distance of this camera from the left one).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from vista.errors import InputError
from vista.geometry import Array, CameraModel, Pose, RawCalibration, is_rotation

MODELS = ("plumb_bob", "rational_polynomial", "")  # an empty one goes with no distortion
PLUMB_BOB = 5  # coefficients


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
        cameras.append(CameraModel(*size, K, (0.0,) * 4 if done else _distortion(info, name)))
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


def _distortion(info: Any, culprit: str) -> tuple[float, ...]:
    values = np.asarray(_field(info, "d"), np.float64)
    if not np.all(np.isfinite(values)):
        raise InputError(culprit, "D holds a number that is not finite")
    if not np.any(values):
        return (0.0,) * 4
    if info.distortion_model not in MODELS or len(values) < 4 or np.any(values[PLUMB_BOB:]):
        raise InputError(culprit, f"distortion {info.distortion_model!r} is not read; plumb_bob is")
    return tuple(float(value) for value in values[:PLUMB_BOB])
