"""What the centre of each pixel sees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vista_eval.render.rig import Rig


@dataclass(frozen=True)
class View:
    depth_m: np.ndarray  # (H, W) float32, along the optical axis; inf = sky
    label: np.ndarray  # (H, W) int32, k = the scene's k-th thing counted from 1; 0 = sky

    def world_points_m(self, rig: Rig, world_from_camera: np.ndarray) -> np.ndarray:
        """(H, W, 3); the sky's are not finite."""
        (cu, cv), f = rig.center_px, rig.focal_px
        v, u = np.mgrid[0 : rig.height_px, 0 : rig.width_px]
        rays = np.stack([(u - cu) / f, (v - cv) / f, np.ones(u.shape)], axis=-1)
        return rays @ world_from_camera[:3, :3].T * self.depth_m[..., None] + world_from_camera[:3, 3]
