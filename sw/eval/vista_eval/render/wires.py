"""Wires, ropes and thin tubes, drawn by the share of each pixel that they cover.

A wire of 12 mm is 0.4 px wide at 30 m: a few rays a pixel would make dots of it, others for each camera. Here
the strip between its outlines is cut by the pixel exactly. It is lit across its width, as a cylinder is. It
casts no shadow.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from vista_eval.render import light
from vista_eval.render.rig import Rig, View
from vista_eval.render.scene import Cylinder, Scene, Solid
from vista_eval.render.strips import STRIPS, Pieces, Straight, pieces_of
from vista_eval.render.surfaces import Surfaces

THICKEST_M = 0.06  # diameter of what is drawn in this way
CHANGE = 0.1  # of albedo, from one row of the map to the next: there another band of paint begins


def is_wire(solid: Solid) -> bool:
    return isinstance(solid, Cylinder) and 2 * solid.radius_m <= THICKEST_M


def bands(solid: Cylinder) -> list[Cylinder]:
    """The bands of paint along a cylinder, from its start to its end."""
    rows = solid.albedo.mean(axis=1)
    begins = np.flatnonzero(np.abs(np.diff(rows)) > CHANGE) + 1
    start_m, step_m = np.array(solid.start_m), np.subtract(solid.end_m, solid.start_m) / len(rows)
    ends_m = [tuple(start_m + k * step_m) for k in (0, *begins, len(rows))]
    shades = np.split(solid.albedo, begins)
    return [
        replace(solid, start_m=start, end_m=end, albedo=shade)
        for (start, end), shade in zip(pairwise(ends_m), shades, strict=True)
    ]


@dataclass(frozen=True)
class Drawing:
    """Wires over a picture."""

    cover: np.ndarray  # (H, W) share of the pixel
    radiance: np.ndarray  # (H, W) of them, times the share
    view: View

    def over(self, radiance: np.ndarray) -> np.ndarray:
        return (radiance * (1 - self.cover) + self.radiance).astype(np.float32)


class Wires:
    def __init__(self, parts: list[tuple[int, Solid]]) -> None:
        wires = [(label, solid) for label, solid in parts if isinstance(solid, Cylinder)]
        solids = [(label, band) for label, solid in wires for band in bands(solid)]
        self.label = np.array([label for label, _ in solids], np.int32)
        self.start_m = np.array([solid.start_m for _, solid in solids], float).reshape(-1, 3)
        self.end_m = np.array([solid.end_m for _, solid in solids], float).reshape(-1, 3)
        self.radius_m = np.array([solid.radius_m for _, solid in solids], float)
        self.albedo = np.array([np.mean(solid.albedo) for _, solid in solids], float)

    def pieces(self, rig: Rig, pose: np.ndarray) -> Pieces:
        start_m, end_m = ((ends - pose[:3, 3]) @ pose[:3, :3] for ends in (self.start_m, self.end_m))
        return pieces_of(rig, Straight(start_m, end_m, self.radius_m))

    def drawn(self, scene: Scene, groups: list[Surfaces], rig: Rig, pose: np.ndarray, view: View) -> Drawing:
        """Draws the wires where nothing stands before them. view: without wires."""
        pieces = self.pieces(rig, pose)
        pieces = pieces.where(pieces.depth_m < view.depth_m.ravel()[pieces.pixel])
        pieces = pieces.where(np.argsort(-pieces.depth_m, kind="stable"))
        shape = view.depth_m.shape
        cover, radiance = np.zeros(shape[0] * shape[1]), np.zeros(shape[0] * shape[1])
        pixel, share, glow = together(pieces, self.label, self.glow(scene, groups, rig, pose, pieces))
        for chosen in layers(pixel):
            place, rest = pixel[chosen], 1 - share[chosen]
            cover[place] = cover[place] * rest + share[chosen]
            radiance[place] = radiance[place] * rest + glow[chosen]
        return Drawing(cover.reshape(shape), radiance.reshape(shape), self.seen(pieces, view))

    def seen(self, pieces: Pieces, view: View) -> View:
        """The view with the wires that the pixels' middles show; pieces: the farthest first."""
        depth_m, label = view.depth_m.copy(), view.label.copy()
        middle = pieces.where((np.abs(pieces.across) <= 1) & pieces.within)
        bulge_m = self.radius_m[middle.wire] * np.sqrt(1 - middle.across**2)
        depth_m.ravel()[middle.pixel] = middle.depth_m - bulge_m
        label.ravel()[middle.pixel] = self.label[middle.wire]
        return View(depth_m, label)

    def glow(
        self, scene: Scene, groups: list[Surfaces], rig: Rig, pose: np.ndarray, pieces: Pieces
    ) -> np.ndarray:
        """(n,) radiance towards the camera, times the share of the pixel."""
        v, u = np.divmod(pieces.pixel, rig.width_px)
        (cu, cv), focal = rig.center_px, rig.focal_px
        camera = np.stack([(u - cu) / focal, (v - cv) / focal, np.ones(len(u))], axis=1)
        ray = camera @ pose[:3, :3].T
        point_m = pose[:3, 3] + pieces.depth_m[:, None] * ray
        axis = (self.end_m - self.start_m)[pieces.wire]
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        right = np.cross(ray, axis)
        right /= np.maximum(np.linalg.norm(right, axis=1, keepdims=True), 1e-9)
        front = np.cross(right, axis)
        front *= -np.sign(np.einsum("ij,ij->i", front, ray))[:, None]
        lit = [
            lamp(groups, point_m, front, self.radius_m[pieces.wire], towards)
            for towards in (light.unit(scene.to_sun), light.ABOVE)
        ]
        glow = np.zeros(len(u))
        for strip, place in enumerate((np.arange(STRIPS) + 0.5) * 2 / STRIPS - 1):
            normal = place * right + np.sqrt(1 - place**2) * front
            power = light.irradiance(scene, normal, *lit) * self.albedo[pieces.wire] / np.pi
            distance_m = pieces.depth_m * np.linalg.norm(ray, axis=1)
            glow += light.through_air(scene.haze, power, distance_m) * pieces.cover[:, strip]
        return glow


def lamp(
    groups: list[Surfaces], point_m: np.ndarray, front: np.ndarray, radius_m: np.ndarray, towards: np.ndarray
) -> np.ndarray:
    """(n,) whether the light reaches the wire, or something else hides it."""
    reached = np.ones(len(point_m), bool)
    for group in groups:
        group.hide(reached, point_m + radius_m[:, None] * front, front, towards.astype(np.float32))
    return reached


def together(
    pieces: Pieces, label: np.ndarray, glow: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pixel, share and glow of all that one pixel shows of one thing, the farthest first: the pieces of a
    wire that sags lie end to end and hide nothing of each other. pieces: the farthest first."""
    key = pieces.pixel * (int(label.max(initial=0)) + 1) + label[pieces.wire]
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    whole = np.bincount(group, pieces.cover.sum(axis=1))
    share = np.minimum(whole, 1.0)
    power = np.bincount(group, glow) * share / np.maximum(whole, 1e-12)
    order = np.argsort(first)
    return pieces.pixel[first[order]], share[order], power[order]


def layers(pixel: np.ndarray) -> list[np.ndarray]:
    """Indices such that a pixel occurs once in each, in their order."""
    order = np.argsort(pixel, kind="stable")
    ordered = pixel[order]
    starts = np.flatnonzero(np.diff(ordered, prepend=-1) != 0)
    rank = np.arange(len(ordered)) - np.repeat(starts, np.diff(starts, append=len(ordered)))
    return [order[rank == k] for k in range(int(rank.max(initial=-1)) + 1)]
