"""Scene and camera pose -> radiance, and the exact depth and object of every pixel, by Mitsuba 3.

Light comes from two directions, the sun and a weaker fill for the sky, rendered one after the other: nothing
is left to chance but where in the pixel a ray falls, so a few rays a pixel leave no speckle that the cameras
would not share. (Mitsuba picks one light at random per ray, and its `aov` integrator takes time in proportion
to the number of shapes: hence one scene a light, and labels as emitted radiance.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mitsuba as mi
import numpy as np

from .rig import Rig
from .scene import Board, Box, Cylinder, GroundStrip, Scene, Solid, Sphere

mi.set_variant("scalar_rgb")

SUN_IRRADIANCE = 4.2  # perpendicular to the light; radiance 1 fills the sensor
FILL_IRRADIANCE = 1.1
FILL_DIRECTION = (0.75, -0.35, -0.55)  # from behind the aircraft, so that no visible face is quite dark
SKY_RADIANCE_SCALE = 6.0  # Mitsuba's sky in units of ours
GREY_OF_RGB = np.array([0.30, 0.45, 0.25])  # a sensor without a colour filter
NEAR_CLIP_M = 0.1  # Mitsuba measures distances from the near plane
# Mitsuba's camera looks along +z with +x to the left and +y up.
CAMERA_FROM_MITSUBA = np.diag([-1.0, -1.0, 1.0, 1.0])

Transform = mi.ScalarTransform4f


@dataclass(frozen=True)
class Truth:
    """What each pixel's centre sees."""

    depth_m: np.ndarray  # (H, W) float32, along the optical axis; inf = sky
    solid: np.ndarray  # (H, W) int32, index into `names`; -1 = sky
    names: tuple[str, ...]

    def mask(self, parts: tuple[str, ...]) -> np.ndarray:
        return np.isin(self.solid, [self.names.index(part) for part in parts])

    def disparity_px(self, rig: Rig) -> np.ndarray:
        return rig.focal_px * rig.baseline_m / self.depth_m


def diffuse(albedo: np.ndarray) -> dict:
    bitmap = mi.Bitmap(np.ascontiguousarray(albedo[:, :, None], dtype=np.float32))
    texture = {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": texture}}


def rectangle(albedo: np.ndarray, center: np.ndarray, half_u: np.ndarray, half_v: np.ndarray) -> dict:
    """Faces `half_u` x `half_v`; columns of the albedo run along `half_u`, rows along `half_v`."""
    to_world = np.eye(4)
    to_world[:3, :4] = np.stack([half_u, half_v, np.cross(half_u, half_v), center], axis=1)
    return {"type": "rectangle", "to_world": Transform(to_world), "bsdf": diffuse(albedo)}


def cylinder(solid: Cylinder) -> list[dict]:
    """A tube and its two caps; Mitsuba's cylinder is open."""
    start, end = np.array(solid.start_m), np.array(solid.end_m)
    bsdf = diffuse(solid.albedo)
    tube = {
        "type": "cylinder",
        "p0": solid.start_m,
        "p1": solid.end_m,
        "radius": solid.radius_m,
        "bsdf": bsdf,
    }
    shapes = [tube]
    up = [1.0, 0.0, 0.0] if abs(end[2] - start[2]) > 1e-9 else [0.0, 0.0, 1.0]
    for center, outward in ((start, start - end), (end, end - start)):
        look_at = Transform().look_at(origin=list(center), target=list(center + outward), up=up)
        to_world = look_at.scale([solid.radius_m, solid.radius_m, 1.0])
        shapes.append({"type": "disk", "to_world": to_world, "bsdf": bsdf})
    return shapes


def shapes_of(solid: Solid) -> list[dict]:
    """The Mitsuba shapes of one solid, faces outwards."""
    match solid:
        case Cylinder():
            return cylinder(solid)
        case Sphere():
            shape = {"type": "sphere", "center": solid.center_m, "radius": solid.radius_m}
            return [shape | {"bsdf": diffuse(solid.albedo)}]
        case Box():
            to_world = Transform().translate(solid.center_m).rotate([0, 0, 1], solid.yaw_deg)
            shape = {"type": "cube", "to_world": to_world.scale([s / 2 for s in solid.size_m])}
            return [shape | {"bsdf": diffuse(solid.albedo)}]
        case Board():  # seen from -x: right is -y
            half_u, half_v = np.array([0, -solid.width_m / 2, 0]), np.array([0, 0, solid.height_m / 2])
            return [rectangle(solid.albedo[::-1], np.array(solid.center_m), half_u, half_v)]
        case GroundStrip():
            (x0, x1), (y0, y1) = solid.x_m, solid.y_m
            center = np.array([(x0 + x1) / 2, (y0 + y1) / 2, 0.0])
            half_u, half_v = np.array([0, (y0 - y1) / 2, 0]), np.array([(x1 - x0) / 2, 0, 0])
            return [rectangle(solid.albedo[:, ::-1], center, half_u, half_v)]


def unit(vector: tuple[float, float, float]) -> np.ndarray:
    return np.array(vector) / np.linalg.norm(vector)


def pixels(scene: mi.Scene, sensor: mi.Sensor, integrator: mi.Integrator, seed: int) -> np.ndarray:
    return np.array(mi.render(scene, sensor=sensor, integrator=integrator, seed=seed))


class Renderer:
    """A scene loaded once, seen from any pose. `rays` a pixel: a square number."""

    def __init__(self, scene: Scene, rig: Rig, rays: int = 4):
        self.scene = scene
        self.rig = rig
        self.rays = rays
        self.names = tuple(solid.name for solid in scene.solids)
        to_sun = unit(scene.to_sun)
        self.lit = [
            self.load_lit(-to_sun, SUN_IRRADIANCE),
            self.load_lit(unit(FILL_DIRECTION), FILL_IRRADIANCE),
        ]
        sky = {"type": "sunsky", "sun_direction": list(to_sun), "sun_scale": 0.0, "turbidity": 4.0}
        self.sky = mi.load_dict({"type": "scene", "sky": sky})
        self.direct = mi.load_dict({"type": "direct"})

    def numbered_shapes(self) -> dict[str, tuple[int, dict]]:
        """Mitsuba shapes with the index of the solid that each belongs to."""
        parts = [(k, part) for k, solid in enumerate(self.scene.solids) for part in shapes_of(solid)]
        return {f"shape{n}": part for n, part in enumerate(parts)}

    def load_lit(self, direction: np.ndarray, irradiance: float) -> mi.Scene:
        light = {"type": "directional", "direction": list(direction), "irradiance": irradiance}
        shapes = {name: shape for name, (_, shape) in self.numbered_shapes().items()}
        return mi.load_dict({"type": "scene", "light": light, **shapes})

    @cached_property
    def labels(self) -> mi.Scene:
        """Every solid emits its index plus one, so that what a camera sees directly is the label."""
        shapes = {}
        for name, (solid, shape) in self.numbered_shapes().items():
            glow = {"type": "area", "radiance": {"type": "rgb", "value": solid + 1.0}}
            shapes[name] = {key: value for key, value in shape.items() if key != "bsdf"} | {"glow": glow}
        return mi.load_dict({"type": "scene", **shapes})

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
        sky = pixels(self.sky, self.sensor(world_from_camera, 1), self.direct, seed)
        sky = sky[..., :3] @ GREY_OF_RGB * SKY_RADIANCE_SCALE
        return (sun[..., 0] + fill[..., 0] + (1 - sun[..., 3]) * sky).astype(np.float32)

    def truth(self, world_from_camera: np.ndarray) -> Truth:
        sensor = self.sensor(world_from_camera, 1)
        label = pixels(self.labels, sensor, mi.load_dict({"type": "path", "max_depth": 1}), seed=0)
        distance_m = pixels(self.labels, sensor, mi.load_dict({"type": "depth"}), seed=0)
        solid = np.rint(label[..., 0]).astype(np.int32) - 1
        depth = np.where(solid >= 0, distance_m[..., 0] * self.forward() + NEAR_CLIP_M, np.inf)
        return Truth(depth.astype(np.float32), solid, self.names)

    def forward(self) -> np.ndarray:
        """(H, W) cosine between each pixel's ray and the optical axis."""
        (cu, cv), f = self.rig.center_px, self.rig.focal_px
        v, u = np.mgrid[0 : self.rig.height_px, 0 : self.rig.width_px]
        return 1 / np.sqrt(1 + ((u - cu) / f) ** 2 + ((v - cv) / f) ** 2)
