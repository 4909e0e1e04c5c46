"""The stereo rig: two identical, row-aligned pinhole cameras, and what their pixels see."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

LEFT, RIGHT = 0, 1

# Columns: the camera's axes (right, down, forward) in body axes (forward, left, up).
R_BODY_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True)
class Rig:
    width_px: int
    height_px: int
    focal_px: float
    baseline_m: float
    # What calibration leaves: how the right camera stands against what it is taken for. Its rows are off by
    # f * pitch in the middle, and by roll more for every pixel to the right; no yaw, which would be range.
    right_pitch_deg: float = 0.006
    right_roll_deg: float = 0.010

    @property
    def center_px(self) -> tuple[float, float]:
        """Principal point (u, v): the middle of the image; pixel (0, 0) has its centre at the origin."""
        return (self.width_px - 1) / 2, (self.height_px - 1) / 2

    def with_rows_off(self, rows_px: float) -> Rig:
        """The rig with the right camera's rows off by so many in the middle; more than 0: its picture lies
        lower."""
        return replace(self, right_pitch_deg=math.degrees(math.atan(rows_px / self.focal_px)))

    def body_from_camera(self, camera: int) -> np.ndarray:
        """T_BS, 4x4: camera coordinates to body coordinates."""
        transform = np.eye(4)
        transform[:3, :3] = R_BODY_CAMERA
        transform[1, 3] = self.baseline_m * (0.5 if camera == LEFT else -0.5)
        return transform

    def body_from_mounted_camera(self, camera: int) -> np.ndarray:
        """T_BS as it really is, residual misalignment included."""
        pitch, roll = (
            math.radians(angle if camera == RIGHT else 0.0)
            for angle in (self.right_pitch_deg, self.right_roll_deg)
        )
        turn = np.eye(4)
        turn[:3, :3] = cv2.Rodrigues(np.array([pitch, 0.0, roll]))[0]
        return self.body_from_camera(camera) @ turn

    def project(self, points_camera_m: np.ndarray) -> np.ndarray:
        """Camera coordinates (..., 3) to pixels (..., 2)."""
        u, v = self.center_px
        x, y, z = np.moveaxis(np.asarray(points_camera_m), -1, 0)
        return np.stack([u + self.focal_px * x / z, v + self.focal_px * y / z], axis=-1)


# 12 mm lens on 12 um pixels; f*B = 457.2 px*m, one disparity at 457.2 m and 32 at 14.3 m as in the paper.
PAPER_RIG = Rig(width_px=640, height_px=480, focal_px=1000.0, baseline_m=0.4572)


@dataclass(frozen=True)
class View:
    """What the middle of each pixel sees."""

    depth_m: np.ndarray  # (H, W) float32, along the optical axis; inf = sky
    label: np.ndarray  # (H, W) int32, k = the scene's k-th thing counted from 1; 0 = sky

    def world_points_m(self, rig: Rig, world_from_camera: np.ndarray) -> np.ndarray:
        """(H, W, 3); the sky's are not finite."""
        (cu, cv), f = rig.center_px, rig.focal_px
        v, u = np.mgrid[0 : rig.height_px, 0 : rig.width_px]
        rays = np.stack([(u - cu) / f, (v - cv) / f, np.ones(u.shape)], axis=-1)
        return rays @ world_from_camera[:3, :3].T * self.depth_m[..., None] + world_from_camera[:3, 3]
