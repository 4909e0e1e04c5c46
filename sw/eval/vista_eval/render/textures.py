"""Procedural albedo maps, float32 in 0 to 1. Each depends only on its arguments."""

from __future__ import annotations

from functools import lru_cache, reduce

import cv2
import numpy as np

LATTICE = 256  # values per side; noise repeats after LATTICE wavelengths


def noise(x_m: np.ndarray, y_m: np.ndarray, wavelength_m: float, seed: int) -> np.ndarray:
    """Smooth noise in -0.5..0.5 over world coordinates, features about `wavelength_m` long.

    Fast for a grid given as a column `x_m` (N, 1) and a row `y_m` (1, M), or the other way round.
    """
    # A turn per octave keeps the lattices from lining up with the image rows.
    cos, sin = float(np.cos(seed)) / wavelength_m, float(np.sin(seed)) / wavelength_m
    column = np.mod(cos * x_m, LATTICE) - np.mod(sin * y_m, LATTICE)
    row = np.mod(sin * x_m, LATTICE) + np.mod(cos * y_m, LATTICE)
    column[column < 0] += LATTICE
    row[row >= LATTICE] -= LATTICE
    column, row = (index.astype(np.float32, copy=False) + 1 for index in (column, row))
    return cv2.remap(_lattice(seed), column, row, cv2.INTER_CUBIC)


@lru_cache(maxsize=32)
def _lattice(seed: int) -> np.ndarray:
    lattice = np.random.default_rng(seed).random((LATTICE, LATTICE), dtype=np.float32) - 0.5
    return np.asarray(cv2.copyMakeBorder(lattice, 0, 4, 0, 4, cv2.BORDER_WRAP), np.float32)


def smoothstep(low: float, high: float, value: np.ndarray) -> np.ndarray:
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def layered(x_m: np.ndarray, y_m: np.ndarray, amplitudes: dict[float, float], seed: int) -> np.ndarray:
    """Sum of noises; `amplitudes` maps wavelength in metres to amplitude."""
    noises = (a * noise(x_m, y_m, w, seed + i) for i, (w, a) in enumerate(amplitudes.items()))
    return reduce(np.add, noises)


def ground(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Albedo of a meadow with bare soil and a worn track, at world points."""
    grass = 0.22 + layered(
        x_m, y_m, {23.0: 0.08, 7.1: 0.08, 2.3: 0.09, 0.9: 0.13, 0.37: 0.17, 0.15: 0.15, 0.06: 0.12}, seed
    )
    soil = 0.33 + layered(x_m, y_m, {5.3: 0.06, 1.1: 0.07, 0.31: 0.10, 0.12: 0.08, 0.05: 0.08}, seed + 20)
    patches = layered(x_m, y_m, {11.0: 0.8, 3.1: 0.35, 0.7: 0.2}, seed + 40)
    across_m = np.abs(y_m - 7.0 - 0.16 * x_m - 3 * noise(x_m, y_m, 31.0, seed + 50))
    ragged_m = 0.5 * noise(x_m, y_m, 0.8, seed + 51)
    track = 1 - smoothstep(0.9, 1.5, across_m + ragged_m)
    bare = np.maximum(smoothstep(0.10, 0.28, patches), track)
    return np.clip(grass + bare * (soil - grass), 0.03, 0.9).astype(np.float32)


def bark(seed: int, size: int = 256) -> np.ndarray:
    """Furrows along the trunk."""
    y, x = np.mgrid[0:size, 0:size].astype(np.float32) / size
    furrows = layered(x * 3, y, {0.3: 0.10, 0.1: 0.16, 0.04: 0.12}, seed)
    return np.clip(0.16 + furrows, 0.03, 0.5).astype(np.float32)


def straw(seed: int, size: int = 256) -> np.ndarray:
    """Hay: fine streaks along the winding."""
    y, x = np.mgrid[0:size, 0:size].astype(np.float32) / size
    streaks = layered(x, y * 4, {0.3: 0.10, 0.09: 0.14, 0.03: 0.16}, seed)
    return np.clip(0.38 + streaks, 0.1, 0.8).astype(np.float32)


def paint(albedo: float, seed: int, size: int = 64) -> np.ndarray:
    """A painted surface with a little dirt."""
    y, x = np.mgrid[0:size, 0:size].astype(np.float32) / size
    return np.clip(albedo + layered(x, y, {0.5: 0.06, 0.13: 0.04}, seed), 0.01, 0.95).astype(np.float32)


def printed_sign(width_m: float, height_m: float, seed: int, texels_per_m: int = 250) -> np.ndarray:
    """White foamcore with a black frame and letters, row 0 on top."""
    width, height = round(width_m * texels_per_m), round(height_m * texels_per_m)
    board = cv2.resize(paint(0.80, seed), (width, height), interpolation=cv2.INTER_CUBIC)
    ink = np.zeros((height, width), np.uint8)
    edge = round(0.04 * height)
    cv2.rectangle(ink, (edge, edge), (width - 1 - edge, height - 1 - edge), 255, max(2, edge // 2))
    for line, text in enumerate(("VISTA", "TEST 1")):
        scale = 0.0122 * height
        (text_width, text_height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 12)
        origin = ((width - text_width) // 2, round(height * (0.32 + 0.42 * line)) + text_height // 2)
        cv2.putText(ink, text, origin, cv2.FONT_HERSHEY_SIMPLEX, scale, 255, 12, cv2.LINE_AA)
    return (board + (0.06 - board) * (ink / 255)).astype(np.float32)


def foamcore(albedo: float, seed: int, texels: tuple[int, int] = (230, 51)) -> np.ndarray:
    """Painted foamcore: brush marks, scuffs, a pale cut edge all round, strips of tape; row 0 on top."""
    rows, columns = texels
    y, x = np.mgrid[0:rows, 0:columns].astype(np.float32) / columns
    brushed = layered(x * 6, y, {0.5: 0.4, 0.17: 0.5, 0.06: 0.3}, seed)
    scuffs = smoothstep(0.30, 0.40, layered(x, y, {0.9: 0.5, 0.2: 0.5, 0.07: 0.3}, seed + 3))
    board = albedo * (1 + brushed) + 0.10 * scuffs
    tape = (np.mod(y, 1.5) < 0.09).astype(np.float32)
    board += 0.05 * tape
    edge = np.minimum.reduce([x * columns, y * columns, columns - 1 - x * columns, rows - 1 - y * columns])
    return np.clip(np.where(edge < 1, 0.35, board), 0.01, 0.9).astype(np.float32)


def tarpaulin(width_m: float, length_m: float, albedo: float, seed: int, texel_m: float = 0.02) -> np.ndarray:
    """Woven sheet with folds, seams and a hem; rows along its length."""
    y, x = np.mgrid[0 : round(length_m / texel_m), 0 : round(width_m / texel_m)].astype(np.float32) * texel_m
    folds = np.sin(2 * np.pi * (y + 0.25 * noise(x, y, 1.7, seed)) / 1.0) ** 8
    sheet = albedo * (1 + 0.5 * layered(x, y, {1.3: 0.5, 0.4: 0.5, 0.1: 0.35}, seed + 1) + 0.25 * folds)
    hem = (np.minimum(x, width_m - x) < 0.08) | (np.minimum(y, length_m - y) < 0.08)
    return cv2.GaussianBlur(
        np.clip(np.where(hem, 0.55 * sheet, sheet), 0.03, 0.9).astype(np.float32), (3, 3), 0.6
    )
