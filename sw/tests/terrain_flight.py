"""Flights over ground of any profile for the tests of libvista's terrain stage: disparities at the cells'
centres, with the errors of a matching engine, and what the stage makes of them from frame to frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from stage_library import LEVEL_UP, Arena, Stages, ffi, lib
from track_library import camera, flight_path, matched, motion, pose

Array = np.ndarray
Elevation = Callable[[Array, Array], Array]  # of x to the right and z ahead, metres: above the plane y = 0
RADIUS_M, LENGTH_M = 2.0, 100.0
NEAREST_M, FARTHEST_M, STEPS = 3.0, 160.0, 100
BLOCK_PX = 8  # within it, matching errors are alike
RATE_HZ = 10.0


def slope(degrees: float, foot_m: float) -> Elevation:
    """Flat up to the foot, a hillside behind it."""
    return lambda x, z: np.maximum(np.tan(np.radians(degrees)) * (z - foot_m), 0.0)


def ridge(degrees: float, crest_m: float, height_m: float) -> Elevation:
    return lambda x, z: np.maximum(height_m - np.tan(np.radians(degrees)) * np.abs(z - crest_m), 0.0)


def rolling(height_m: float, length_m: float, phase: float) -> Elevation:
    """Hills and hollows, their tops at height_m and as much to the sides."""
    return lambda x, z: (
        0.5 * height_m * (1.0 + np.cos(2 * np.pi * z / length_m + phase) * np.cos(np.pi * x / length_m))
    )


def first_contact_m(elevation: Elevation, start: Array, direction: Array) -> float:
    """The way along a straight path to the point of the ground that a ball which flies on it touches first;
    infinite if it touches none. It is written without the library: points of the ground, each asked for
    itself."""
    reach = 1.5 * RADIUS_M
    x, z = np.meshgrid(np.arange(-reach, reach, 0.1), np.arange(-reach, LENGTH_M + reach, 0.1))
    ground = np.stack([start[0] + x, -elevation(start[0] + x, start[2] + z), start[2] + z], axis=-1) - start
    along = ground @ direction
    aside2 = np.maximum(np.sum(ground**2, axis=-1) - along**2, 0.0)
    center = along - np.sqrt(np.maximum(RADIUS_M**2 - aside2, 0.0))
    touched = (aside2 <= RADIUS_M**2) & (center > 0.0) & (along <= LENGTH_M)
    if not touched.any():
        return np.inf
    return float(along[touched][np.argmin(center[touched])])


@dataclass(frozen=True)
class Seen:
    """What the stage says in one frame."""

    warned: bool
    along_m: float  # NaN where there is nothing ahead
    point_m: Array
    sigma_m: float
    verdict: int
    coasting: bool
    blind: bool


class TerrainFlight:
    """A camera that flies, and the stage. World: x right, y down, z ahead; the ground's base is y = 0."""

    def __init__(self, random: np.random.Generator, **changes: float) -> None:
        self.random = random
        self.view = camera()
        self.stages = Stages(self.view, {key.replace("__", "."): value for key, value in changes.items()})
        self.terrain = ffi.new("vista_terrain *")
        self.stages._arenas.append(self._memory())
        self.frame = 0
        f = self.stages.foveation
        self.rays = np.stack(
            [
                (f.center_u - self.view.center_u_px) / self.view.focal_px,
                (f.center_v - self.view.center_v_px) / self.view.focal_px,
                np.ones_like(f.center_u),
            ],
            axis=1,
        ).astype(float)

    def _memory(self):
        arena = Arena(
            lambda arena: lib.vista_terrain_layout(self.terrain, arena, self.stages.foveation.handle)
        )
        assert arena.status == lib.VISTA_OK
        return arena

    def depth_m(self, elevation: Elevation, position: Array, rotation: Array) -> Array:
        """The depth of each cell's ray along the optical axis; infinite in the sky."""
        rays = (self.rays @ rotation.T).astype(np.float32)
        x, y, z = (rays[:, k] for k in range(3))
        cells, depths = np.arange(len(rays)), np.geomspace(NEAREST_M, FARTHEST_M, STEPS, dtype=np.float32)

        def above(depth: Array) -> Array:
            height = -(position[1] + depth * y)
            return height - elevation(position[0] + depth * x, position[2] + depth * z)

        heights = above(depths[:, None])
        below = heights <= 0.0
        last = np.argmax(below, axis=0)
        first = np.maximum(last - 1, 0)
        near, far = depths[first], depths[last]
        near_m, far_m = heights[first, cells], heights[last, cells]
        for _ in range(2):  # secants
            depth = near + (far - near) * np.clip(near_m / np.maximum(near_m - far_m, 1e-6), 0.0, 1.0)
            there_m = above(depth)
            near, near_m = np.where(there_m > 0, depth, near), np.where(there_m > 0, there_m, near_m)
            far, far_m = np.where(there_m > 0, far, depth), np.where(there_m > 0, far_m, there_m)
        return np.where(below.any(axis=0), depth, np.inf)

    def engine_like(self, disparity: Array, sigma_px: float, missing: float, wrong: float) -> Array:
        """Noise that neighbours within a matching block share, patches without a disparity, and patches with
        one by chance."""
        f = self.stages.foveation
        shape = (self.view.height_px // BLOCK_PX + 2, self.view.width_px // BLOCK_PX + 2)

        def field() -> Array:
            """Standard normal at each cell, smooth over a block."""
            coarse = self.random.normal(size=shape).astype(np.float32)
            u, v = (c[None, :] / np.float32(BLOCK_PX) for c in (f.center_u, f.center_v))
            return cv2.remap(coarse, u, v, cv2.INTER_LINEAR)[0] * 1.5  # what the interpolation takes away

        by_chance, gone = field(), field()
        found = disparity + sigma_px * field()
        found = np.where(
            by_chance >= np.quantile(by_chance, 1 - wrong), self.random.uniform(0.5, 63.0, len(found)), found
        )
        outside = (f.center_u < 68) | (found <= 0.25) | (found > 63.0)
        return np.where((gone >= np.quantile(gone, 1 - missing)) | outside, -1.0, found)

    def fly(
        self,
        elevation: Elevation,
        position: Array,
        velocity: Array,
        rotation: Array | None = None,
        sigma_px: float = 0.25,
        missing: float = 0.1,
        wrong: float = 0.03,
        range_scale: float = 1.0,
        **given: object,
    ) -> Seen:
        """One frame. range_scale: what a texture matched a period off makes of all ranges."""
        rotation = np.eye(3) if rotation is None else rotation
        depth = self.depth_m(elevation, np.asarray(position, float), rotation)
        exact = self.view.focal_px * self.view.baseline_m / depth / range_scale
        self.stages.disparity_px[:] = self.engine_like(exact, sigma_px, missing, wrong)
        return self.update(position, velocity, rotation, **given)

    def update(self, position, velocity, rotation=None, arc: dict | None = None, **given: object) -> Seen:
        """Updates the terrain with the disparities that the cells have."""
        rotation = np.eye(3) if rotation is None else rotation
        moved = motion(pose(position, rotation), velocity, **given)
        self.frame += 1
        t = self.terrain
        path = flight_path(moved, LENGTH_M, **(arc or {}))
        area = matched(disparity_max_px=63.0, margin_left_px=68.0, margin_px=5.0)
        t_ns = int(self.frame * 1e9 / RATE_HZ)
        self.stages.see(up=rotation.T @ LEVEL_UP, matched=area, motion=moved, path=path, t_ns=t_ns)
        lib.vista_terrain_update(self.stages.frame, self.stages.cells, t)
        return Seen(
            bool(t.ahead and t.credible and t.steady),
            t.contact.along_m if t.ahead else np.nan,
            np.array(list(t.contact.point_m)),
            t.sigma_m,
            t.world.verdict,
            bool(t.coasting),
            bool(t.blind),
        )
