"""Fences, hedges and railings across a low path."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene, thing
from vista_eval.worlds import things, vegetation, yard
from vista_eval.worlds.courses import LOW
from vista_eval.worlds.grounds import COUNTRY_AND_TOWN
from vista_eval.worlds.rods import Rods, all_of, rods
from vista_eval.worlds.site import RURAL, URBAN, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, placed, tube


def posts_m(length_m: float, most_m: float) -> np.ndarray:
    """Places along a fence, one at either end and no two farther apart than that."""
    return np.linspace(-length_m / 2, length_m / 2, 1 + int(np.ceil(length_m / most_m)))


def railing(length_m: float, height_m: float, rng: np.random.Generator) -> tuple[Rods, Triangles]:
    """Steel bars of 12 to 25 mm at 9 to 14 cm between two rails."""
    pitch, radius = rng.uniform(0.09, 0.14), rng.uniform(0.006, 0.0125)
    shade = float(rng.uniform(0.04, 0.5))
    ends = [[(0, y, 0.05), (0, y, height_m)] for y in np.arange(-length_m / 2, length_m / 2, pitch)]
    rails = [box((0, 0, z), (0.03, length_m, 0.045), shade) for z in (0.15, height_m - 0.12)]
    posts = [box((0, y, height_m / 2), (0.06, 0.06, height_m), shade) for y in posts_m(length_m, 2.5)]
    return rods(ends, radius, shade), joined(*rails, *posts)


def chain_link(length_m: float, height_m: float, rng: np.random.Generator) -> tuple[Rods, Triangles]:
    """Wires of 3 mm crossing at 6 to 12 cm between posts; barbed wire on top."""
    mesh_m, shade = rng.uniform(0.06, 0.12), float(rng.uniform(0.2, 0.5))
    step_m = mesh_m * np.sqrt(2)
    starts = np.arange(step_m - length_m / 2 - height_m, length_m / 2 - 0.01, step_m)
    ends = []
    for y in starts:
        low, high = max(0.0, -length_m / 2 - y), min(height_m, length_m / 2 - y)  # between the outer posts
        ends.append([(0, y + low, low), (0, y + high, high)])
        ends.append([(0, y + low, height_m - low), (0, y + high, height_m - high)])
    above = [[(0, -length_m / 2, z), (0, length_m / 2, z)] for z in height_m + np.array([0.0, 0.15, 0.28])]
    posts = [tube([(0, y, 0), (0, y, height_m + 0.3)], 0.035, 0.8 * shade, 8) for y in posts_m(length_m, 3.0)]
    return all_of(rods(ends, 0.0015, shade), rods(above, 0.003, shade)), joined(*posts)


def fence(altitude_m: float, seed: int) -> Scene:
    """Pickets, rails or a hedge, 10 cm to 1 m higher than the path, up to 30 degrees askew."""
    here = site(altitude_m, seed, LOW, COUNTRY_AND_TOWN)
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
    here = site(altitude_m, seed, LOW, COUNTRY_AND_TOWN)
    rng = here.draws("steel fence")
    height, length = altitude_m + float(rng.uniform(0.2, 1.2)), float(rng.uniform(8, 18))
    bars, posts = (railing if rng.random() < 0.5 else chain_link)(length, height, rng)
    yaw = float(rng.uniform(-30, 30))
    frame = things.mesh("target_posts", placed(posts, (0, 0, 0), yaw))
    solids = [frame, *bars.moved((0, 0, 0), yaw).solids("target_bar")]
    target = thing("target", "fence", solids, target=True)
    return scene_of(here, [target], [*clutter(here, URBAN), *background(here)])
