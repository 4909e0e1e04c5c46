"""What the ground is covered with."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vista_eval.render import textures
from vista_eval.render.textures import layered, noise, smoothstep
from vista_eval.worlds.draws import draws
from vista_eval.worlds.patterns import cloudy, laid, litter, spread, stones

Albedo = Callable[[np.ndarray, np.ndarray, int], np.ndarray]  # of x, y in metres and seed


class Cover(NamedTuple):
    albedo: Albedo
    mean: float


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


def pasture(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Grazed grass with tussocks, molehills and the paths of cattle."""
    fine = spread(litter(seed, 3000, 5.0, 0.2), x_m, y_m, 3.0, seed)
    wide = spread(cloudy(seed + 1, 1.3), x_m, y_m, 45.0, seed)
    tussocks = smoothstep(0.9, 1.6, spread(cloudy(seed + 2, 0.7), x_m, y_m, 12.0, seed))
    hills = smoothstep(2.3, 2.6, spread(cloudy(seed + 3, 0.6), x_m, y_m, 17.0, seed))
    path = 1 - smoothstep(0.02, 0.12, np.abs(spread(cloudy(seed + 4, 1.8), x_m, y_m, 90.0, seed)))
    grass = 0.2 + 0.045 * fine + 0.03 * wide - 0.07 * tussocks
    return np.clip(grass + 0.10 * path - 0.12 * hills, 0.03, 0.8)


def crop(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Rows of plants on bare soil, gaps in the rows, the tracks of a tractor."""
    rng = draws(seed, "crop")
    turn, pitch = rng.uniform(0, np.pi), rng.uniform(0.3, 0.9)
    across = np.cos(turn) * x_m + np.sin(turn) * y_m + 0.15 * laid(cloudy(seed, 2.0), x_m, y_m, 60.0)
    ragged = spread(cloudy(seed + 1, 0.7), x_m, y_m, 5.0, seed)
    row = smoothstep(-0.1, 0.5, np.cos(2 * np.pi * across / pitch) + 0.5 * ragged)
    track = np.abs(np.abs(np.mod(across, 18.0) - 9.0) - 0.9) < 0.2
    soil = 0.26 + 0.04 * spread(stones(seed + 2, 900), x_m, y_m, 4.0, seed)
    plants = 0.15 + 0.05 * spread(litter(seed + 3), x_m, y_m, 3.0, seed)
    return np.clip(np.where(track, 0.9 * soil, soil + row * (plants - soil)), 0.03, 0.8)


def heath(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Dark cushions on pale sand."""
    cushions = smoothstep(-0.2, 0.35, spread(cloudy(seed, 1.0), x_m, y_m, 22.0, seed))
    twigs = 0.13 + 0.05 * spread(litter(seed + 1, 3000, 4.0, 0.25), x_m, y_m, 2.2, seed)
    sand = 0.42 + 0.05 * spread(cloudy(seed + 2, 0.8), x_m, y_m, 7.0, seed)
    return np.clip(sand + cushions * (twigs - sand), 0.03, 0.8)


def scree(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Broken rock of two sizes, moss between."""
    coarse = spread(stones(seed, 260, 5.0), x_m, y_m, 9.0, seed)
    fine = spread(stones(seed + 1, 800, 2.0), x_m, y_m, 3.5, seed)
    moss = smoothstep(0.5, 1.2, spread(cloudy(seed + 2, 1.2), x_m, y_m, 30.0, seed))
    return np.clip(0.33 + 0.085 * coarse + 0.05 * fine - 0.15 * moss, 0.03, 0.85)


def forest_floor(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Leaf litter, roots, patches of green."""
    leaves = spread(litter(seed, 2600, 8.0, 0.6), x_m, y_m, 3.2, seed)
    green = smoothstep(0.4, 1.0, spread(cloudy(seed + 1, 1.1), x_m, y_m, 14.0, seed))
    return np.clip(0.19 + 0.06 * leaves - 0.05 * green, 0.03, 0.7)


def apron(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Concrete slabs with tarred joints, oil stains, the marks of tyres."""
    rng = draws(seed, "apron")
    side, turn = rng.uniform(3.0, 7.5), rng.uniform(0, np.pi)
    along = np.cos(turn) * x_m + np.sin(turn) * y_m
    aside = -np.sin(turn) * x_m + np.cos(turn) * y_m
    joint = (np.mod(along, side) < 0.06) | (np.mod(aside, side) < 0.06)
    slab = textures.noise(np.floor(along / side) * 3.1, np.floor(aside / side) * 3.1, 1.0, seed)
    stains = smoothstep(1.2, 2.2, spread(cloudy(seed, 1.3), x_m, y_m, 16.0, seed))
    grain = spread(cloudy(seed + 1, 0.4), x_m, y_m, 4.0, seed)
    wear = spread(cloudy(seed + 2, 1.2, 12.0), x_m, y_m, 30.0, turn)
    concrete = 0.38 + 0.14 * slab + 0.022 * grain + 0.02 * wear - 0.18 * stains
    return np.clip(np.where(joint, 0.12, concrete), 0.04, 0.8)


def snow(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Thawing: bare patches and blades that look through."""
    bare = smoothstep(0.3, 0.7, spread(cloudy(seed, 1.1), x_m, y_m, 26.0, seed))
    drift = 0.72 + 0.03 * spread(cloudy(seed + 1, 1.2, 4.0), x_m, y_m, 12.0, seed)
    blades = smoothstep(1.6, 2.4, spread(litter(seed + 2, 3000, 4.0, 0.3), x_m, y_m, 3.0, seed))
    grass = 0.22 + 0.07 * spread(litter(seed + 3), x_m, y_m, 3.0, seed)
    return np.clip(drift - 0.35 * blades + bare * (grass - drift), 0.03, 0.9)


def water(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """A harbour or a lake: dark, with swell and ripples across the wind. It does not move."""
    wind = draws(seed, "water").uniform(0, np.pi)
    swell = spread(cloudy(seed, 1.6, 4.0), x_m, y_m, 24.0, wind)
    ripples = spread(cloudy(seed + 1, 0.9, 3.0), x_m, y_m, 5.0, wind)
    return np.clip(0.1 + 0.012 * swell + 0.012 * ripples + 0.06 * smoothstep(1.5, 2.5, ripples), 0.03, 0.5)


COVERS: dict[str, Cover] = {
    "pasture": Cover(pasture, 0.20),
    "crop": Cover(crop, 0.21),
    "heath": Cover(heath, 0.26),
    "scree": Cover(scree, 0.31),
    "forest_floor": Cover(forest_floor, 0.18),
    "apron": Cover(apron, 0.37),
    "snow": Cover(snow, 0.55),
    "meadow": Cover(textures.ground, 0.25),
    "asphalt": Cover(asphalt, 0.22),
    "soil": Cover(soil, 0.22),
    "gravel": Cover(gravel, 0.36),
    "stubble": Cover(stubble, 0.38),
    "water": Cover(water, 0.1),
}
OPEN_COUNTRY = ("pasture", "crop", "heath", "scree", "snow", "meadow", "soil", "stubble")
BUILT_UP = ("apron", "gravel", "pasture", "asphalt")
WOODED = ("forest_floor", "pasture", "meadow", "heath")
COUNTRY_AND_TOWN = tuple(dict.fromkeys((*OPEN_COUNTRY, *BUILT_UP)))
