"""Kinds of ground, and strips of ground whose texels grow with the distance from which they are seen."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import cv2
import numpy as np

from vista_eval.render import textures
from vista_eval.render.scene import GroundStrip, Thing, thing
from vista_eval.render.textures import layered, noise, smoothstep

Albedo = Callable[[np.ndarray, np.ndarray, int], np.ndarray]  # of x, y in metres and seed

TEXEL_PER_RANGE = 1.2e-3  # a pixel of the paper's rig sees 1e-3 of the range
HALF_WIDTH_PER_RANGE = 0.38  # half the field of view is 0.32; the rest is for yaw and roll
LOWEST_RAY = 0.30  # down over ahead, of the lowest image row at 3 degrees nose down
SAMPLES_ALONG = 2
HORIZON_M = 1500.0
FINEST_TEXEL_M = 0.02  # below a moving camera, for the sake of memory


def asphalt(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """A road along x, 7 m wide, with lines, worn tracks, cracks, patches; kerb, pavement, then grass."""
    grain = layered(x_m, y_m, {9.0: 0.03, 2.1: 0.025, 0.5: 0.02, 0.11: 0.02, 0.045: 0.03}, seed)
    worn = 0.03 * np.exp(-(((np.abs(np.abs(y_m) - 1.75) - 0.75) / 0.3) ** 2))
    crack = np.abs(layered(x_m, y_m, {3.9: 1.0, 1.0: 0.4, 0.2: 0.1}, seed + 3)) < 0.006
    patch = noise(np.floor(x_m / 2.5) * 2.5, np.floor(y_m / 1.7) * 1.7, 4.1, seed + 4)
    patched = smoothstep(0.30, 0.31, patch)
    road = 0.15 + grain + worn - 0.07 * crack - 0.05 * patched
    chips = 0.75 + 0.5 * layered(x_m, y_m, {0.3: 0.4, 0.06: 0.5}, seed + 5)
    dashes = (np.abs(y_m) < 0.07) & (np.mod(x_m, 9.0) < 4.0)
    edges = np.abs(np.abs(y_m) - 3.3) < 0.06
    road = np.where(dashes | edges, 0.6 * chips, road)
    slabs = (np.mod(x_m, 0.5) < 0.015) | (np.mod(np.abs(y_m) - 3.65, 0.5) < 0.015)
    shade = noise(np.floor(x_m / 0.5) * 0.5, np.floor(y_m / 0.5) * 0.5, 0.37, seed + 6)
    paving = np.where(slabs, 0.12, 0.33 + 0.12 * shade + grain)
    kerb = 0.42 + grain
    beside = np.where(np.abs(y_m) < 3.65, kerb, paving)
    beside = np.where(np.abs(y_m) < 6.3, beside, textures.ground(x_m, y_m, seed + 7))
    return np.clip(np.where(np.abs(y_m) < 3.5, road, beside), 0.03, 0.9).astype(np.float32)


def soil(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """A harrowed field: clods, furrows askew to the flight, stones."""
    clods = layered(x_m, y_m, {13.0: 0.06, 1.7: 0.05, 0.42: 0.09, 0.17: 0.12, 0.07: 0.08}, seed)
    cos, sin = np.cos(seed * 0.7), np.sin(seed * 0.7)
    bent = 0.6 * noise(x_m, y_m, 9.0, seed + 2)
    furrows = 0.035 * np.sin(2 * np.pi * (cos * x_m + sin * y_m + bent) / 0.75)
    stones = smoothstep(0.36, 0.40, noise(x_m, y_m, 0.14, seed + 3))
    return np.clip(0.2 + clods + furrows + 0.2 * stones, 0.03, 0.8).astype(np.float32)


def gravel(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Stones of 3 to 10 cm, tracks of wheels, weeds."""
    stones = layered(x_m, y_m, {0.11: 0.22, 0.06: 0.24, 0.3: 0.10, 2.7: 0.07, 17.0: 0.08}, seed)
    wheel = np.exp(
        -(((np.abs(y_m - 0.08 * x_m - 4 * noise(x_m, 0.0 * y_m, 40.0, seed + 1)) - 0.8) / 0.3) ** 2)
    )
    weeds = smoothstep(0.22, 0.34, layered(x_m, y_m, {5.0: 0.6, 0.9: 0.5, 0.3: 0.2}, seed + 2))
    return np.clip(0.38 + stones + 0.07 * wheel - 0.22 * weeds, 0.04, 0.9).astype(np.float32)


def stubble(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """A mown field: rows of straw, swaths."""
    cos, sin = np.cos(seed * 1.3), np.sin(seed * 1.3)
    across = -sin * x_m + cos * y_m + 0.3 * noise(x_m, y_m, 11.0, seed + 1)
    straw = layered(x_m, y_m, {7.0: 0.07, 0.9: 0.08, 0.25: 0.12, 0.09: 0.16}, seed)
    rows = 0.05 * np.sin(2 * np.pi * across / 0.3) + 0.06 * np.sin(2 * np.pi * across / 6.0)
    return np.clip(0.38 + straw + rows, 0.05, 0.85).astype(np.float32)


KINDS: dict[str, Albedo] = {
    "meadow": textures.ground,
    "asphalt": asphalt,
    "soil": soil,
    "gravel": gravel,
    "stubble": stubble,
}
MEAN_ALBEDO = {"meadow": 0.25, "asphalt": 0.22, "soil": 0.22, "gravel": 0.36, "stubble": 0.38}


def strip(
    kind: str,
    x_m: tuple[float, float],
    y_m: tuple[float, float],
    texel_m: float,
    along: int,
    contrast: float,
    seed: int,
) -> GroundStrip:
    """Texels `texel_m` across and `along` times as long; each the mean of what lies in it, as a pixel's
    footprint is stretched along x by range / height: so a few rays a pixel do without aliasing."""
    rows = max(1, round((x_m[1] - x_m[0]) / (texel_m * along)))
    columns = max(1, round((y_m[1] - y_m[0]) / texel_m))
    samples = min(along, SAMPLES_ALONG)
    x = x_m[0] + (np.arange(rows * samples) + 0.5) * (x_m[1] - x_m[0]) / (rows * samples)
    y = y_m[0] + (np.arange(columns) + 0.5) * (y_m[1] - y_m[0]) / columns
    fine = KINDS[kind](x.astype(np.float32)[:, None], y.astype(np.float32)[None, :], seed)
    albedo = fine.reshape(rows, samples, columns).mean(axis=1)
    albedo = np.clip(MEAN_ALBEDO[kind] + contrast * (albedo - MEAN_ALBEDO[kind]), 0.02, 0.9)
    return GroundStrip(f"ground_{x_m[0]:.0f}_{y_m[0]:.0f}", x_m, y_m, albedo)


def ground(
    kind: str, altitude_m: float, first_x_m: float, last_x_m: float, seed: int, contrast: float = 0.5
) -> Thing:
    """From what the camera sees first to the horizon; it flies from `first_x_m` to `last_x_m`.

    Each strip is as fine as it is seen from the last position; what lies beside the view from there is
    only seen from farther away."""
    near = altitude_m / LOWEST_RAY
    ranges = [near * 2.0**k for k in range(12) if near * 2.0**k < HORIZON_M] + [HORIZON_M]
    strips = []
    for k, (low, high) in enumerate(pairwise(ranges)):
        x = (last_x_m + low if k else first_x_m + near, last_x_m + high)
        texel = max(TEXEL_PER_RANGE * low, FINEST_TEXEL_M if first_x_m < last_x_m else 0.0)
        along = int(np.clip(low / altitude_m, 1, 16))
        inner = HALF_WIDTH_PER_RANGE * high + 3
        strips.append(strip(kind, x, (-inner, inner), texel, along, contrast, seed))
        outer = HALF_WIDTH_PER_RANGE * (high + last_x_m - first_x_m) + 3
        if outer > 1.1 * inner:
            strips.append(strip(kind, x, (-outer, -inner), 3 * texel, along, contrast, seed))
            strips.append(strip(kind, x, (inner, outer), 3 * texel, along, contrast, seed))
    return thing("ground", "ground", strips, standing=False)


def tarpaulin_texture(
    width_m: float, length_m: float, albedo: float, seed: int, texel_m: float = 0.02
) -> np.ndarray:
    """Woven sheet with folds, seams and a hem; rows along its length."""
    y, x = np.mgrid[0 : round(length_m / texel_m), 0 : round(width_m / texel_m)].astype(np.float32) * texel_m
    folds = np.sin(2 * np.pi * (y + 0.25 * noise(x, y, 1.7, seed)) / 1.0) ** 8
    sheet = albedo * (1 + 0.5 * layered(x, y, {1.3: 0.5, 0.4: 0.5, 0.1: 0.35}, seed + 1) + 0.25 * folds)
    hem = (np.minimum(x, width_m - x) < 0.08) | (np.minimum(y, length_m - y) < 0.08)
    return cv2.GaussianBlur(
        np.clip(np.where(hem, 0.55 * sheet, sheet), 0.03, 0.9).astype(np.float32), (3, 3), 0.6
    )
