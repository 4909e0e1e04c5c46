"""What OpenCV computes with a lens, whichever model the lens has."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from vista.geometry import Array, CameraModel, Pose


def rectifying_map(
    camera: CameraModel, R: Array, P: Array, size: tuple[int, int], kind: int
) -> tuple[Any, Any]:
    """The place of each pixel of the rectified image in the raw one: cv2.initUndistortRectifyMap of the lens.

    kind: cv2.CV_16SC2 or cv2.CV_32FC1."""
    make = cv2.fisheye.initUndistortRectifyMap if camera.lens == "fisheye" else cv2.initUndistortRectifyMap
    first, second = make(camera.matrix, np.array(camera.distortion), R, P, size, kind)
    return first, second


def rectified_points(camera: CameraModel, points_px: Array, R: Array, P: Array) -> Array:
    """(points, 2) of the raw image in the rectified one."""
    undistort = cv2.fisheye.undistortPoints if camera.lens == "fisheye" else cv2.undistortPoints
    points = np.ascontiguousarray(points_px[:, np.newaxis], np.float64)
    moved = undistort(points, camera.matrix, np.array(camera.distortion), R=R, P=P)
    return np.asarray(moved, np.float64).reshape(-1, 2)


def project(camera: CameraModel, camera_from_object: Pose, points_m: Array) -> Array:
    """(points, 2) px where the camera sees (points, 3)."""
    rvec, tvec = cv2.Rodrigues(camera_from_object.rotation)[0], camera_from_object.translation_m
    points = np.ascontiguousarray(points_m[np.newaxis], np.float64)
    distortion = np.array(camera.distortion)
    if camera.lens == "fisheye":
        seen, _ = cv2.fisheye.projectPoints(points, rvec, tvec, camera.matrix, distortion)
    else:
        seen, _ = cv2.projectPoints(points, rvec, tvec, camera.matrix, distortion)
    return np.asarray(seen, np.float64).reshape(-1, 2)
