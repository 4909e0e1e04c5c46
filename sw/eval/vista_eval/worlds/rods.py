"""Thin round things: wires, ropes, the members of lattices, bars, tubes.

They are solids of their own and no meshes, because a renderer draws what is thinner than a pixel by the share
of the pixel that it covers, and has to know its diameter for that."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vista_eval.render.scene import Cylinder, Solid
from vista_eval.worlds.triangles import turned

SEGMENT_M = 1.5


class Rods(NamedTuple):
    start_m: np.ndarray  # (N, 3)
    end_m: np.ndarray
    radius_m: np.ndarray  # (N,)
    albedo: np.ndarray

    def solids(self, name: str) -> list[Solid]:
        return [
            Cylinder(
                f"{name}_{k}", point(start), point(end), float(radius), np.full((2, 2), albedo, np.float32)
            )
            for k, (start, end, radius, albedo) in enumerate(zip(*self, strict=True))
        ]

    def moved(self, foot_m: ArrayLike, yaw_deg: float = 0.0) -> Rods:
        """Turned about z from x towards y, then moved."""
        foot = np.asarray(foot_m, float)
        start_m, end_m = (turned(ends_m, yaw_deg) + foot for ends_m in (self.start_m, self.end_m))
        return self._replace(start_m=start_m, end_m=end_m)

    def lying(self) -> Rods:
        """The same rods lying: up becomes +y."""
        return self._replace(start_m=self.start_m[:, [0, 2, 1]], end_m=self.end_m[:, [0, 2, 1]])


def point(position_m: ArrayLike) -> tuple[float, float, float]:
    x, y, z = (float(c) for c in np.asarray(position_m))
    return x, y, z


def rods(ends_m: ArrayLike, radius_m: ArrayLike, albedo: ArrayLike) -> Rods:
    """Straight ones between pairs of points (N, 2, 3); radius and albedo one number or one of each."""
    ends = np.asarray(ends_m, float).reshape(-1, 2, 3)
    radii, albedos = (np.broadcast_to(np.asarray(each, float), len(ends)) for each in (radius_m, albedo))
    return Rods(ends[:, 0], ends[:, 1], radii, albedos)


def all_of(*parts: Rods) -> Rods:
    return Rods(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def strand(
    start_m: ArrayLike, end_m: ArrayLike, radius_m: float, sag: float, rng: np.random.Generator
) -> Rods:
    """A wire that sags by a share of its length; its shade changes along it as dirt and light make it."""
    start, end = np.asarray(start_m, float), np.asarray(end_m, float)
    length = float(np.linalg.norm(end - start))
    t = np.linspace(0, 1, max(4, round(length / SEGMENT_M)))
    points = start + t[:, None] * (end - start)
    points[:, 2] -= 4 * sag * length * t * (1 - t)
    albedo = np.clip(rng.uniform(0.04, 0.5) * rng.lognormal(0, 0.25, len(t) - 1), 0.02, 0.7)
    return rods(np.stack([points[:-1], points[1:]], axis=1), radius_m, albedo)


def lattice(height_m: float, side_m: float, member_m: float, albedo: float, corners: int = 3) -> Rods:
    """Legs and diagonals of a mast, its foot at the origin; `member_m`: radius of the legs."""
    turn = np.arange(corners) * 2 * np.pi / corners
    legs = side_m / np.sqrt(3 if corners == 3 else 2) * np.column_stack([np.cos(turn), np.sin(turn)])
    upright = [[(*leg, 0.0), (*leg, height_m)] for leg in legs]
    step = 1.1 * side_m
    across = [
        [(*legs[k - level % 2], z), (*legs[k - 1 + level % 2], z + step)]
        for level, z in enumerate(np.arange(0.0, height_m - step, step))
        for k in range(corners)
    ]
    return all_of(rods(upright, member_m, albedo), rods(across, 0.5 * member_m, albedo))
