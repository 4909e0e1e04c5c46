"""Things that stand in fields and yards: fences, walls, crates, people."""

from __future__ import annotations

import numpy as np

from vista_eval.worlds.triangles import Triangles, box, joined, lump, prism, tube


def weathered(shape: Triangles, rng: np.random.Generator, spread: float = 0.12) -> Triangles:
    """Each corner a little lighter or darker, as old wood is."""
    return shape._replace(
        albedo=np.clip(shape.albedo * rng.lognormal(0, spread, len(shape.albedo)), 0.02, 0.9)
    )


def picket_fence(
    length_m: float, height_m: float, pitch_m: float, rng: np.random.Generator, albedo: float = 0.6
) -> Triangles:
    """Pointed pickets along y with two rails behind them and posts every 2.4 m."""
    wide = 0.6 * pitch_m
    shade = np.clip(albedo * rng.lognormal(0, 0.08, 4), 0.05, 0.85)
    parts = []
    for k, y in enumerate(np.arange(-length_m / 2, length_m / 2, pitch_m)):
        top = height_m + rng.normal(0, 0.008)
        outline = [
            (0, y - wide / 2, 0.06),
            (0, y + wide / 2, 0.06),
            (0, y + wide / 2, top - 0.09),
            (0, y, top),
            (0, y - wide / 2, top - 0.09),
        ]
        parts.append(prism(outline, (0.02, 0, 0), shade[k % 4]))
    for z in (0.25 * height_m, 0.75 * height_m):
        parts.append(box((0.045, 0, z), (0.05, length_m, 0.09), 0.85 * albedo))
    for y in np.arange(-length_m / 2, length_m / 2, 2.4):
        parts.append(box((0.09, y, 0.5 * height_m), (0.09, 0.09, height_m), 0.8 * albedo))
    return weathered(joined(*parts), rng)


def rail_fence(length_m: float, height_m: float, rng: np.random.Generator) -> Triangles:
    """Round posts every 2.5 m and three rails along y: a paddock."""
    parts = []
    for y in np.arange(-length_m / 2, length_m / 2 + 0.1, 2.5):
        lean = rng.normal(0, 0.02, 2) * height_m
        parts.append(tube([(0, y, 0), (lean[0], y + lean[1], height_m)], 0.06, rng.uniform(0.15, 0.35), 8))
    for z in np.array([0.35, 0.65, 0.95]) * height_m:
        for y in np.arange(-length_m / 2, length_m / 2 - 2.4, 2.5):
            ends = [(-0.06, y, z + rng.normal(0, 0.03)), (-0.06, y + 2.5, z + rng.normal(0, 0.03))]
            parts.append(tube(ends, 0.04, rng.uniform(0.2, 0.45), 6))
    return weathered(joined(*parts), rng)


def crates(rng: np.random.Generator) -> Triangles:
    """A stack of one to five slatted boxes on the ground."""
    parts = []
    for level in range(int(rng.integers(1, 4))):
        for y in np.arange(2 if level == 0 else 1) * 1.15:
            side, z = 1.05, level * 1.0
            shade = rng.uniform(0.25, 0.5)
            parts.append(box((0, y, z + 0.5), (side, side, 0.98), 0.4 * shade))
            for slat in np.linspace(0.08, 0.9, 5):
                parts.append(
                    box((0, y, z + slat), (side + 0.04, side + 0.04, 0.13), shade * rng.uniform(0.8, 1.2))
                )
            for x, w in ((-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)):
                parts.append(box((1.06 * x, y + 1.06 * w, z + 0.49), (0.1, 0.1, 0.97), shade))
    return weathered(joined(*parts), rng)


def person(rng: np.random.Generator) -> Triangles:
    """1.55 to 1.9 m tall, standing."""
    height = rng.uniform(1.55, 1.9)
    skin, shirt, trousers = rng.uniform(0.2, 0.5), rng.uniform(0.05, 0.75), rng.uniform(0.04, 0.4)
    stride = rng.uniform(0.05, 0.25)
    parts = [
        lump((0, 0, 0.935 * height), (0.10, 0.085, 0.125), skin),
        lump((0, 0, 0.97 * height), (0.105, 0.09, 0.07), rng.uniform(0.03, 0.3)),
        tube(
            [(0, 0, 0.5 * height), (0, 0, 0.66 * height), (0, 0, 0.85 * height)], [0.16, 0.2, 0.12], shirt, 9
        ),
    ]
    for side in (-1, 1):
        hip, foot = (0, side * 0.09, 0.52 * height), (side * stride, side * 0.1, 0.03)
        parts.append(tube([hip, foot], [0.095, 0.06], trousers, 8))
        parts.append(box((side * stride + 0.05, side * 0.1, 0.04), (0.27, 0.1, 0.08), 0.04))
        hand = (-side * stride, side * 0.28, 0.46 * height)
        parts.append(tube([(0, side * 0.21, 0.81 * height), hand], [0.06, 0.04], shirt, 7))
    return weathered(joined(*parts), rng, 0.2)
