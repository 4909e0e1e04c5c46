"""Trees, bushes and hedges, with the foot at the origin. A dark core makes each crown opaque."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vista_eval.worlds.triangles import Points, Triangles, box, joined, lump, on_ellipsoid, tube, tufts

CORE_ALBEDO = 0.035


def leaf_albedo(count: int, mean: float, rng: np.random.Generator) -> np.ndarray:
    return np.clip(mean * rng.lognormal(0.0, 0.35, count), 0.02, 0.8)


def bark(points_m: Points, radii_m: np.ndarray, rng: np.random.Generator, sides: int = 8) -> Triangles:
    """A limb whose albedo changes every few centimetres along it and around it."""
    length = float(np.linalg.norm(points_m[-1] - points_m[0]))
    t, fine = np.linspace(0, 1, len(points_m)), np.linspace(0, 1, max(3, round(length / 0.12)))
    path = np.stack([np.interp(fine, t, column) for column in points_m.T], 1)
    limb = tube(path, np.interp(fine, t, radii_m), 0.14, sides)
    return limb._replace(albedo=np.clip(limb.albedo * rng.lognormal(0.0, 0.4, len(limb.albedo)), 0.03, 0.5))


def crown(
    centers_m: Points, radii_m: Points, tuft_m: float, mean_albedo: float, rng: np.random.Generator
) -> Triangles:
    """Clumps of leaves; `radii_m` (N, 3). About as many leaves as hide the cores."""
    parts = []
    for center, radii in zip(centers_m, radii_m, strict=True):
        surface = 4 * np.pi * float(np.mean(radii)) ** 2
        count = max(12, round(1.1 * surface / tuft_m**2))
        points = center + radii * on_ellipsoid(count, rng)
        shade = leaf_albedo(count, mean_albedo * rng.uniform(0.75, 1.25), rng)
        parts += [lump(center, 0.72 * radii, CORE_ALBEDO, 5, 7), tufts(points, tuft_m, shade, rng)]
    return joined(*parts)


def crown_clumps(
    height_m: float, spread_m: float, bare_m: float, rng: np.random.Generator
) -> tuple[Points, Points]:
    """Middles and radii (N, 3) of the clumps of a crown that begins `bare_m` above the ground."""
    half_height = (height_m - bare_m) / 2
    count = int(rng.integers(14, 22))
    radii = rng.uniform(0.26, 0.46, (count, 1)) * [spread_m, spread_m, 0.8 * half_height]
    reach = np.array([spread_m, spread_m, half_height]) - 0.6 * radii
    return [0.0, 0.0, bare_m + half_height] + on_ellipsoid(count, rng, 0.45) * reach, radii


def broadleaf(height_m: float, spread_m: float, rng: np.random.Generator, tuft_m: float = 0.2) -> Triangles:
    """Oak or lime: a bent trunk, a few limbs, clumps over a crown `spread_m` in radius."""
    bare = rng.uniform(0.18, 0.32) * height_m
    lean = rng.normal(0, 0.03, 2) * height_m
    top = np.array([*lean, 0.75 * height_m])
    trunk_radius = 0.018 * height_m + 0.04
    parts = [
        bark(np.array([[0, 0, 0], [*(0.3 * lean), bare], top]), np.array([1.3, 0.9, 0.3]) * trunk_radius, rng)
    ]
    centers, radii = crown_clumps(height_m, spread_m, bare, rng)
    centers[:, :2] += 0.7 * lean
    for limb in range(4):
        start = np.array([*(0.4 * lean), bare * rng.uniform(0.8, 1.3)])
        parts.append(bark(np.stack([start, centers[limb]]), np.array([0.5, 0.2]) * trunk_radius, rng, 6))
    return joined(*parts, crown(centers, radii, tuft_m, rng.uniform(0.22, 0.45), rng))


def poplar(height_m: float, spread_m: float, rng: np.random.Generator, tuft_m: float = 0.2) -> Triangles:
    """A column of leaves from close to the ground."""
    trunk = bark(np.array([[0, 0, 0], [0, 0, 0.8 * height_m]]), np.array([0.2, 0.05]), rng)
    count = max(5, round(height_m / 1.1))
    up = np.linspace(0.14, 0.94, count)
    width = spread_m * np.sin(np.pi * up**0.8) ** 0.6
    centers = np.stack([rng.normal(0, 0.12, count), rng.normal(0, 0.12, count), up * height_m], 1)
    radii = np.stack([width, width, np.full(count, 0.75 * height_m / count)], 1)
    return joined(trunk, crown(centers, radii, tuft_m, rng.uniform(0.2, 0.38), rng))


def conifer(height_m: float, spread_m: float, rng: np.random.Generator, tuft_m: float = 0.2) -> Triangles:
    """A spruce: tiers of drooping branches around a dark cone."""
    trunk = bark(np.array([[0, 0, 0], [0, 0, 0.97 * height_m]]), np.array([0.025, 0.004]) * height_m, rng)
    bare, shade = rng.uniform(0.04, 0.14), rng.uniform(0.13, 0.28)
    core = tube([[0, 0, bare * height_m], [0, 0, 0.95 * height_m]], [0.4 * spread_m, 0.02], CORE_ALBEDO, 9)
    parts = [trunk, core]
    tiers = max(7, round(height_m / 0.75))
    for up in np.linspace(bare, 0.97, tiers):
        width = spread_m * (1.02 - up) / (1.02 - bare) * rng.uniform(0.85, 1.1)
        count = max(10, round(2.0 * np.pi * (width + 0.15) ** 2 / tuft_m**2))
        reach = width * np.sqrt(rng.uniform(0.1, 1.0, count))
        turn = rng.uniform(0, 2 * np.pi, count)
        reach *= 1 + 0.16 * np.sin(7 * turn + rng.uniform(0, 6))
        z = up * height_m - 0.45 * reach + rng.normal(0, 0.08, count)
        points = np.stack([reach * np.cos(turn), reach * np.sin(turn), np.maximum(z, 0.1)], 1)
        parts.append(tufts(points, tuft_m, leaf_albedo(count, shade, rng), rng, droop=0.5))
    return joined(*parts)


def bare_tree(height_m: float, spread_m: float, rng: np.random.Generator, tuft_m: float = 0.2) -> Triangles:
    """A tree without leaves: limbs that part in two, five times."""
    parts: list[Triangles] = []

    def grow(foot: Points, direction: Points, length: float, radius: float, left: int) -> None:
        tip = foot + length * direction
        if radius > 0.03:
            parts.append(bark(np.stack([foot, tip]), np.array([radius, 0.7 * radius]), rng, 6))
        else:
            parts.append(tube([foot, tip], [radius, 0.6 * radius], rng.uniform(0.08, 0.2), 4, closed=False))
        for _ in range(3 if left < 3 else 2):
            if left == 0:
                return
            turned = direction + rng.normal(0, 0.42, 3) * [1, 1, 0.6] + [0, 0, 0.12]
            start = foot + rng.uniform(0.6, 1.0) * (tip - foot)
            grow(start, turned / np.linalg.norm(turned), 0.72 * length, 0.62 * radius, left - 1)

    grow(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.3 * height_m, 0.022 * height_m, 5)
    return joined(*parts)


def bush(height_m: float, spread_m: float, rng: np.random.Generator, tuft_m: float = 0.12) -> Triangles:
    count = int(rng.integers(4, 8))
    radii = rng.uniform(0.45, 0.7, (count, 1)) * [spread_m, spread_m, 0.5 * height_m]
    centers = rng.uniform(-0.5, 0.5, (count, 3)) * [spread_m, spread_m, 0.0]
    centers[:, 2] = np.minimum(rng.uniform(0.1, 0.7, count) * height_m, height_m - 0.85 * radii[:, 2])
    centers[0, 2] = 0.5 * radii[0, 2]  # down to the ground
    leaves = crown(centers, radii, tuft_m, rng.uniform(0.2, 0.45), rng)
    above = np.maximum(leaves.vertices_m, [-np.inf, -np.inf, 0.02])
    return leaves._replace(vertices_m=above)


def hedge(length_m: float, height_m: float, rng: np.random.Generator, depth_m: float = 0.8) -> Triangles:
    """A hedge along y, trimmed to a box."""
    size = np.array([depth_m, length_m, height_m])
    core = box((0, 0, height_m / 2 - 0.04), size - [0.16, 0.1, 0.08], CORE_ALBEDO)
    areas = np.array([size[1] * size[2], size[0] * size[1], size[0] * size[2]])
    faces = []
    for axis, area in zip((0, 2, 1), areas, strict=True):
        points = rng.uniform(-0.5, 0.5, (round(2 * 90 * area), 3)) * size
        points[:, axis] = rng.choice([-0.5, 0.5], len(points)) * size[axis] + rng.normal(0, 0.05, len(points))
        faces.append(points + np.array([0, 0, height_m / 2]))
    points = np.concatenate(faces)
    points[:, 2] = np.maximum(points[:, 2], 0.03)
    return joined(core, tufts(points, 0.12, leaf_albedo(len(points), 0.28, rng), rng))


TREES: dict[str, Callable[..., Triangles]] = {
    "broadleaf": broadleaf,
    "conifer": conifer,
    "poplar": poplar,
    "bare": bare_tree,
}
