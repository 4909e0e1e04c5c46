"""Fences, hedges and railings across a low path."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene
from vista_eval.worlds import things, vegetation, yard
from vista_eval.worlds.sampled.courses import LOW
from vista_eval.worlds.sampled.grounds import BUILT_UP, OPEN_COUNTRY
from vista_eval.worlds.sampled.site import RURAL, URBAN, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, tube


def railing(length_m: float, height_m: float, rng: np.random.Generator) -> Triangles:
    """Steel bars of 12 to 25 mm at 9 to 14 cm between two rails."""
    pitch, radius = rng.uniform(0.09, 0.14), rng.uniform(0.006, 0.0125)
    shade = float(rng.uniform(0.04, 0.5))
    parts = [
        tube([(0, y, 0.05), (0, y, height_m)], radius, shade, 5, closed=False)
        for y in np.arange(-length_m / 2, length_m / 2, pitch)
    ]
    parts += [box((0, 0, z), (0.03, length_m, 0.045), shade) for z in (0.15, height_m - 0.12)]
    parts += [
        box((0, y, height_m / 2), (0.06, 0.06, height_m), shade)
        for y in np.arange(-length_m / 2, length_m / 2 + 0.1, 2.5)
    ]
    return joined(*parts)


def chain_link(length_m: float, height_m: float, rng: np.random.Generator) -> Triangles:
    """Wires of 3 mm crossing at 6 to 12 cm between posts; barbed wire on top."""
    mesh_m, radius, shade = rng.uniform(0.06, 0.12), 0.0015, float(rng.uniform(0.2, 0.5))
    parts = []
    for slope in (-1, 1):
        for start in np.arange(-length_m / 2 - height_m, length_m / 2, mesh_m * 1.41):
            low = np.array([start, 0.0]) if slope > 0 else np.array([start, height_m])
            high = low + height_m * np.array([1.0, slope])
            parts.append(tube([(0, *low), (0, *high)], radius, shade, 3, closed=False))
    for y in np.arange(-length_m / 2, length_m / 2 + 0.1, 3.0):
        parts.append(tube([(0, y, 0), (0, y, height_m + 0.3)], 0.03, 0.8 * shade, 8))
    for z in (height_m, height_m + 0.15, height_m + 0.28):
        parts.append(tube([(0, -length_m / 2, z), (0, length_m / 2, z)], 0.003, shade, 4, closed=False))
    return joined(*parts)


def fence(altitude_m: float, seed: int) -> Scene:
    """Pickets, rails or a hedge, 10 cm to 1 m higher than the path, up to 30 degrees askew."""
    here = site(altitude_m, seed, LOW, (*OPEN_COUNTRY, *BUILT_UP))
    rng = here.draws("fence")
    height, length = altitude_m + float(rng.uniform(0.1, 1.0)), float(rng.uniform(10, 30))
    match rng.integers(3):
        case 0:
            shape = yard.picket_fence(length, height, rng.uniform(0.09, 0.2), rng, rng.uniform(0.15, 0.75))
        case 1:
            shape = yard.rail_fence(2.5 * round(length / 2.5), height, rng)
        case _:
            shape = vegetation.hedge(length, height, rng)
    target = things.one("target", "fence", shape, (0, 0, 0), rng.uniform(-30, 30), target=True)
    return scene_of(here, [target], [*clutter(here, RURAL), *background(here)])


def steel_fence(altitude_m: float, seed: int) -> Scene:
    """Bars or chain link: mostly holes."""
    here = site(altitude_m, seed, LOW, (*OPEN_COUNTRY, *BUILT_UP))
    rng = here.draws("steel fence")
    height, length = altitude_m + float(rng.uniform(0.2, 1.2)), float(rng.uniform(8, 18))
    shape = (railing if rng.random() < 0.5 else chain_link)(length, height, rng)
    target = things.one("target", "fence", shape, (0, 0, 0), rng.uniform(-30, 30), target=True)
    return scene_of(here, [target], [*clutter(here, URBAN), *background(here)])
