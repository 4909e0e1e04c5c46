"""The flight of the demo: at a sign over a meadow, before a farm on a summer's afternoon."""

from __future__ import annotations

import numpy as np

from vista_eval.render.course import FOOT_M, Course
from vista_eval.render.flight import Flight
from vista_eval.render.scene import Scene, Thing
from vista_eval.worlds import things, vegetation, walls, yard
from vista_eval.worlds.landscape import hills
from vista_eval.worlds.meadow_flights import bales, country, parked
from vista_eval.worlds.sampled.buildings import block, rectangle_m

AFTERNOON_SUN = (-0.50, 0.70, 0.42)
TREES = (  # form, foot, height
    ("broadleaf", (62.0, -12.0), 10.5),
    ("broadleaf", (64.0, -33.0), 13.0),
    ("broadleaf", (36.0, -6.8), 8.0),
    ("conifer", (58.0, 11.0), 11.0),
    ("conifer", (63.0, 14.5), 9.0),
    ("poplar", (70.0, 24.0), 14.0),
    ("poplar", (74.0, 28.5), 15.0),
    ("poplar", (78.0, 33.0), 14.0),
    ("bush", (66.0, 5.5), 2.5),
    ("bush", (27.0, 6.5), 2.0),
)


def farm(altitude_m: float, seed: int) -> Scene:
    rng = np.random.default_rng((seed, 13))
    house, barn = (
        rectangle_m(foot, *sides) for foot, sides in (((50, -19), (11, 8, 24)), ((46, 19), (16, 9, -18)))
    )
    faces = [walls.lived_in, walls.roughcast, walls.roughcast, walls.lived_in]
    fence = yard.picket_fence(17.0, 1.1, 0.16, rng, 0.7)
    return Scene(
        (
            things.sign(altitude_m, seed),
            *country(altitude_m, seed),
            block("house", house, 5.6, faces, rng, pitched=True),
            block("barn", barn, 4.6, [walls.brick] * 4, rng, pitched=True),
            things.one("fence", "fence", fence, (42.0, -18.0, 0.0), 24.0),
            *(tree(f"tree{k}", form, foot, height, seed + k) for k, (form, foot, height) in enumerate(TREES)),
            *bales(seed),
            parked("car", "car", 17.0, -9.5, 130.0, 0.75, seed),
            parked("van", "van", 13.0, 6.2, 65.0, 0.6, seed),
            things.one("person", "person", yard.person(rng), (20.0, -6.6, 0.0), 60.0),
            hills(altitude_m, seed),
        ),
        to_sun=AFTERNOON_SUN,
        fill_irradiance=1.5,
        sky="clouds",
        exposure=1.25,
    )


def tree(name: str, form: str, foot_m: tuple[float, float], height_m: float, seed: int) -> Thing:
    foot = (*foot_m, 0.0)
    if form == "bush":
        shape = vegetation.bush(height_m, 0.8 * height_m, np.random.default_rng(seed))
        return things.one(name, "bush", shape, foot)
    return things.tree(name, form, foot, height_m, seed, 0.2)


# 30 ft/s at 21 ft straight at the sign, from 58 m to 22 m.
SIGN_AT_30_FT_S = Flight(
    "demo",
    "sign at 30 ft/s",
    "dev",
    Course(21 * FOOT_M, 30 * FOOT_M, last_range_m=22.0, frames=40, rate_hz=10.0),
    farm,
)
