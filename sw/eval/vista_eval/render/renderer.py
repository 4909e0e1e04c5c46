"""Renders radiance, exact depth and labels of a scene from a camera pose with Mitsuba 3.

Light comes from three directions, the sun and two weaker ones for the sky, rendered one after the other:
nothing is left to chance but where in the pixel a ray falls, so a few rays a pixel leave no speckle that the
cameras would not share. (Mitsuba picks one light at random per ray, and its `aov` integrator takes time in
proportion to the number of shapes: hence one scene a light, and labels as emitted radiance.)
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, reduce
from typing import NamedTuple

import cv2
import mitsuba as mi
import numpy as np

from vista_eval.render.motion import is_static, moves, solids_at
from vista_eval.render.rig import Rig
from vista_eval.render.scene import Haze, Scene, Solid
from vista_eval.render.shapes import Surface, Transform, glowing_surface, lit_surface, shapes_of
from vista_eval.render.view import View

# From behind the aircraft and above, half of the fill each, so that no visible face is quite dark.
FILL_DIRECTIONS = ((0.75, -0.55, -0.45), (0.65, 0.60, -0.50))
SKY_RADIANCE_SCALE = 6.0  # Mitsuba's sky in units of ours
GREY_OF_RGB = np.array([0.30, 0.45, 0.25])  # a sensor without a colour filter
SKY_REDUCTION = 8  # the sky is smooth
NEAR_CLIP_M = 0.1  # Mitsuba measures distances from the near plane
# Mitsuba's camera looks along +z with +x to the left and +y up.
CAMERA_FROM_MITSUBA = np.diag([-1.0, -1.0, 1.0, 1.0])


def unit(vector: tuple[float, float, float]) -> np.ndarray:
    return np.array(vector) / np.linalg.norm(vector)


def pixels(scene: mi.Scene, sensor: mi.Sensor, integrator: mi.Integrator, seed: int) -> np.ndarray:
    return np.array(mi.render(scene, sensor=sensor, integrator=integrator, seed=mi.UInt32(seed)))


def through_haze(haze: Haze, surface: np.ndarray, cover: np.ndarray, distance_m: np.ndarray) -> np.ndarray:
    """Radiance of surfaces that cover a share of each pixel, and the haze before them.

    A pixel with the sky at its centre and a surface at its rim takes the distance from its neighbours.
    """
    nearest_m = cv2.erode(distance_m, np.ones((3, 3)))
    clear = np.exp(-haze.extinction_per_m * np.where(np.isinf(distance_m), nearest_m, distance_m))
    return surface * clear + haze.airlight * (1 - clear) * cover


def lamps(scene: Scene, rays: int) -> list[tuple[dict, int]]:
    """Directional lights, strongest first, with their rays a pixel: one if less than half the strongest."""
    fill = [(scene.fill_irradiance / 2, unit(direction)) for direction in FILL_DIRECTIONS]
    lights = sorted([(scene.sun_irradiance, -unit(scene.to_sun)), *fill], key=lambda light: -light[0])
    strongest = lights[0][0]
    return [
        (
            {"type": "directional", "direction": list(direction), "irradiance": irradiance},
            rays if irradiance >= strongest / 2 else 1,
        )
        for irradiance, direction in lights
    ]


class Part(NamedTuple):
    label: int
    solid: Solid
    moves: bool


class Renderer:
    """A scene, seen from any pose at any time. `rays` a pixel: a square number."""

    def __init__(self, scene: Scene, rig: Rig, rays: int = 4):
        self.scene = scene
        self.rig = rig
        self.rays = rays
        self.standing: dict[tuple[str, str], list[mi.Shape]] = {}
        self.surfaces = {solid.name: lit_surface(solid) for solid in scene.solids}
        if len(self.surfaces) < len(scene.solids):
            raise ValueError("two solids of the scene have one name")
        # Light is sampled, surfaces are not: rays that leave a surface by chance would meet neither lamp.
        self.direct = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
        self.move_to(0.0)

    def move_to(self, t_s: float) -> None:
        """Things go where they are `t_s` after the last frame."""
        if is_static(self.scene) and hasattr(self, "parts"):
            return
        for name in ("lit", "glowing"):
            self.__dict__.pop(name, None)
        self.parts = [
            Part(label, solid, moves(thing))
            for label, thing in enumerate(self.scene.things, start=1)
            for solid in solids_at(thing, t_s)
        ]

    def shapes(
        self, look: str, surface: Callable[[Part], Surface], backwards: bool = False
    ) -> list[mi.Shape]:
        """Of all parts; those that stay where they are, are made once for each look."""
        shapes = []
        for part in self.parts:
            key = look, part.solid.name
            if part.moves or key not in self.standing:
                self.standing[key] = shapes_of(part.solid, surface(part), backwards)
            shapes += self.standing[key]
        return shapes

    @cached_property
    def lit(self) -> list[tuple[mi.Scene, int]]:
        """A scene for each light, and its rays a pixel."""
        shapes = self.shapes("lit", lambda part: self.surfaces[part.solid.name])
        return [(self.load(shapes, lamp), rays) for lamp, rays in lamps(self.scene, self.rays)]

    @staticmethod
    def load(shapes: list[mi.Shape], *lamp: dict) -> mi.Scene:
        numbered = {f"part{n}": part for n, part in enumerate([*shapes, *lamp])}
        return mi.load_dict({"type": "scene", **numbered})

    @cached_property
    def glowing(self) -> tuple[mi.Scene, mi.Scene]:
        """Every solid emits its label, so that what a camera sees directly is the label. Light leaves one
        side of a surface only: the second scene emits inwards, for meshes and panels seen from behind."""
        outwards, inwards = (
            self.shapes(look, lambda part: glowing_surface(part.label), backwards=look == "inwards")
            for look in ("outwards", "inwards")
        )
        return self.load(outwards), self.load(inwards)

    @cached_property
    def blue_sky(self) -> mi.Scene:
        to_sun = list(unit(self.scene.to_sun))
        sky = {"type": "sunsky", "sun_direction": to_sun, "sun_scale": 0.0, "turbidity": 4.0}
        return mi.load_dict({"type": "scene", "sky": sky})

    def sensor(self, world_from_camera: np.ndarray, rays: int, reduction: int = 1) -> mi.Sensor:
        """One ray goes through the pixel's centre, more are spread over the pixel."""
        film = {
            "type": "hdrfilm",
            "width": self.rig.width_px // reduction,
            "height": self.rig.height_px // reduction,
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
        lit = [
            pixels(scene, self.sensor(world_from_camera, rays), self.direct, seed) for scene, rays in self.lit
        ]
        surface, cover = reduce(np.add, (each[..., 0] for each in lit)), lit[0][..., 3]
        if self.scene.haze:
            surface = through_haze(self.scene.haze, surface, cover, self.distance_m(world_from_camera))
        return (surface + (1 - cover) * self.sky(world_from_camera)).astype(np.float32)

    def sky(self, world_from_camera: np.ndarray) -> np.ndarray | float:
        if self.scene.haze:  # of which there is more before the sky than anything shines through
            return self.scene.haze.airlight
        if self.scene.sky == "overcast":
            return self.scene.overcast_radiance
        small = self.sensor(world_from_camera, 1, SKY_REDUCTION)
        sky = pixels(self.blue_sky, small, self.direct, seed=0)[..., :3] @ GREY_OF_RGB * SKY_RADIANCE_SCALE
        return cv2.resize(sky, (self.rig.width_px, self.rig.height_px), interpolation=cv2.INTER_LINEAR)

    def distance_m(self, world_from_camera: np.ndarray) -> np.ndarray:
        """(H, W) along the ray through each pixel's centre, inf = sky."""
        sensor = self.sensor(world_from_camera, 1)
        seen = pixels(self.lit[0][0], sensor, mi.load_dict({"type": "depth"}), seed=0)
        return np.where(seen[..., 3] > 0, seen[..., 0] + NEAR_CLIP_M / self.forward(), np.inf)

    def view(self, world_from_camera: np.ndarray) -> View:
        sensor, seen = self.sensor(world_from_camera, 1), mi.load_dict({"type": "path", "max_depth": 1})
        depth_m = self.distance_m(world_from_camera) * self.forward()
        outwards, inwards = self.glowing
        glow = pixels(outwards, sensor, seen, seed=0)[..., 0]
        dark = (glow == 0) & np.isfinite(depth_m)
        if np.any(dark):
            glow[dark] = pixels(inwards, sensor, seen, seed=0)[dark, 0]
        return View(depth_m.astype(np.float32), np.rint(glow).astype(np.int32))

    def forward(self) -> np.ndarray:
        """(H, W) cosine between each pixel's ray and the optical axis."""
        (cu, cv), f = self.rig.center_px, self.rig.focal_px
        v, u = np.mgrid[0 : self.rig.height_px, 0 : self.rig.width_px]
        return 1 / np.sqrt(1 + ((u - cu) / f) ** 2 + ((v - cv) / f) ** 2)
