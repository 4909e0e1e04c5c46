"""Wires, ropes and thin tubes, drawn by the share of each pixel that they cover.

A wire of 12 mm is 0.4 px wide at 30 m: a few rays a pixel would make dots of it, others for each camera. Here
the strip between its outlines is cut by the pixel exactly. It is lit across its width, as a cylinder is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from vista_eval.render.fast import light
from vista_eval.render.fast.surfaces import Surfaces
from vista_eval.render.rig import Rig
from vista_eval.render.scene import Cylinder, Scene, Solid
from vista_eval.render.view import View

THICKEST_M = 0.06  # diameter of what is drawn in this way
STRIPS = 8  # across the width, each with its own light
NEAREST_M = 0.2
MARGIN_PX = 1.0  # beyond the outline, where a pixel may still be touched


def is_wire(solid: Solid) -> bool:
    return isinstance(solid, Cylinder) and 2 * solid.radius_m <= THICKEST_M


class Pieces(NamedTuple):
    """What each pixel shows of each wire; one pixel of one wire an entry."""

    pixel: np.ndarray  # v * width + u
    wire: np.ndarray
    depth_m: np.ndarray  # of its axis, along the optical axis
    across: np.ndarray  # of the pixel's middle, in radii to the right of the axis as it is drawn
    within: np.ndarray  # whether the middle lies between the ends
    cover: np.ndarray  # (n, STRIPS) share of the pixel

    def where(self, chosen: np.ndarray) -> Pieces:
        return Pieces(*(each[chosen] for each in self))


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
        solids = [(label, solid) for label, solid in parts if isinstance(solid, Cylinder)]
        self.label = np.array([label for label, _ in solids], np.int32)
        self.start_m = np.array([solid.start_m for _, solid in solids], float).reshape(-1, 3)
        self.end_m = np.array([solid.end_m for _, solid in solids], float).reshape(-1, 3)
        self.radius_m = np.array([solid.radius_m for _, solid in solids], float)
        self.albedo = np.array([np.mean(solid.albedo) for _, solid in solids], float)

    def in_camera(self, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Ends (n, 3) of each, the parts behind the camera cut off; NaN: all of it is."""
        ends = [(points - pose[:3, 3]) @ pose[:3, :3] for points in (self.start_m, self.end_m)]
        cut = []
        for here, there in (ends, ends[::-1]):
            with np.errstate(divide="ignore", invalid="ignore"):
                share = np.clip((NEAREST_M - here[:, 2]) / (there[:, 2] - here[:, 2]), 0, 1)
            behind = here[:, 2] < NEAREST_M
            point = np.where(behind[:, None], here + share[:, None] * (there - here), here)
            point[point[:, 2] < NEAREST_M - 1e-6] = np.nan
            cut.append(point)
        return cut[0], cut[1]

    def pieces(self, rig: Rig, pose: np.ndarray) -> Pieces:
        starts, ends = self.in_camera(pose)
        found = [
            piece(rig, k, start, end, self.radius_m[k])
            for k, (start, end) in enumerate(zip(starts, ends, strict=True))
            if np.all(np.isfinite(start)) and np.all(np.isfinite(end))
        ]
        if not found:
            none = np.zeros(0, int)
            return Pieces(none, none, none * 0.0, none * 0.0, none > 0, np.zeros((0, STRIPS)))
        return Pieces(*(np.concatenate(each) for each in zip(*found, strict=True)))

    def drawn(self, scene: Scene, groups: list[Surfaces], rig: Rig, pose: np.ndarray, view: View) -> Drawing:
        """Where nothing stands before them. view: without wires."""
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
        """With the wires that the pixels' middles show; pieces: the farthest first."""
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
    """(n,) 1 where the light reaches the wire, 0 where something else hides it."""
    start = (point_m + (radius_m[:, None] + light.OFF_SURFACE_M) * front).astype(np.float32)
    ray = np.ascontiguousarray(np.broadcast_to(towards.astype(np.float32), start.shape))
    hidden = [group.hides(start, ray) for group in groups]
    return 1.0 - np.any(hidden, axis=0)


def piece(rig: Rig, wire: int, start: np.ndarray, end: np.ndarray, radius_m: float) -> tuple[np.ndarray, ...]:
    """The fields of `Pieces` for one straight wire; start, end: in the camera."""
    ends_px = rig.project(np.stack([start, end]))
    length_px = float(np.linalg.norm(ends_px[1] - ends_px[0]))
    along = (ends_px[1] - ends_px[0]) / max(length_px, 1e-9)
    widest_px = rig.focal_px * radius_m / min(start[2], end[2])
    u, v = pixels_near(rig, ends_px, 2 * widest_px + MARGIN_PX)
    offset = np.stack([u, v], axis=1) - ends_px[0]
    t_px = offset @ along
    q_px = offset @ np.array([-along[1], along[0]])
    share = np.clip(t_px / max(length_px, 1e-9), 0, 1)
    depth_m = 1 / ((1 - share) / start[2] + share / end[2])
    half_px = half_width(rig, u, v, start, end, radius_m)
    ends = below(length_px - t_px, *np.abs(along)) - below(-t_px, *np.abs(along))
    edges = np.linspace(-1, 1, STRIPS + 1)
    limits = [below(half_px * edge - q_px, abs(float(along[1])), abs(float(along[0]))) for edge in edges]
    cover = np.diff(np.stack(limits, axis=1), axis=1) * ends[:, None]
    kept = cover.sum(axis=1) > 1e-6
    within = (t_px >= 0) & (t_px < length_px)
    fields = v * rig.width_px + u, np.full(len(u), wire), depth_m, q_px / half_px, within, cover
    return tuple(field[kept] for field in fields)


def pixels_near(rig: Rig, ends_px: np.ndarray, within_px: float) -> tuple[np.ndarray, np.ndarray]:
    """Columns and rows of all pixels that a segment comes near to, and of some others."""
    step = ends_px[1] - ends_px[0]
    major = int(np.argmax(np.abs(step)))
    size = (rig.width_px, rig.height_px)
    low, high = np.sort(ends_px[:, major])
    first = max(int(np.floor(low - within_px)), 0)
    last = min(int(np.ceil(high + within_px)), size[major] - 1)
    line = np.arange(first, last + 1)
    slope = step[1 - major] / step[major] if abs(step[major]) > 1e-9 else 0.0
    middle = ends_px[0, 1 - major] + slope * (np.clip(line, low, high) - ends_px[0, major])
    reach = int(np.ceil(within_px * np.hypot(1, slope))) + 1
    beside = np.rint(middle).astype(int)[:, None] + np.arange(-reach, reach + 1)
    line = np.repeat(line, beside.shape[1])
    beside = beside.ravel()
    inside = (beside >= 0) & (beside < size[1 - major])
    pair = line[inside], beside[inside]
    return pair if major == 0 else pair[::-1]


def half_width(
    rig: Rig, u: np.ndarray, v: np.ndarray, start: np.ndarray, end: np.ndarray, radius_m: float
) -> np.ndarray:
    """(n,) px from the axis to the outline, square to the axis as it is drawn. A ray along d passes a line
    through s along a at the distance d . (a x s) / |d x a|."""
    axis = (end - start) / np.linalg.norm(end - start)
    (cu, cv), focal = rig.center_px, rig.focal_px
    ray = np.stack([(u - cu) / focal, (v - cv) / focal, np.ones(len(u))], axis=1)
    turn = float(np.linalg.norm(np.cross(axis, start)[:2])) / focal
    return radius_m * np.linalg.norm(np.cross(ray, axis), axis=1) / max(turn, 1e-12)


def below(limit_px: np.ndarray, across: float, along: float) -> np.ndarray:
    """Share of a pixel where the distance to a line through its middle is below `limit_px`. across, along:
    sides of the line's unit normal, at least 0. The share of a square is a trapezoid's integral."""
    long, short = max(across, along), min(across, along)
    reach = (long + short) / 2
    x = np.clip(limit_px, -reach, reach)
    flat = (long - short) / 2
    ramp = np.clip(reach - np.abs(x), 0, short)
    corner = ramp**2 / (2 * long * short) if short > 1e-9 else np.zeros_like(x)
    linear = np.where(np.abs(x) <= flat, 0.5 + x / long, np.where(x > 0, 1 - corner, corner))
    return np.where(limit_px >= reach, 1.0, np.where(limit_px <= -reach, 0.0, linear))


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
