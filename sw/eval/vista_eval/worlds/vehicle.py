"""Cars, vans and a drone: forward is +x, wheels are on z = 0 (for the drone, its middle is the origin)."""

from __future__ import annotations

import numpy as np

from vista_eval.worlds.triangles import Triangles, box, joined, prism, tube

TYRE, RIM, RUBBER, LAMP, NUMBER_PLATE = 0.03, 0.45, 0.05, 0.75, 0.7


def profile(points_xz: list[tuple[float, float]], width_m: float, albedo: float) -> Triangles:
    """A side view (x, z) drawn across the vehicle."""
    outline = [(x, -width_m / 2, z) for x, z in points_xz]
    return prism(outline, (0, width_m, 0), albedo)


def reflecting(shape: Triangles, low: float, high: float) -> Triangles:
    """Glass and paint mirror ground below and sky above."""
    z = shape.vertices_m[:, 2]
    t = (z - z.min()) / np.ptp(z)
    return shape._replace(albedo=low + (high - low) * t**2)


def wheels(axles_x_m: tuple[float, float], track_m: float, radius_m: float) -> Triangles:
    parts = []
    for x in axles_x_m:
        for side in (-1, 1):
            y = side * track_m / 2
            parts.append(tube([(x, y - 0.11, radius_m), (x, y + 0.11, radius_m)], radius_m, TYRE, 14))
            rim = [(x, y + side * 0.10, radius_m), (x, y + side * 0.125, radius_m)]
            parts.append(tube(rim, 0.6 * radius_m, RIM, 8))
    return joined(*parts)


def ends(front_x_m: float, rear_x_m: float, width_m: float, lamp_z_m: float) -> Triangles:
    """Lamps, number plates and bumpers on both faces."""
    parts = []
    for x in (front_x_m, rear_x_m):
        parts.append(box((x, 0, 0.5), (0.06, 0.52, 0.11), NUMBER_PLATE))
        parts.append(box((x, 0, 0.33), (0.10, 0.96 * width_m, 0.16), RUBBER))
        lamp = LAMP if x > 0 else 0.22
        parts += [box((x, s * 0.38 * width_m, lamp_z_m), (0.05, 0.3, 0.15), lamp) for s in (-1, 1)]
    return joined(*parts)


def seams(xs_m: tuple[float, ...], low_m: float, high_m: float, width_m: float, albedo: float) -> Triangles:
    """Door gaps on both sides."""
    height = high_m - low_m
    return joined(
        *(
            box((x, s * width_m / 2, low_m + height / 2), (0.03, 0.012, height), albedo)
            for x in xs_m
            for s in (-1, 1)
        )
    )


def car(paint: float, rng: np.random.Generator) -> Triangles:
    """A saloon or hatchback, 4.1 to 4.7 m long."""
    length, width = rng.uniform(4.1, 4.7), rng.uniform(1.7, 1.85)
    half, tail = length / 2, rng.uniform(0.0, 0.7)
    body = [(-half, 0.3), (half, 0.3), (half, 0.62), (half - 0.9, 0.82), (-half + 0.05, 0.9)]
    cabin = [
        (half - 1.05, 0.82),
        (half - 1.75, 1.38),
        (-half + 0.45 + tail, 1.4),
        (-half + 0.12 + tail, 0.88),
    ]
    roof = [(half - 1.7, 1.36), (half - 1.9, 1.45), (-half + 0.75 + tail, 1.47), (-half + 0.45 + tail, 1.38)]
    pillars = [
        profile([(x - 0.05, 0.85), (x + 0.05, 0.85), (x, 1.4), (x - 0.08, 1.4)], width - 0.17, paint)
        for x in (half - 2.2, half - 2.9)
    ]
    return joined(
        reflecting(profile(body, width, paint), 0.55 * paint, min(1.2 * paint, 0.9)),
        reflecting(profile(cabin, width - 0.2, 0.05), 0.03, rng.uniform(0.08, 0.3)),
        profile(roof, width - 0.24, paint),
        *pillars,
        seams((half - 1.75, half - 2.75, -half + 1.1), 0.4, 0.86, width, 0.4 * paint),
        wheels((half - 0.85, -half + 0.8), width - 0.2, 0.32),
        ends(half, -half, width, 0.68),
    )


def van(paint: float, rng: np.random.Generator) -> Triangles:
    """A delivery van, 5.4 m long and 2.4 m high, with a band along its side."""
    length, width, height = rng.uniform(5.2, 5.9), 2.0, rng.uniform(2.2, 2.6)
    half = length / 2
    body = [
        (-half, 0.35),
        (half, 0.35),
        (half, 0.95),
        (half - 0.85, 1.2),
        (half - 1.5, height),
        (-half, height),
    ]
    screen = [
        (half - 0.82, 1.25),
        (half - 1.42, height - 0.12),
        (half - 1.46, height - 0.12),
        (half - 0.88, 1.25),
    ]
    side_glass = [
        (half - 1.1, 1.25),
        (half - 1.5, height - 0.35),
        (half - 2.1, height - 0.35),
        (half - 2.1, 1.25),
    ]
    rear = [box((-half, s * 0.48, height - 0.65), (0.02, 0.7, 0.55), 0.06) for s in (-1, 1)]
    band = rng.uniform(0.05, 0.8)
    return joined(
        reflecting(profile(body, width, paint), 0.6 * paint, paint),
        reflecting(profile(screen, width - 0.2, 0.06), 0.04, 0.3),
        reflecting(profile(side_glass, width + 0.02, 0.06), 0.04, 0.2),
        box((-0.6, 0, 1.35), (length - 2.6, width + 0.015, 0.3), band),
        box((-1.1, 0, 1.75), (1.4, width + 0.015, 0.22), 0.3 * band),
        *rear,
        seams((half - 1.05, half - 2.15, -0.9), 0.5, height - 0.2, width, 0.3 * paint),
        wheels((half - 0.95, -half + 1.0), width - 0.2, 0.35),
        ends(half, -half, width, 0.85),
    )


def drone(rng: np.random.Generator) -> Triangles:
    """A delivery drone, 1.3 m across: a striped box under four arms."""
    parts = [box((0, 0, -0.1), (0.7, 0.7, 0.5), 0.55), box((0, 0, -0.1), (0.72, 0.72, 0.12), 0.06)]
    for turn in np.radians([45, 135, 225, 315]):
        tip = 0.62 * np.array([np.cos(turn), np.sin(turn), 0.0])
        tip[2] = 0.22
        parts.append(tube([np.array([0, 0, 0.2]), tip], 0.03, 0.08, 6))
        parts.append(tube([tip, tip + np.array([0, 0, 0.02])], 0.24, rng.uniform(0.15, 0.3), 14))
        parts.append(tube([0.6 * tip + [0, 0, -0.4], 0.6 * tip], 0.02, 0.1, 5))
    return joined(*parts)
