"""Rows of upright things of mixed width that a path threads between before it meets one: an avenue of
poplars and lamp posts, or a field of hop poles with their stays. The nearest stand 1.5 to 4 m beside it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from vista_eval.render.scene import Scene, Thing, thing
from vista_eval.worlds import street, things
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform, some_seed
from vista_eval.worlds.grounds import OPEN_COUNTRY
from vista_eval.worlds.rods import Rods, all_of, strand
from vista_eval.worlds.sampled.poles import round_pole
from vista_eval.worlds.site import Site, background, scene_of, site

BETWEEN_ROWS = Courses(
    altitude_m=(3.0, 8.0),
    speed_m_s=(6.0, 20.0),
    span_m=(48.0, 62.0),
    most_frames=32,
    climb_deg=(-2.0, 3.0),
    most_bank_deg=7.0,
)
BEHIND_M, BEYOND_M = 14.0, 55.0  # rows go on from in front of the first frame to beyond what is met
UNOBSTRUCTED_M = 5.0  # before the target nothing else stands


class Place(NamedTuple):
    x_m: float
    y_m: float
    outermost: bool  # of its row


def row(
    here: Site, aside_m: float, apart_m: float, jitter_m: float, rng: np.random.Generator
) -> Iterator[Place]:
    """Places along the path, at that distance from it (negative: right), but for the place of what is met."""
    along = np.arange(here.path.points_m[0, 0] + BEHIND_M + rng.uniform(0, apart_m), BEYOND_M, apart_m)
    for x in along:
        if abs(x) < UNOBSTRUCTED_M:
            continue
        y = here.path.y_m(float(x)) + aside_m + float(rng.uniform(-jitter_m, jitter_m))
        yield Place(float(x), y, x in (along[0], along[-1]))


def avenue(here: Site) -> Scene:
    """Poplars, and lamp posts between them; met is a lamp post, a post of concrete or a poplar."""
    rng = here.draws("avenue")
    apart, posts_m, trees_m = rng.uniform(7, 13), rng.uniform(1.9, 3.2), rng.uniform(3.4, 5.0)
    found: list[Thing] = []
    for side in (-1, 1):
        for k, at in enumerate(row(here, side * trees_m, apart, 0.4, rng)):
            foot, height = here.foot_m(at.x_m, at.y_m), float(rng.uniform(7, 14))
            leaf = float(np.clip(6e-3 * (at.x_m + 16), 0.12, 0.5))
            found.append(things.tree(f"poplar{side}_{k}", "poplar", foot, height, some_seed(rng), leaf))
        for k, at in enumerate(row(here, side * posts_m, 2 * apart, 0.3, rng)):
            found.append(lamp(f"lamp{side}_{k}", here, at.x_m, at.y_m, rng))
    return scene_of(here, [avenue_target(here, rng), *found], background(here))


def lamp(name: str, here: Site, x_m: float, y_m: float, rng: np.random.Generator, **more) -> Thing:
    height = here.altitude_m + float(rng.uniform(1.0, 4.0))
    return things.one(
        name, "pole", street.lamp_post(height, rng), here.foot_m(x_m, y_m), float(rng.uniform(0, 360)), **more
    )


def avenue_target(here: Site, rng: np.random.Generator) -> Thing:
    y = float(rng.uniform(-0.6, 0.6))
    foot, height = here.foot_m(0.0, y), here.altitude_m + float(rng.uniform(1.0, 4.0))
    match rng.integers(3):
        case 0:
            return lamp("target", here, 0.0, y, rng, target=True)
        case 1:
            radius, kind = float(rng.uniform(0.12, 0.35)), str(rng.choice(["concrete", "bands", "wood"]))
            pole = round_pole("target_post", foot, (0.0, y, height), radius, some_seed(rng), kind)
            return thing("target", "pole", [pole], target=True)
        case _:
            return things.tree("target", "poplar", foot, height + 3.0, some_seed(rng), 0.12, target=True)


def hop_field(here: Site) -> Scene:
    """Poles in rows beside the path, the outermost held by stays; the pole that is met has stays, too."""
    rng = here.draws("hop field")
    apart, width, top_m = rng.uniform(6, 11), rng.uniform(3.4, 6.5), here.altitude_m + rng.uniform(2.8, 4.0)
    between, kind = rng.uniform(-0.5, 0.5), str(rng.choice(["wood", "concrete", "steel"]))
    found: list[Thing] = []
    stays: list[Rods] = []
    for number in (-1.5, -0.5, 0.5, 1.5):
        for k, at in enumerate(row(here, number * width + between, apart, 0.15, rng)):
            foot, lean = here.foot_m(at.x_m, at.y_m), rng.normal(0, 0.15, 2)
            top = (at.x_m + float(lean[0]), at.y_m + float(lean[1]), foot[2] + top_m)
            radius = log_uniform(rng, 0.04, 0.15)
            pole = round_pole(f"pole{number}_{k}", foot, top, radius, some_seed(rng), kind)
            found.append(thing(f"pole{number}_{k}", "pole", [pole]))
            if at.outermost or rng.random() < 0.25:
                stays.append(stay(here, top, np.sign(at.x_m) * rng.uniform(0.3, 0.6) * top_m, 0.0, rng))
    y = float(rng.uniform(-0.5, 0.5))
    top = (0.0, y, here.ground_m(0.0, y) + top_m)
    met = round_pole(
        "target_pole", here.foot_m(0.0, y), top, log_uniform(rng, 0.08, 0.3), some_seed(rng), kind
    )
    away_m = float(rng.uniform(0.3, 0.6)) * top_m
    own = [stay(here, top, 0.3 * away_m, side * away_m, rng) for side in (-1, 1)]
    holding = thing("stays", "wire", all_of(*stays, *own).solids("stay"))
    target = thing("target", "pole", [met], target=True)
    return scene_of(here, [target, holding, *found], background(here))


def stay(
    here: Site, top_m: tuple[float, float, float], ahead_m: float, aside_m: float, rng: np.random.Generator
) -> Rods:
    anchor = here.foot_m(top_m[0] + ahead_m, top_m[1] + aside_m)
    return strand(anchor, top_m, float(rng.uniform(0.004, 0.008)), 0.002, rng)


def rows(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, BETWEEN_ROWS, OPEN_COUNTRY)
    return (hop_field if here.draws("rows").random() < 0.5 else avenue)(here)
