"""Periodic tiles of which surfaces are made, and how they are laid over a surface.

A tile is float32 with mean 0 and standard deviation 1, the same on opposite edges. Where texels of the
surface are coarser than its own, the tile is averaged first: from afar fine grain turns into an even grey.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

Tile = NDArray[np.float32]

SIZE = 512


def _standard(tile: np.ndarray) -> Tile:
    spread = float(tile.std())
    return ((tile - tile.mean()) / (spread if spread > 0 else 1.0)).astype(np.float32)


@lru_cache(maxsize=48)
def cloudy(seed: int, slope: float = 1.0, stretch: float = 1.0) -> Tile:
    """Noise whose amplitude falls with frequency to the power of -slope; `stretch` > 1: longer along rows."""
    rng, falling = np.random.default_rng(seed), _falling(slope, stretch)
    phases = np.exp(2j * np.pi * rng.random(falling.shape))
    amplitude = np.abs(rng.standard_normal(falling.shape)) * falling
    return _standard(np.fft.irfft2(amplitude * phases, (SIZE, SIZE)))


@lru_cache(maxsize=16)
def _falling(slope: float, stretch: float) -> np.ndarray:
    fu, fv = np.fft.rfftfreq(SIZE)[None, :], np.fft.fftfreq(SIZE)[:, None]
    amplitude = np.asarray(np.maximum(np.hypot(fu * stretch, fv), 2 / SIZE) ** -slope)
    amplitude[0, 0] = 0.0
    return amplitude


@lru_cache(maxsize=48)
def stones(seed: int, count: int = 400, joint_texels: float = 3.0) -> Tile:
    """Cells of random shades, darker towards their joints: cobbles, scree, dry mud, ashlar."""
    rng = np.random.default_rng(seed)
    margin = SIZE // 4
    middles = rng.integers(0, SIZE, (count, 2))
    free = np.full((SIZE, SIZE), 255, np.uint8)
    free[middles[:, 0], middles[:, 1]] = 0
    wrapped = cv2.copyMakeBorder(free, margin, margin, margin, margin, cv2.BORDER_WRAP)
    _, label = cv2.distanceTransformWithLabels(wrapped, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    edge = np.zeros(label.shape, np.uint8)
    edge[:, 1:] |= (label[:, 1:] != label[:, :-1]).astype(np.uint8)
    edge[1:] |= (label[1:] != label[:-1]).astype(np.uint8)
    depth = cv2.distanceTransform(1 - edge, cv2.DIST_L2, 5)
    # Copies of one cell beyond the edge carry other labels: the shade follows from the place of the middle.
    v, u = np.nonzero(wrapped == 0)
    place = (v - margin) % SIZE * SIZE + (u - margin) % SIZE
    shade_of = np.zeros(int(label.max()) + 1)
    shade_of[label[v, u]] = np.random.default_rng(seed + 1).standard_normal(SIZE * SIZE)[place]
    dome = np.minimum(depth / (2 * joint_texels), 1.0) - 1.0
    inner = slice(margin, margin + SIZE)
    return _standard((shade_of[label] + 2.2 * dome)[inner, inner])


@lru_cache(maxsize=48)
def litter(seed: int, count: int = 2500, size_texels: float = 7.0, slim: float = 0.45) -> Tile:
    """Flakes that lie over each other: leaves, chips, straw (slim), gravel (slim = 1)."""
    rng = np.random.default_rng(seed)
    margin = int(3 * size_texels) + 1
    canvas = np.zeros((SIZE + 2 * margin, SIZE + 2 * margin), np.float32)
    for _ in range(count):
        u, v = rng.uniform(0, SIZE, 2)
        half = size_texels * rng.uniform(0.5, 1.4)
        turn, shade = rng.uniform(0, 180), float(rng.standard_normal())
        for du in (-SIZE, 0, SIZE):
            for dv in (-SIZE, 0, SIZE):
                x, y = u + du + margin, v + dv + margin
                if -half < x < canvas.shape[1] + half and -half < y < canvas.shape[0] + half:
                    axes = (max(1, round(half)), max(1, round(half * slim)))
                    cv2.ellipse(canvas, (round(x), round(y)), axes, turn, 0, 360, shade, -1)
    return _standard(cv2.GaussianBlur(canvas, (0, 0), 0.7)[margin:-margin, margin:-margin])


@lru_cache(maxsize=24)
def _pyramid(key: bytes, shape: tuple[int, int]) -> tuple[Tile, ...]:
    level = np.frombuffer(key, np.float32).reshape(shape)
    levels = [level]
    while min(level.shape) > 8:
        wrapped = cv2.copyMakeBorder(level, 4, 4, 4, 4, cv2.BORDER_WRAP)
        level = np.asarray(cv2.pyrDown(wrapped)[2:-2, 2:-2], np.float32)
        levels.append(level)
    return tuple(levels)


def _spacing_m(grid_m: np.ndarray) -> float:
    line = grid_m.ravel()
    return abs(float(line[1] - line[0])) if line.size > 1 else 0.0


def laid(tile: Tile, x_m: np.ndarray, y_m: np.ndarray, period_m: float, turn_rad: float = 0.0) -> np.ndarray:
    """The tile at world points, a column `x_m` (N, 1) and a row `y_m` (1, M); one tile is `period_m` long."""
    spacing_m = np.sqrt(_spacing_m(x_m) * _spacing_m(y_m))
    levels = _pyramid(tile.tobytes(), tile.shape)
    coarser = max(0.0, np.log2(max(spacing_m * tile.shape[0] / period_m, 1e-9)))
    level = levels[min(round(coarser), len(levels) - 1)]
    size = level.shape[0]
    cos, sin = float(np.cos(turn_rad) * size / period_m), float(np.sin(turn_rad) * size / period_m)
    # Wrapped before they are added: the remainders of a line and a column are quick.
    u = _wrapped(np.mod(cos * x_m, size) - np.mod(sin * y_m, size), size)
    v = _wrapped(np.mod(sin * x_m, size) + np.mod(cos * y_m, size), size)
    padded = np.asarray(cv2.copyMakeBorder(level, 1, 2, 1, 2, cv2.BORDER_WRAP), np.float32)
    return cv2.remap(padded, u + 1, v + 1, cv2.INTER_LINEAR)


def _wrapped(index: np.ndarray, size: int) -> np.ndarray:
    """Wraps an index that is between -size and 2 * size."""
    index = index.astype(np.float32, copy=False)
    return np.asarray(np.where(index < 0, index + size, np.where(index >= size, index - size, index)))


def spread(tile: Tile, x_m: np.ndarray, y_m: np.ndarray, period_m: float, turn_rad: float) -> np.ndarray:
    """The tile twice over, turned and scaled against itself, so that no period shows."""
    first = laid(tile, x_m, y_m, period_m, turn_rad)
    return np.asarray(0.75 * first + 0.66 * laid(tile, x_m, y_m, 1.618 * period_m, turn_rad + 1.1))
