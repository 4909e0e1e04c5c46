"""Things that stand in streets: facades, lamp posts, posts, the gantry and its wire."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np

from vista_eval.render.textures import layered, smoothstep
from vista_eval.worlds.rods import Rods, all_of, rods
from vista_eval.worlds.triangles import Triangles, box, joined, tube

FLOOR_M = 3.1
TEXEL_M = 0.02
BRICK_TEXEL_M = 0.03  # coarser ones would alias the joints


class FacadeStyle(NamedTuple):
    window_pitch_m: float
    window_m: tuple[float, float]  # width, height
    wall: float  # albedo
    frame: float
    bricks: bool
    grain: float  # 0: smooth plaster; 1: rough, stained
    variety: float  # 0: every window alike; 1: curtains, blinds and open ones at random


def any_style(rng: np.random.Generator) -> FacadeStyle:
    pitch = rng.uniform(2.2, 3.8)
    return FacadeStyle(
        window_pitch_m=pitch,
        window_m=(pitch * rng.uniform(0.35, 0.6), rng.uniform(1.2, 1.9)),
        wall=rng.uniform(0.2, 0.65),
        frame=rng.uniform(0.05, 0.8),
        bricks=rng.random() < 0.4,
        grain=rng.uniform(0.15, 1.0),
        variety=rng.uniform(0, 1),
    )


def wall_texture(
    width_m: float,
    height_m: float,
    albedo: float,
    bricks: bool,
    grain: float,
    seed: int,
    texel_m: float = TEXEL_M,
) -> np.ndarray:
    """Plaster with grain, streaks and damp at the foot, or courses of brick; row 0 on top."""
    rows, columns = round(height_m / texel_m), round(width_m / texel_m)
    z = (rows - np.arange(rows, dtype=np.float32))[:, None] * texel_m
    y = np.arange(columns, dtype=np.float32)[None, :] * texel_m
    rough = layered(y, z, {3.7: 0.10, 1.1: 0.07, 0.35: 0.07, 0.12: 0.09, 0.05: 0.09}, seed)
    streaks = 0.25 * layered(y, z / 14, {0.5: 0.5, 0.17: 0.3}, seed + 9) * smoothstep(0, 6, z)
    damp = -0.35 * (1 - smoothstep(0.2, 0.9, z + layered(y, z, {1.3: 0.8, 0.3: 0.4}, seed + 5)))
    wall = albedo * (1 + grain * (1.6 * rough + streaks) + damp)
    if bricks and texel_m <= BRICK_TEXEL_M:
        course = np.floor(z / 0.0833).astype(int)
        joint = (np.mod(z, 0.0833) < 0.013) | (np.mod(y + 0.125 * (course % 2), 0.25) < 0.013)
        brick = np.floor((y + 0.125 * (course % 2)) / 0.25).astype(int)
        shades = np.random.default_rng(seed).normal(1.0, 0.04 + 0.12 * grain, 4096)
        wall = np.where(joint, 1.25 * albedo, wall * shades[(course * 191 + brick * 7) % 4096])
    return np.clip(wall, 0.03, 0.85).astype(np.float32)


def pane(style: FacadeStyle, rng: np.random.Generator, plain: np.ndarray) -> np.ndarray:
    """One window: dark glass with a slanted reflection, cross bars, perhaps a curtain or a blind."""
    glass = plain.copy()
    rows, columns = glass.shape
    if rng.random() < style.variety:
        match rng.integers(4):
            case 0:  # curtains on both sides
                part = round(columns * rng.uniform(0.15, 0.4))
                fold = 0.45 + 0.12 * np.sin(np.arange(part) * 0.9)
                glass[:, :part], glass[:, columns - part :] = fold, fold[::-1]
            case 1:  # blind
                glass[: round(rows * rng.uniform(0.2, 0.9))] = 0.5 + 0.06 * (np.arange(columns) % 2)
            case 2:
                glass[:] *= rng.uniform(0.4, 2.2)
            case _:
                glass[round(rows * 0.6) :] += rng.uniform(0.0, 0.2)
    return glass


def facade_texture(
    width_m: float, height_m: float, style: FacadeStyle, seed: int, texel_m: float = TEXEL_M
) -> np.ndarray:
    """Windows `window_pitch_m` apart on every floor, doors on the lowest; row 0 on top, `texel_m` a texel."""
    rng = np.random.default_rng(seed)
    wall = wall_texture(width_m, height_m, style.wall, style.bricks, style.grain, seed, texel_m=texel_m)
    rows, columns = wall.shape
    wide, high = (round(side / texel_m) for side in style.window_m)
    t = np.add.outer(np.linspace(0, 1, high), np.linspace(0, 0.7, wide))
    mirrored = 0.05 + 0.16 * smoothstep(0.7, 0.78, t) * (1 - smoothstep(1.0, 1.3, t))
    bar = max(1, round(0.06 / texel_m))
    for floor in range(int(height_m / FLOOR_M)):
        sill = floor * FLOOR_M + 0.9
        bottom = rows - round(sill / texel_m)
        if bottom - high < 8:
            break
        for middle in np.arange(
            style.window_pitch_m / 2, width_m - style.window_m[0] / 2, style.window_pitch_m
        ):
            left = round((middle - style.window_m[0] / 2) / texel_m)
            if left < bar + 3 or left + wide + bar + 3 > columns:
                continue
            top, end = bottom - high, bottom
            if floor == 0 and rng.random() < 0.15 * style.variety:  # a door
                top, end = rows - round(2.2 / texel_m), rows
                wall[top:end, left : left + wide] = rng.uniform(0.08, 0.3)
                continue
            wall[top - bar : end + bar, left - bar : left + wide + bar] = style.frame
            glass = pane(style, rng, mirrored)
            glass[:, wide // 2 - bar // 2 : wide // 2 + bar - bar // 2] = style.frame
            glass[high // 3 : high // 3 + bar - 1] = style.frame
            wall[top:end, left : left + wide] = glass
            wall[top - bar - 3 : top - bar, left - bar : left + wide + bar] *= 0.45  # shadow of the lintel
            wall[end + bar : end + 2 * bar, left - 2 : left + wide + 2] = min(1.3 * style.wall, 0.8)  # sill
            wall[end + 2 * bar : end + 4 * bar, left - 2 : left + wide + 2] *= 0.6
    cornice = round(0.35 / texel_m)
    wall[:cornice] = np.clip(wall[:cornice] * 1.25, 0, 0.85)
    wall[cornice : cornice + 5] *= 0.4
    return cv2.GaussianBlur(wall, (3, 3), 0.6)


def balconies(width_m: float, height_m: float, pitch_m: float, rng: np.random.Generator) -> Triangles:
    """Slabs and railings 1 m before a wall in the plane x = 0, from y = 0 to `width_m`."""
    parts = []
    shade = rng.uniform(0.3, 0.6)
    for floor in range(1, int(height_m / FLOOR_M)):
        for middle in np.arange(pitch_m / 2, width_m - 1, 2 * pitch_m):
            z = floor * FLOOR_M
            parts.append(box((-0.5, middle, z), (1.0, 2.2, 0.15), shade))
            parts.append(box((-0.97, middle, z + 1.0), (0.05, 2.2, 0.06), 0.1))
            bars = middle + np.linspace(-1.05, 1.05, 12)
            parts += [box((-0.97, bar, z + 0.5), (0.03, 0.03, 1.0), 0.12) for bar in bars]
    return joined(*parts)


def lamp_post(height_m: float, rng: np.random.Generator) -> Triangles:
    """A tapered mast with an arm and a lantern."""
    shade = rng.uniform(0.1, 0.5)
    arm = rng.uniform(0.8, 1.6)
    mast = tube([(0, 0, 0), (0, 0, 0.9), (0, 0, 1.0), (0, 0, height_m)], [0.10, 0.10, 0.07, 0.045], shade)
    bough = tube([(0, 0, height_m - 0.05), (0, arm, height_m + 0.15)], 0.035, shade, 6)
    return joined(mast, bough, box((0, arm + 0.2, height_m + 0.13), (0.25, 0.6, 0.14), 0.6))


def banded_post(height_m: float, radius_m: float, low: float, high: float, band_m: float) -> Triangles:
    """A round post whose paint changes every `band_m`."""
    edges = np.arange(0, height_m, band_m)
    parts = []
    for k, z in enumerate(edges):
        ends = [(0, 0, z), (0, 0, min(z + band_m, height_m))]
        parts.append(tube(ends, radius_m, high if k % 2 else low, 12))
    return joined(*parts)


def gantry(span_m: float, height_m: float, wire_sag_m: float = 1.0) -> Rods:
    """Two lattice towers along y, `span_m` apart, with a wire from top to top."""
    legs, across, step = [], [], 1.5
    for y in (-span_m / 2, span_m / 2):
        a, b, c, d = ((sx * 0.5, y + sy * 0.5) for sx in (-1, 1) for sy in (-1, 1))
        legs += [[(*leg, 0), (*leg, height_m)] for leg in (a, b, c, d)]
        for z in np.arange(0, height_m - step, step):
            across += [[(*low, z), (*high, z + step)] for low, high in ((a, b), (c, d), (a, c), (b, d))]
    t = np.linspace(-1, 1, 25)
    wire = np.stack([0 * t, t * span_m / 2, height_m - wire_sag_m * (1 - t**2)], 1)
    spans = np.stack([wire[:-1], wire[1:]], axis=1)
    return all_of(rods(legs, 0.06, 0.3), rods(across, 0.03, 0.28), rods(spans, 0.012, 0.1))
