"""Ground of any relief and cover, in patches whose texels grow with the distance they are seen from."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from vista_eval.render.scene import GroundStrip, HeightField, Thing, thing
from vista_eval.worlds.grounds import COVERS
from vista_eval.worlds.path import Path

Relief = Callable[[np.ndarray, np.ndarray], np.ndarray]  # heights in metres of world x and y

LOWEST_RAY = 0.30  # down over ahead, of the lowest image row at 3 degrees nose down
HORIZON_M = 1500.0
FINEST_TEXEL_M = 0.02  # below a moving camera, for the sake of memory
NODE_M = 1.0  # spacing of heights; each further ring has them COARSER times as far apart
RINGS_M, COARSER = (80.0, 320.0), 4
TEXEL_PER_RANGE = 1.6e-3  # a pixel of the paper's rig sees 1e-3 of the range
MARGIN_M = 6.0
HALF_VIEW_RAD = 0.42  # of the image, banked
MOST_TURN_RAD = 1.35  # off +x, of a ray that still counts
MOST_STRETCH = 12


class Patch(NamedTuple):
    x_m: tuple[float, float]
    y_m: tuple[float, float]
    texel_m: float  # across
    stretch: int  # texels are that much longer along x, as a pixel's footprint on level ground is


def patches(path: Path, over_ground_m: float, level: bool) -> Iterator[Patch]:
    """All that is seen from the path's flown part, which ends short of x = 0: finely what is seen from its
    end, more coarsely what is only seen from farther away."""
    flown = path.points_m[: path.flown]
    first_m, last_m = float(flown[:, 0].min()), float(flown[-1, 0])
    near = over_ground_m / LOWEST_RAY / 1.7  # gusts, banks and descents lower the lowest ray
    ranges = [near * 2.0**k for k in range(14) if near * 2.0**k < 0.7 * HORIZON_M] + [HORIZON_M]
    for k, (low, high) in enumerate(pairwise(ranges)):
        x = (_snapped(first_m - 2 if k == 0 else last_m + low), _snapped(last_m + high))
        texel = max(TEXEL_PER_RANGE * low, FINEST_TEXEL_M)
        stretch = int(np.clip(low / over_ground_m if level else 1, 1, MOST_STRETCH))
        inner, outer = seen_m(flown[-8:], x[1]), seen_m(flown, x[1])
        yield Patch(x, inner, texel, stretch)
        if outer[0] < inner[0]:
            yield Patch(x, (outer[0], inner[0]), 3 * texel, stretch)
        if inner[1] < outer[1]:
            yield Patch(x, (inner[1], outer[1]), 3 * texel, stretch)


def seen_m(flown_m: np.ndarray, x_m: float) -> tuple[float, float]:
    """Range of y that is in view up to `x_m`, along the headings of the path."""
    steps = np.gradient(flown_m[:, :2], axis=0)
    heading, ahead = np.arctan2(steps[:, 1], steps[:, 0]), x_m - flown_m[:, 0]
    sides = [flown_m[:, 1]]
    for half in (-HALF_VIEW_RAD, HALF_VIEW_RAD):
        turn = np.clip(heading + half, -MOST_TURN_RAD, MOST_TURN_RAD)
        sides.append(flown_m[:, 1] + np.tan(turn) * ahead)
    return _snapped(float(np.min(sides)) - MARGIN_M), _snapped(float(np.max(sides)) + MARGIN_M)


def _snapped(length_m: float) -> float:
    return NODE_M * round(length_m / NODE_M)


def _nodes(span_m: tuple[float, float], spacing_m: float) -> np.ndarray:
    return np.linspace(*span_m, max(2, 1 + round((span_m[1] - span_m[0]) / spacing_m)))


def albedo_of(patch: Patch, cover: str, contrast: float, seed: int, relief: Relief | None) -> np.ndarray:
    """Each texel the mean of as many squares as it is long, or far ground would be all speckles. Where the
    ground is steep the cover follows it up and is not drawn out: it is laid along the profile below the
    path."""
    rows = max(2, round((patch.x_m[1] - patch.x_m[0]) / (patch.texel_m * patch.stretch)))
    columns = max(2, round((patch.y_m[1] - patch.y_m[0]) / patch.texel_m))
    squares = rows * patch.stretch
    x = patch.x_m[0] + (np.arange(squares) + 0.5) * (patch.x_m[1] - patch.x_m[0]) / squares
    y = patch.y_m[0] + (np.arange(columns) + 0.5) * (patch.y_m[1] - patch.y_m[0]) / columns
    if relief is not None:
        z = relief(x[:, None], np.zeros((1, 1)))[:, 0]
        x = x[0] + np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))])
    kind = COVERS[cover]
    fine = kind.albedo(x.astype(np.float32)[:, None], y.astype(np.float32)[None, :], seed)
    albedo = fine.reshape(rows, patch.stretch, columns).mean(axis=1)
    return np.clip(kind.mean + contrast * (albedo - kind.mean), 0.02, 0.9).astype(np.float32)


def ground(
    path: Path,
    over_ground_m: float,
    cover: str,
    contrast: float,
    seed: int,
    relief: Relief | None,
    is_met: bool,
) -> Thing:
    """Level at z = 0 without a relief. over_ground_m: the least height of the path; is_met: by the path."""
    solids: list[GroundStrip | HeightField] = []
    for k, patch in enumerate(patches(path, over_ground_m, relief is None)):
        albedo, name = albedo_of(patch, cover, contrast, seed, relief), f"ground{k}"
        if relief is None:
            solids.append(GroundStrip(name, patch.x_m, patch.y_m, albedo))
        else:
            solids.append(HeightField(name, patch.x_m, patch.y_m, heights_m(patch, relief), albedo))
    return thing("ground", "slope" if is_met else "ground", solids, standing=False, target=is_met)


def heights_m(patch: Patch, relief: Relief) -> np.ndarray:
    spacing = NODE_M * COARSER ** sum(patch.x_m[1] > ring for ring in RINGS_M)
    x, y = _nodes(patch.x_m, spacing)[:, None], _nodes(patch.y_m, spacing)[None, :]
    return np.broadcast_to(relief(x, y), (x.size, y.size)).astype(np.float32)
