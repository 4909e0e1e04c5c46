"""Cameras and poses, each with its frames of reference in its name.

- camera: x to the right, y down, z forward, in metres
- px: u to the right, v down, the origin in the centre of the top left pixel
- world: the inertial frame of the pose source, in metres
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Lens = Literal["pinhole", "fisheye"]


@dataclass(frozen=True)
class Pose:
    """Rigid motion p_a = rotation @ p_b + translation_m; variables are named `a_from_b`."""

    rotation: Array = field(default_factory=lambda: np.eye(3))  # 3x3
    translation_m: Array = field(default_factory=lambda: np.zeros(3))

    def __matmul__(self, other: Pose) -> Pose:
        """a_from_b @ b_from_c = a_from_c."""
        return Pose(self.rotation @ other.rotation, self.rotation @ other.translation_m + self.translation_m)

    def apply(self, point_m: Array) -> Array:
        """The point of b in a."""
        return self.rotation @ point_m + self.translation_m

    def inverse(self) -> Pose:
        return Pose(self.rotation.T, -self.rotation.T @ self.translation_m)


@dataclass(frozen=True)
class Calibration:
    """Rectified pinhole pair: equal cameras, the right one baseline_m along +x of the left one."""

    width: int
    height: int
    focal_px: float
    cx: float
    cy: float
    baseline_m: float


@dataclass(frozen=True)
class CameraModel:
    """One camera as calibrated.

    lens: pinhole has radial-tangential distortion (OpenCV's k1, k2, p1, p2[, k3]); fisheye is the equidistant
    lens of cv2.fisheye, which Kalibr and ROS know too: theta (1 + k1 theta^2 + ... + k4 theta^8).
    """

    width: int
    height: int
    matrix: Array  # 3x3, px
    distortion: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    lens: Lens = "pinhole"


@dataclass(frozen=True)
class RawCalibration:
    """A pair before rectification."""

    left: CameraModel
    right: CameraModel
    right_from_left: Pose
    source: str  # the file it was read from, for messages


def camera_matrix(fx: float, fy: float, cx: float, cy: float) -> Array:
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def rectified_rig(camera: Calibration, source: str) -> RawCalibration:
    """The calibration of a pair whose images come rectified."""
    matrix = camera_matrix(camera.focal_px, camera.focal_px, camera.cx, camera.cy)
    one = CameraModel(camera.width, camera.height, matrix)
    return RawCalibration(one, one, Pose(np.eye(3), np.array([-camera.baseline_m, 0.0, 0.0])), source)


def rotation_from_quaternion(quaternion: Array) -> Array:
    """3x3 rotation of the unit quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_from_rotation(rotation: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a 3x3 rotation, found from the largest of its components."""
    r = rotation
    if np.trace(r) > 0:
        w = np.sqrt(1 + np.trace(r)) / 2
        return np.array([w, *(np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / (4 * w))])
    i = int(np.argmax(np.diag(r)))
    j, k = (i + 1) % 3, (i + 2) % 3
    largest = np.sqrt(1 + r[i, i] - r[j, j] - r[k, k]) / 2
    found = np.zeros(4)
    found[1 + i] = largest
    found[[0, 1 + j, 1 + k]] = np.array([r[k, j] - r[j, k], r[j, i] + r[i, j], r[k, i] + r[i, k]]) / (
        4 * largest
    )
    return found


def slerp(first: Array, second: Array, fraction: float) -> Array:
    """Unit quaternion at `fraction` of the shorter way from first to second (Shoemake 1985)."""
    cosine = float(first @ second)
    if cosine < 0.0:  # q and -q are the same rotation
        second, cosine = -second, -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-6:  # sin(angle) / angle is 1 to the last digit
        blended = (1.0 - fraction) * first + fraction * second
    else:
        blended = (np.sin((1.0 - fraction) * angle) * first + np.sin(fraction * angle) * second) / np.sin(
            angle
        )
    return blended / np.linalg.norm(blended)


def poses_agree(one: Pose, other: Pose, tolerance: float) -> bool:
    """tolerance: of every number of the rotation, and of the translation in metres."""
    turned = np.abs(one.rotation - other.rotation).max()
    moved = np.abs(one.translation_m - other.translation_m).max()
    return bool(max(turned, moved) <= tolerance)


def is_rotation(matrix: Array, tolerance: float = 1e-3) -> bool:
    """Orthonormal and right-handed; the tolerance admits files that print four digits."""
    return bool(np.allclose(matrix @ matrix.T, np.eye(3), atol=tolerance) and np.linalg.det(matrix) > 0.0)


# ---- worlds and cameras of others ----

FORWARD_LEFT_UP = np.array(
    [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
)  # from x right, y down, z ahead


def level_world(up_world: Array | None, first: Pose) -> Array:
    """The rotation into a world whose z is up: the least one where up is known, else the first camera is
    level and looks along x."""
    if up_world is None:
        return FORWARD_LEFT_UP @ first.rotation.T
    axis, cosine = np.cross(up_world, (0.0, 0.0, 1.0)), float(up_world[2])
    if np.linalg.norm(axis) < 1e-9:
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    K = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.asarray(np.eye(3) + K + K @ K / (1.0 + cosine))


def turned(covariance_m2: Array, camera_from_world: Pose) -> Array:
    """A covariance of the world in the frame of the camera."""
    rotation = camera_from_world.rotation
    return rotation @ covariance_m2 @ rotation.T
