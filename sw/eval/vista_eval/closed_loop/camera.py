"""The cameras of a flight: a stereo pair from any pose, with the truth of it."""

from __future__ import annotations

import math

import numpy as np
from vista.geometry import Calibration

from vista_eval.render.optics import Exposure, FlawedSensor, through_lens
from vista_eval.render.renderer import OFF_CENTER_PX, Renderer
from vista_eval.render.rig import LEFT, PAPER_RIG, RIGHT, Rig
from vista_eval.render.scene import Scene
from vista_eval.render.sensor import Sensor, expose

BASELINE_M = PAPER_RIG.baseline_m
FLOWN_RAYS = OFF_CENTER_PX[::2]  # two more rays where the surface changes in place of four


def rig_of(width_px: int, view_deg: float) -> Rig:
    """A rig of images with sides of 4 to 3 and this field of view from side to side."""
    focal_px = width_px / 2 / math.tan(math.radians(view_deg) / 2)
    return Rig(width_px, width_px * 3 // 4, focal_px, BASELINE_M)


class StereoCamera:
    def __init__(self, scene: Scene, rig: Rig, sensor: Sensor, seed: int) -> None:
        self.rig, self.sensor, self.seed = rig, sensor, seed
        self._renderer = Renderer(scene, rig, FLOWN_RAYS)

    def expose(self, world_from_body: np.ndarray, t_s: float, index: int) -> tuple[np.ndarray, np.ndarray]:
        """The raw images, left and right. t_s: since the scene stood as it is described."""
        self._renderer.move_to(t_s)
        pair = []
        for camera in (LEFT, RIGHT):
            pose = world_from_body @ self.rig.body_from_mounted_camera(camera)
            radiance = self._renderer.radiance(pose) * self._renderer.scene.exposure
            if isinstance(self.sensor, FlawedSensor):
                radiance = through_lens(self.sensor, radiance, self.seen_from(pose, camera))
            pair.append(expose(self.sensor, radiance, camera, (self.seed, index, camera)))
        return pair[LEFT], pair[RIGHT]

    def seen_from(self, pose: np.ndarray, camera: int) -> Exposure:
        """The camera at rest: what smears is not simulated."""
        depth_m = self._renderer.view(pose).depth_m
        to_sun = self._renderer.scene.to_sun
        return Exposure(self.rig, camera, pose, pose, pose, depth_m, to_sun, self.seed)

    def disparity_px(self, world_from_body: np.ndarray) -> np.ndarray:
        """(H, W) true disparities of what was exposed last; 0 where the sky is."""
        depth_m = self._renderer.view(world_from_body @ self.rig.body_from_camera(LEFT)).depth_m
        with np.errstate(divide="ignore"):
            found = np.where(np.isinf(depth_m), 0.0, self.rig.focal_px * self.rig.baseline_m / depth_m)
        return np.asarray(found, np.float32)


def calibration_of(rig: Rig) -> Calibration:
    (cx, cy) = rig.center_px
    return Calibration(rig.width_px, rig.height_px, rig.focal_px, cx, cy, rig.baseline_m)
