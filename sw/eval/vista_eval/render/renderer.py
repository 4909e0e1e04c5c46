"""Renders radiance, depth and labels of a scene from a camera pose by casting rays with Embree.

One ray goes through the middle of each pixel; it decides the truth. Pixels where the surface or its light
changes get four more at fixed places, and the albedo is averaged over what the pixel covers. Nothing is left
to chance, so the cameras share what they see. Thin round things are drawn by the share of a pixel that they
cover (`wires`).
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import NamedTuple

import cv2
import numpy as np

from vista_eval.render import light
from vista_eval.render.motion import is_static, moves, solids_at
from vista_eval.render.rig import Rig, View
from vista_eval.render.scene import Scene
from vista_eval.render.surfaces import Hits, Rays, Surfaces, unit_rows
from vista_eval.render.wires import Wires, is_wire

# Places in a pixel: on each row and each column of a grid of eight there is at most one.
Offsets = tuple[tuple[float, float], ...]
OFF_CENTER_PX: Offsets = ((-0.125, -0.375), (0.375, -0.125), (0.125, 0.375), (-0.375, 0.125))
TILE_PX = 4
CHANGE = 0.03  # of radiance without albedo maps: pixels that differ by more get more rays


class Samples(NamedTuple):
    """One ray an entry."""

    radiance: np.ndarray
    depth_m: np.ndarray  # along the optical axis, inf = sky
    label: np.ndarray  # 0 = sky
    part: np.ndarray  # number of the solid, -1 = sky
    plain: np.ndarray  # radiance as if no albedo map had any texture; of the first ray of a pixel alone
    above: np.ndarray  # whether the sky's light from above reaches it


class Picture(NamedTuple):
    radiance: np.ndarray  # (H, W)
    view: View


class Renderer:
    """A scene, seen from any pose at any time."""

    def __init__(self, scene: Scene, rig: Rig, beside: Offsets = OFF_CENTER_PX) -> None:
        """beside: where in a pixel the other rays go, if it gets more than one."""
        self.scene, self.rig, self.beside = scene, rig, beside
        self.to_sun = light.unit(scene.to_sun)
        standing = [
            (label, solid)
            for label, thing in enumerate(scene.things, start=1)
            if not moves(thing)
            for solid in thing.solids
        ]
        self.standing = Surfaces([part for part in standing if not is_wire(part[1])])
        self.wires = Wires([part for part in standing if is_wire(part[1])])
        self.pictures = lru_cache(maxsize=2)(self.draw)
        self.move_to(0.0)

    def move_to(self, t_s: float) -> None:
        """Things go where they are `t_s` after the last frame."""
        self.pictures.cache_clear()
        self.groups = [self.standing]
        if not is_static(self.scene):
            moving = [
                (label, solid)
                for label, thing in enumerate(self.scene.things, start=1)
                if moves(thing)
                for solid in solids_at(thing, t_s)
            ]
            self.groups.append(Surfaces(moving))

    def radiance(self, world_from_camera: np.ndarray) -> np.ndarray:
        """(H, W) float32."""
        return self.pictures(world_from_camera.tobytes()).radiance

    def view(self, world_from_camera: np.ndarray) -> View:
        return self.pictures(world_from_camera.tobytes()).view

    def draw(self, pose: bytes) -> Picture:
        world_from_camera = np.frombuffer(pose).reshape(4, 4)
        shape = self.rig.height_px, self.rig.width_px
        u, v, tiles = pixels(shape)
        middle = self.cast(world_from_camera, u, v, tiles)
        radiance = middle.radiance.copy()
        more = tiles[changes(middle, shape)[tiles]]
        for du, dv in self.beside:
            order = np.arange(len(more))
            beside = self.cast(world_from_camera, u[more] + du, v[more] + dv, order, middle.above[more])
            radiance[more] += beside.radiance
        radiance[more] /= 1 + len(self.beside)
        seen = View(middle.depth_m.reshape(shape), middle.label.reshape(shape))
        drawn = self.wires.drawn(self.scene, self.groups, self.rig, world_from_camera, seen)
        return Picture(drawn.over(radiance.reshape(shape)), drawn.view)

    def cast(
        self,
        world_from_camera: np.ndarray,
        u_px: np.ndarray,
        v_px: np.ndarray,
        order: np.ndarray,
        above: np.ndarray | None = None,
    ) -> Samples:
        """Rays through points of the image. order: of the points, those first that are near each other;
        above: what is known of the sky's light there."""
        rotation, focal = world_from_camera[:3, :3], self.rig.focal_px
        cu, cv = self.rig.center_px
        right, down = (u_px - cu)[:, None] / focal, (v_px - cv)[:, None] / focal
        # Of length 1 along the optical axis.
        ray = (right * rotation[:, 0] + down * rotation[:, 1] + rotation[:, 2]).astype(np.float32)
        sides = (rotation[:, :2] / focal).T.astype(np.float32)
        rays = Rays(world_from_camera[:3, 3].astype(np.float32), ray, sides[0], sides[1], order)
        count = len(ray)
        found = Samples(
            np.zeros(count, np.float32),
            np.full(count, np.inf, np.float32),
            np.zeros(count, np.int32),
            np.full(count, -1, np.int32),
            np.zeros(count, np.float32),
            np.ones(count, bool) if above is None else above,
        )
        parts = 0
        for group, hits in zip(self.groups, self.nearest(rays), strict=True):
            self.shade(group, hits, rays, found, parts, above is None)
            parts += group.parts
        sky = np.flatnonzero(found.part < 0)
        found.radiance[sky] = light.sky_radiance(self.scene, unit_rows(ray[sky]))
        found.plain[sky] = found.radiance[sky]
        return found

    def nearest(self, rays: Rays) -> list[Hits]:
        """What of each group the rays meet first of all."""
        met = [group.met(rays) for group in self.groups]
        if len(met) == 1:
            return met
        nearest_m = np.full(len(rays.direction), np.inf, np.float32)
        for hits in met:
            nearest_m[hits.ray] = np.minimum(nearest_m[hits.ray], hits.depth_m)
        kept = [hits.depth_m <= nearest_m[hits.ray] for hits in met]
        return [Hits(*(each[first] for each in hits)) for hits, first in zip(met, kept, strict=True)]

    def shade(
        self,
        group: Surfaces,
        hits: Hits,
        rays: Rays,
        found: Samples,
        parts: int,
        is_first: bool,
    ) -> None:
        matter = group.matter(hits, rays)
        sun = light.reached(self.groups, matter.point_m, matter.normal, self.to_sun)
        if is_first:
            found.above[hits.ray] = light.reached(self.groups, matter.point_m, matter.normal, light.ABOVE)
        irradiance = light.irradiance(self.scene, matter.normal, sun, found.above[hits.ray])
        distance_m = np.linalg.norm(matter.point_m - rays.origin_m, axis=1)
        radiance = matter.albedo * irradiance / np.float32(np.pi)
        found.radiance[hits.ray] = light.through_air(self.scene.haze, radiance, distance_m)
        found.depth_m[hits.ray] = hits.depth_m
        found.label[hits.ray] = matter.label
        found.part[hits.ray] = matter.part + parts
        if is_first:
            found.plain[hits.ray] = matter.plain * irradiance / np.float32(np.pi)


@cache
def pixels(shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Columns and rows of all pixels, and their order by squares of TILE_PX: what Embree traces at a time
    lies together."""
    v, u = (index.ravel() for index in np.indices(shape))
    return u, v, np.lexsort((u % TILE_PX, v % TILE_PX, u // TILE_PX, v // TILE_PX))


def changes(samples: Samples, shape: tuple[int, int]) -> np.ndarray:
    """(H W,) where a pixel or a neighbour of it shows another solid, or other light, than the next one."""
    plain, part = samples.plain.reshape(shape), samples.part.reshape(shape)
    found = np.zeros(shape, np.uint8)
    for axis in (0, 1):
        differ = (np.abs(np.diff(plain, axis=axis)) > CHANGE) | (np.diff(part, axis=axis) != 0)
        first, second = (slice(None, -1), slice(1, None))
        found[(first, slice(None)) if axis == 0 else (slice(None), first)] |= differ
        found[(second, slice(None)) if axis == 0 else (slice(None), second)] |= differ
    return cv2.dilate(found, np.ones((3, 3), np.uint8)).ravel() > 0
