"""Triangles with an albedo at each vertex, of which the things of a scene are built.

Lengths in metres, world axes (z up); every function gives new triangles, none changes its arguments."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]


class Triangles(NamedTuple):
    vertices_m: Points  # (N, 3)
    faces: NDArray[np.int64]  # (M, 3), indices into the vertices
    albedo: NDArray[np.float64]  # (N,), 0..1


def joined(*parts: Triangles) -> Triangles:
    first = np.cumsum([0, *(len(part.vertices_m) for part in parts[:-1])])
    return Triangles(
        np.concatenate([part.vertices_m for part in parts]),
        np.concatenate([part.faces + k for part, k in zip(parts, first, strict=True)]),
        np.concatenate([part.albedo for part in parts]),
    )


def placed(shape: Triangles, foot_m: ArrayLike, yaw_deg: float = 0.0, scale: float = 1.0) -> Triangles:
    """Scaled, turned about z from x towards y, then moved by `foot_m`."""
    return shape._replace(vertices_m=turned(scale * shape.vertices_m, yaw_deg) + np.asarray(foot_m, float))


def turned(points_m: np.ndarray, yaw_deg: float) -> Points:
    """(N, 3) about z, from x towards y."""
    cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(points_m @ turn.T, np.float64)


def polygon(corners_m: ArrayLike, albedo: float) -> Triangles:
    """A flat convex polygon, (K, 3)."""
    corners = np.asarray(corners_m, float)
    k = np.arange(1, len(corners) - 1)
    return Triangles(corners, np.stack([0 * k, k, k + 1], 1), np.full(len(corners), albedo))


def prism(outline_m: ArrayLike, along_m: ArrayLike, albedo: float) -> Triangles:
    """A convex outline (K, 3) drawn along a vector, closed at both ends; faces share no vertices."""
    near = np.asarray(outline_m, float)
    far = near + np.asarray(along_m, float)
    sides = [polygon(np.stack([near[k - 1], near[k], far[k], far[k - 1]]), albedo) for k in range(len(near))]
    return joined(polygon(near, albedo), polygon(far, albedo), *sides)


def box(center_m: ArrayLike, size_m: ArrayLike, albedo: float) -> Triangles:
    (x, y, z), (sx, sy, sz) = np.asarray(center_m, float), np.asarray(size_m, float) / 2
    outline = [
        (x - sx, y - sy, z - sz),
        (x - sx, y + sy, z - sz),
        (x - sx, y + sy, z + sz),
        (x - sx, y - sy, z + sz),
    ]
    return prism(outline, (2 * sx, 0, 0), albedo)


def across(direction: Points) -> tuple[Points, Points]:
    """Two unit vectors square to a direction and to each other."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    first = np.cross(direction, helper)
    first /= np.linalg.norm(first)
    return first, np.cross(direction / np.linalg.norm(direction), first)


def tube(
    points_m: ArrayLike, radii_m: ArrayLike, albedo: ArrayLike, sides: int = 10, closed: bool = True
) -> Triangles:
    """A round limb through points (K, 3) with a radius at each; `albedo` a number or one for each point."""
    points = np.asarray(points_m, float)
    radii = np.broadcast_to(np.asarray(radii_m, float), len(points))
    albedos = np.broadcast_to(np.asarray(albedo, float), len(points))
    first, second = across(points[-1] - points[0])
    turn = np.arange(sides) * 2 * np.pi / sides
    ring = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second
    vertices = (points[:, None] + radii[:, None, None] * ring).reshape(-1, 3)
    k, s = (grid.ravel() for grid in np.mgrid[: len(points) - 1, :sides])
    a, b = k * sides + s, k * sides + (s + 1) % sides
    faces = np.concatenate([np.stack([a, b, b + sides], 1), np.stack([a, b + sides, a + sides], 1)])
    hull = Triangles(vertices, faces, np.repeat(albedos, sides))
    if not closed:
        return hull
    ends = [polygon(points[end] + radii[end] * ring, albedos[end]) for end in (0, -1)]
    return joined(hull, *ends)


def lump(center_m: ArrayLike, radii_m: ArrayLike, albedo: float, rings: int = 6, sides: int = 9) -> Triangles:
    """An ellipsoid with axes along x, y, z."""
    up = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    spine = np.stack([0 * up, 0 * up, np.sin(up)], 1)
    shape = tube(spine, np.maximum(np.cos(up), 1e-3), albedo, sides, closed=False)
    return shape._replace(
        vertices_m=shape.vertices_m * np.asarray(radii_m, float) + np.asarray(center_m, float)
    )


def tufts(
    centers_m: Points, size_m: float, albedo: ArrayLike, rng: np.random.Generator, droop: float = 0.0
) -> Triangles:
    """A randomly turned triangle about `size_m` across at each centre (N, 3): leaves, needles, grass.

    `droop` 0 turns them any way; towards 1 they hang upright, which catches less light from above."""
    count = len(centers_m)
    first = rng.standard_normal((count, 3))
    second = rng.standard_normal((count, 3)) * [1, 1, 1 - droop]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second -= np.sum(first * second, axis=1, keepdims=True) * first
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    half = 0.6 * size_m * rng.uniform(0.6, 1.3, (count, 1))
    corners = np.stack([first, -0.5 * first + 0.87 * second, -0.5 * first - 0.87 * second], 1)
    vertices = (centers_m[:, None] + half[:, None] * corners).reshape(-1, 3)
    shade = np.broadcast_to(np.asarray(albedo, float), count)
    return Triangles(vertices, np.arange(3 * count).reshape(-1, 3), np.repeat(shade, 3))


def on_ellipsoid(count: int, rng: np.random.Generator, inner: float = 0.7) -> Points:
    """Random points (count, 3) between `inner` and 1 times the unit sphere."""
    points = rng.standard_normal((count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points * rng.uniform(inner, 1.0, (count, 1))
