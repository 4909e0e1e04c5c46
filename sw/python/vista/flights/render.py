"""Scene and camera pose -> radiance, and the exact depth and label of every pixel, by Mitsuba 3.

Light comes from two directions, the sun and a weaker fill for the sky, rendered one after the other: nothing
is left to chance but where in the pixel a ray falls, so a few rays a pixel leave no speckle that the cameras
would not share. (Mitsuba picks one light at random per ray, and its `aov` integrator takes time in proportion
to the number of shapes: hence one scene a light, and labels as emitted radiance.)
"""

from __future__ import annotations

from functools import cached_property

import cv2
import mitsuba as mi
import numpy as np

from .motion import is_static, solids_at
from .rig import Rig
from .scene import Haze, Scene
from .shapes import Transform, glowing_surface, lit_surface, shapes_of
from .view import View

FILL_DIRECTION = (0.75, -0.35, -0.55)  # from behind the aircraft, so that no visible face is quite dark
SKY_RADIANCE_SCALE = 6.0  # Mitsuba's sky in units of ours
GREY_OF_RGB = np.array([0.30, 0.45, 0.25])  # a sensor without a colour filter
NEAR_CLIP_M = 0.1  # Mitsuba measures distances from the near plane
# Mitsuba's camera looks along +z with +x to the left and +y up.
CAMERA_FROM_MITSUBA = np.diag([-1.0, -1.0, 1.0, 1.0])


def unit(vector: tuple[float, float, float]) -> np.ndarray:
    return np.array(vector) / np.linalg.norm(vector)


def pixels(scene: mi.Scene, sensor: mi.Sensor, integrator: mi.Integrator, seed: int) -> np.ndarray:
    return np.array(mi.render(scene, sensor=sensor, integrator=integrator, seed=seed))


def through_haze(haze: Haze, surface: np.ndarray, cover: np.ndarray, distance_m: np.ndarray) -> np.ndarray:
    """Radiance of surfaces that cover a share of each pixel, and the haze before them.

    A pixel with the sky at its centre and a surface at its rim takes the distance from its neighbours.
    """
    nearest_m = cv2.erode(distance_m, np.ones((3, 3)))
    clear = np.exp(-haze.extinction_per_m * np.where(np.isinf(distance_m), nearest_m, distance_m))
    return surface * clear + haze.airlight * (1 - clear) * cover


class Renderer:
    """A scene, seen from any pose at any time. `rays` a pixel: a square number."""

    def __init__(self, scene: Scene, rig: Rig, rays: int = 4):
        self.scene = scene
        self.rig = rig
        self.rays = rays
        self.surfaces = {solid.name: lit_surface(solid) for solid in scene.solids}
        if len(self.surfaces) < len(scene.solids):
            raise ValueError("two solids of the scene have one name")
        # Light is sampled, surfaces are not: rays that leave a surface by chance would meet neither lamp.
        self.direct = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
        self.move_to(0.0)

    def move_to(self, t_s: float) -> None:
        """Things go where they are `t_s` after the last frame."""
        if hasattr(self, "lit") and is_static(self.scene):
            return
        self.solids = [
            (label, solid)
            for label, thing in enumerate(self.scene.things, start=1)
            for solid in solids_at(thing, t_s)
        ]
        lit = [part for _, solid in self.solids for part in shapes_of(solid, self.surfaces[solid.name])]
        self.lit = [
            self.load(lit, self.lamp(-unit(self.scene.to_sun), self.scene.sun_irradiance)),
            self.load(lit, self.lamp(unit(FILL_DIRECTION), self.scene.fill_irradiance)),
        ]
        self.__dict__.pop("glowing", None)

    @staticmethod
    def lamp(direction: np.ndarray, irradiance: float) -> dict:
        return {"lamp": {"type": "directional", "direction": list(direction), "irradiance": irradiance}}

    @staticmethod
    def load(shapes: list[mi.Shape], lamp: dict | None = None) -> mi.Scene:
        numbered = {f"shape{n}": shape for n, shape in enumerate(shapes)}
        return mi.load_dict({"type": "scene", **numbered, **(lamp or {})})

    @cached_property
    def glowing(self) -> tuple[mi.Scene, mi.Scene]:
        """Every solid emits its label, so that what a camera sees directly is the label. Light leaves one
        side of a surface only: the second scene emits inwards, for meshes and panels seen from behind."""
        outwards, inwards = (
            [part for label, s in self.solids for part in shapes_of(s, glowing_surface(label), backwards)]
            for backwards in (False, True)
        )
        return self.load(outwards), self.load(inwards)

    @cached_property
    def blue_sky(self) -> mi.Scene:
        to_sun = list(unit(self.scene.to_sun))
        sky = {"type": "sunsky", "sun_direction": to_sun, "sun_scale": 0.0, "turbidity": 4.0}
        return mi.load_dict({"type": "scene", "sky": sky})

    def sensor(self, world_from_camera: np.ndarray, rays: int) -> mi.Sensor:
        """One ray goes through the pixel's centre, more are spread over the pixel."""
        film = {
            "type": "hdrfilm",
            "width": self.rig.width_px,
            "height": self.rig.height_px,
            "rfilter": {"type": "box"},
            "pixel_format": "rgba",
            "component_format": "float32",
        }
        return mi.load_dict(
            {
                "type": "perspective",
                "fov": self.rig.horizontal_fov_deg,
                "fov_axis": "x",
                "near_clip": NEAR_CLIP_M,
                "far_clip": 10000.0,
                "to_world": Transform(world_from_camera @ CAMERA_FROM_MITSUBA),
                "film": film,
                "sampler": {"type": "stratified", "sample_count": rays, "jitter": rays > 1},
            }
        )

    def radiance(self, world_from_camera: np.ndarray, seed: int) -> np.ndarray:
        """(H, W) float32."""
        sensor = self.sensor(world_from_camera, self.rays)
        sun, fill = (pixels(lit, sensor, self.direct, seed) for lit in self.lit)
        surface, cover = sun[..., 0] + fill[..., 0], sun[..., 3]
        if self.scene.haze:
            surface = through_haze(self.scene.haze, surface, cover, self.distance_m(world_from_camera))
        return (surface + (1 - cover) * self.sky(world_from_camera)).astype(np.float32)

    def sky(self, world_from_camera: np.ndarray) -> np.ndarray | float:
        if self.scene.haze:  # of which there is more before the sky than anything shines through
            return self.scene.haze.airlight
        if self.scene.sky == "overcast":
            return self.scene.overcast_radiance
        sky = pixels(self.blue_sky, self.sensor(world_from_camera, 1), self.direct, seed=0)
        return sky[..., :3] @ GREY_OF_RGB * SKY_RADIANCE_SCALE

    def distance_m(self, world_from_camera: np.ndarray) -> np.ndarray:
        """(H, W) along the ray through each pixel's centre, inf = sky."""
        sensor = self.sensor(world_from_camera, 1)
        seen = pixels(self.lit[0], sensor, mi.load_dict({"type": "depth"}), seed=0)
        return np.where(seen[..., 3] > 0, seen[..., 0] + NEAR_CLIP_M / self.forward(), np.inf)

    def view(self, world_from_camera: np.ndarray) -> View:
        sensor, seen = self.sensor(world_from_camera, 1), mi.load_dict({"type": "path", "max_depth": 1})
        glow = sum(pixels(scene, sensor, seen, seed=0)[..., 0] for scene in self.glowing)
        depth = self.distance_m(world_from_camera) * self.forward()
        label = np.rint(glow).astype(np.int32)
        return View(np.where(label > 0, depth, np.inf).astype(np.float32), label)

    def forward(self) -> np.ndarray:
        """(H, W) cosine between each pixel's ray and the optical axis."""
        (cu, cv), f = self.rig.center_px, self.rig.focal_px
        v, u = np.mgrid[0 : self.rig.height_px, 0 : self.rig.width_px]
        return 1 / np.sqrt(1 + ((u - cu) / f) ** 2 + ((v - cv) / f) ** 2)
