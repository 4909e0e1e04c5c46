"""Trees, from one to a wood, with leaves and without; one of them in the way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vista_eval.render.scene import Scene, Thing
from vista_eval.worlds import things
from vista_eval.worlds.courses import FROM_AFAR, Courses
from vista_eval.worlds.draws import log_uniform, some_seed
from vista_eval.worlds.grounds import OPEN_COUNTRY, WOODED
from vista_eval.worlds.path import clear_of, distance_m
from vista_eval.worlds.site import RURAL, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, joined
from vista_eval.worlds.vegetation import bark, crown

AMONG_TREES = Courses(altitude_m=(2.5, 9.0), climb_deg=(-6.0, 5.0))
RIDE = Courses(altitude_m=(4.5, 9.0), climb_deg=(0.0, 5.0), most_bank_deg=15.0)
AMONG_TRUNKS = replace(FROM_AFAR, altitude_m=(2.5, 6.0))
MOST_TREES = 40
NEAR_M = 0.6  # of the path to the nearest branch of the tree in the way


def tuft_m(range_m: float) -> float:
    """Leaves some six pixels across."""
    return float(np.clip(6e-3 * range_m, 0.1, 0.6))


def pine(height_m: float, radius_m: float, rng: np.random.Generator, leaf_m: float) -> Triangles:
    """A bare trunk, `radius_m` thick at the height of a man, under a crown in its upper third."""
    lean = rng.normal(0, 0.012, 2) * height_m
    path = np.array([[0, 0, -0.5], [*(0.4 * lean), 0.5 * height_m], [*lean, 0.95 * height_m]])
    trunk = bark(path, radius_m * np.array([1.15, 0.8, 0.2]), rng, 10)
    count = int(rng.integers(5, 10))
    spread = 0.14 * height_m
    centers = np.column_stack(
        [rng.normal(0, 0.6 * spread, (count, 2)) + lean, height_m * rng.uniform(0.68, 0.97, count)]
    )
    radii = rng.uniform(0.4, 0.8, (count, 1)) * [spread, spread, 0.5 * spread]
    limbs = [
        bark(np.array([[*(0.7 * lean), c[2] - 0.05 * height_m], c]), radius_m * np.array([0.25, 0.1]), rng, 5)
        for c in centers
    ]
    return joined(trunk, *limbs, crown(centers, radii, leaf_m, rng.uniform(0.15, 0.35), rng))


def scattered(here: Site, count: int, apart_m: float, to_m: float = 100.0) -> list[tuple[float, float]]:
    """Places around the path and beyond its end that keep apart from each other."""
    rng = here.draws("scattered")
    first_m, places = float(here.path.points_m[0, 0]), [(0.0, 0.0)]
    for _ in range(20 * count):
        x = float(rng.uniform(first_m + 12, to_m))
        y = here.path.y_m(x) + float(rng.uniform(-1, 1)) * (8 + 0.4 * max(0.0, x - first_m))
        if len(places) <= count and all(np.hypot(x - a, y - b) > apart_m for a, b in places):
            places.append((x, y))
    return places[1:]


def wood(here: Site, forms: tuple[str, ...], heights_m: tuple[float, float], most: int) -> list[Thing]:
    """One to `most` other trees, as often few as many."""
    rng = here.draws("wood")
    found = []
    for k, (x, y) in enumerate(scattered(here, round(log_uniform(rng, 1, most)) - 1, 2.5)):
        form, height = str(rng.choice(list(forms))), float(rng.uniform(*heights_m))
        leaf = tuft_m(max(14.0, x + 14.0, 3 * abs(y)))
        found.append(things.tree(f"tree{k}", form, here.foot_m(x, y), height, some_seed(rng), leaf))
    return found


def at_a_tree(here: Site, forms: tuple[str, ...]) -> Scene:
    """Trunk and crown of one stand within half a metre of the path, which leads below its top."""
    rng, met = here.draws("target"), np.array([0.0, 0.0, here.altitude_m])
    form = str(rng.choice(list(forms)))
    while True:  # the path may lead through a gap between branches
        height = here.altitude_m * float(rng.uniform(1.4, 2.4)) + 1.0
        foot = here.foot_m(float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.5, 0.5)))
        target = things.tree("target", form, foot, height, some_seed(rng), tuft_m(14.0), target=True)
        if distance_m(target, met) < NEAR_M:
            break
    others = [*wood(here, forms, (4.0, 14.0), MOST_TREES), *clutter(here, RURAL, 8)]
    return scene_of(here, [target], [*others, *background(here, ("trees", "forest", "open"))])


def leafy(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, AMONG_TREES, OPEN_COUNTRY)
    return at_a_tree(here, ("broadleaf", "broadleaf", "conifer", "poplar"))


def bare(altitude_m: float, seed: int) -> Scene:
    """Branches against the sky and against each other."""
    here = site(altitude_m, seed, AMONG_TREES, WOODED)
    return at_a_tree(here, ("bare",))


def pine_wood(altitude_m: float, seed: int) -> Scene:
    """Trunks of 0.3 to 0.8 m below closed crowns; one of them in the way."""
    here = site(altitude_m, seed, AMONG_TRUNKS, ("forest_floor",))
    rng = here.draws("pines")

    def one(name: str, foot: tuple[float, float, float], leaf: float, **more) -> Thing:
        shape = pine(float(rng.uniform(14, 24)), float(rng.uniform(0.15, 0.4)), rng, leaf)
        return things.one(name, "tree", shape, foot, float(rng.uniform(0, 360)), **more)

    target = one("target", here.foot_m(0.0, float(rng.uniform(-0.4, 0.4))), tuft_m(30), target=True)
    count = int(rng.integers(15, 55))
    others = [
        one(f"pine{k}", here.foot_m(x, y), tuft_m(40))
        for k, (x, y) in enumerate(scattered(here, count, rng.uniform(2.5, 5.0), 110.0))
    ]
    return scene_of(here, [target], [*others, *background(here, ("forest", "trees"))])


def clear_wood(altitude_m: float, seed: int) -> Scene:
    """A ride through a wood: crowns and trunks on both sides, none over the path."""
    here = site(altitude_m, seed, RIDE, WOODED)
    rng = here.draws("ride")
    forms = ("broadleaf", "conifer", "poplar", "bare")
    trees = []
    for k, (x, y) in enumerate(scattered(here, int(rng.integers(30, 70)), 3.0, 110.0)):
        height = float(rng.uniform(6, 14))
        beside_m = y + np.sign(y) * (4.0 + 0.36 * height)
        foot, leaf = here.foot_m(x, float(beside_m)), tuft_m(max(18.0, x + 14.0))
        trees.append(things.tree(f"tree{k}", str(rng.choice(forms)), foot, height, some_seed(rng), leaf))
    beyond = background(here, ("trees", "forest", "open"))
    return scene_of(here, (), [*clear_of(here.path, trees), *beyond], meets_at_m=None)
