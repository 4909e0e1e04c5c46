"""Camera pairs with lens distortion, and what they see of points."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from vista.geometry import CameraModel, Pose, RawCalibration, camera_matrix

WIDE_SIZE, RAW_SIZE = (640, 400), (320, 240)


def rig(k1: float, k2: float, tilt_deg: float) -> RawCalibration:
    """Two cameras of a wide lens, slightly different, turned against each other."""
    distortion = k1, k2, 2e-4, -3e-4
    turn = Rotation.from_euler("xyz", [tilt_deg, -0.8, 0.5], degrees=True).as_matrix()
    return RawCalibration(
        CameraModel(*WIDE_SIZE, camera_matrix(330.0, 331.0, 317.0, 203.0), distortion),
        CameraModel(*WIDE_SIZE, camera_matrix(332.0, 331.0, 323.0, 198.0), distortion),
        Pose(turn, turn @ np.array([-0.15, 0.001, 0.0])),
        "wide.toml",
    )


WIDE = rig(-0.28, 0.07, 0.4)

RAW = RawCalibration(
    CameraModel(*RAW_SIZE, camera_matrix(262.0, 263.0, 156.0, 123.0), (-0.36, 0.17, 0.001, -0.0005)),
    CameraModel(*RAW_SIZE, camera_matrix(264.0, 265.0, 160.0, 122.0), (-0.35, 0.16, 0.0, 0.0)),
    Pose(
        Rotation.from_euler("xyz", [0.6, -0.9, 0.4], degrees=True).as_matrix(), np.array([-0.2, 0.002, 0.003])
    ),
    "synthetic",
)


def draw_spheres(
    camera: CameraModel, camera_from_left: Pose, centres_m: NDArray[np.float64]
) -> NDArray[np.uint8]:
    """Small bright blobs where the camera, distortion included, sees the points."""
    rotation = cv2.Rodrigues(camera_from_left.rotation)[0]
    points, _ = cv2.projectPoints(
        centres_m, rotation, camera_from_left.translation_m, camera.matrix, np.array(camera.distortion)
    )
    v, u = np.mgrid[: camera.height, : camera.width]
    image = np.zeros((camera.height, camera.width))
    for x, y in points[:, 0]:
        image += 250.0 * np.exp(-((u - x) ** 2 + (v - y) ** 2) / (2.0 * 2.0**2))
    return np.clip(image, 0, 255).astype(np.uint8)


def blob_centre(image: NDArray[np.uint8], u: float, v: float) -> tuple[float, float]:
    """Centroid within 7 px of (u, v)."""
    u0, v0 = round(u), round(v)
    patch = image[v0 - 7 : v0 + 8, u0 - 7 : u0 + 8].astype(float)
    offset = np.arange(-7, 8)
    return u0 + (patch.sum(0) @ offset) / patch.sum(), v0 + (patch.sum(1) @ offset) / patch.sum()
