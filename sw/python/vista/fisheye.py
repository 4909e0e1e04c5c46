"""Chooses the rectified cameras of a pair with fisheye lenses.

cv2.fisheye.stereoRectify shrinks the image until its corners fit, which costs the resolution ahead. Here the
rectified image keeps the resolution that the lens has on its axis, and what lies farther out is cut off; it
is magnified further only as far as pixels from outside the raw images would come in.
"""

from __future__ import annotations

import cv2
import numpy as np

from vista.errors import InputError
from vista.geometry import Array, CameraModel, RawCalibration, camera_matrix
from vista.lens import rectified_points, rectifying_map

MAX_MAGNIFICATION = 4.0
MAGNIFICATION_STEP = 1.02
MAX_ANGLE_COS = 0.2  # of the axis of a raw camera to that of the rectified ones


def rectified_fisheyes(raw: RawCalibration) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Rotation and 3x4 projection of the rectified left camera, and of the right one."""
    cameras = (raw.left, raw.right)
    rotations = _rotations(raw)
    magnification = 1.0
    while magnification <= MAX_MAGNIFICATION:
        focal_px = magnification * max(float(camera.matrix[0, 0]) for camera in cameras)
        K = _matrix(focal_px, cameras, rotations, raw.source)
        if all(_lies_inside(camera, R, K) for camera, R in zip(cameras, rotations, strict=True)):
            break
        magnification *= MAGNIFICATION_STEP
    else:
        raise InputError(raw.source, "cannot be rectified: the two images hardly overlap")
    baseline_m = float(np.linalg.norm(raw.right_from_left.translation_m))
    P_left, P_right = np.zeros((3, 4)), np.zeros((3, 4))
    P_left[:, :3] = P_right[:, :3] = K
    P_right[0, 3] = -focal_px * baseline_m
    return (rotations[0], P_left), (rotations[1], P_right)


def _rotations(raw: RawCalibration) -> tuple[Array, Array]:
    """They follow from the motion between the cameras alone, so that OpenCV's for ideal lenses serve."""
    motion = raw.right_from_left
    ideal = camera_matrix(100.0, 100.0, 50.0, 50.0)
    none = np.zeros(4)
    t = motion.translation_m.reshape(3, 1)
    R_left, R_right = cv2.stereoRectify(ideal, none, ideal, none, (100, 100), motion.rotation, t)[:2]
    return np.asarray(R_left, np.float64), np.asarray(R_right, np.float64)


def _matrix(
    focal_px: float, cameras: tuple[CameraModel, CameraModel], rotations: tuple[Array, Array], source: str
) -> Array:
    """The middle of the rectified images shows what the middles of the raw ones show, on average."""
    axes = []
    for camera, R in zip(cameras, rotations, strict=True):
        center = np.array([[(camera.width - 1) / 2.0, (camera.height - 1) / 2.0]])
        ray = rectified_points(camera, center, np.eye(3), np.eye(3)).ravel()
        x, y, z = R @ np.append(ray, 1.0)
        if not z > MAX_ANGLE_COS:
            raise InputError(source, "cannot be rectified: the cameras look along their baseline")
        axes.append((x / z, y / z))
    x, y = np.mean(axes, axis=0)
    width, height = cameras[0].width, cameras[0].height
    return camera_matrix(
        focal_px, focal_px, (width - 1) / 2.0 - focal_px * x, (height - 1) / 2.0 - focal_px * y
    )


def _lies_inside(camera: CameraModel, R: Array, K: Array) -> bool:
    """No pixel of the rectified image comes from outside the raw one."""
    u, v = rectifying_map(camera, R, K, (camera.width, camera.height), cv2.CV_32FC1)
    return bool(
        u.min() >= -0.5
        and v.min() >= -0.5
        and u.max() <= camera.width - 0.5
        and v.max() <= camera.height - 0.5
    )
