"""Flights over open country, as the paper's: towards x = 0 at constant altitude, sign or pole on a stand.

Every function: altitude in metres and seed -> the scene. The aircraft flies along y = 0 from FIRST_X_M at
the earliest to LAST_X_M at the latest (at the brick pier on to x = -4, which it hides the ground from); what
moves is where it is in the last frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vista_eval.render.course import Course
from vista_eval.render.scene import Haze, Point, Scene, Sway, Thing, thing
from vista_eval.worlds import street, things, vegetation, vehicle, yard
from vista_eval.worlds.landscape import forest, hills, tree_row
from vista_eval.worlds.laying import ground
from vista_eval.worlds.path import path_of

FIRST_X_M, LAST_X_M = -92.0, -8.0
AFTERNOON_SUN = (-0.62, 0.48, 0.62)  # over the aircraft's left shoulder
NOON_SUN = (-0.25, -0.35, 0.9)
PIER_TEXEL_M = 0.01  # seen from 4 m, where a pixel is 4 mm
GANTRY_X_M = 140 * 0.3048
BREEZE = Sway(amplitude_m=0.12, frequency_hz=0.55)

BALES = ((3, -5.5, 70), (9, 9.5, 20), (24, -12.5, 100), (31, 6.5, 50), (52, 17, 10), (47, -7, 80))


def level_ground(cover: str, altitude_m: float, seed: int) -> Thing:
    course = Course(altitude_m, LAST_X_M - FIRST_X_M, -LAST_X_M, 2, 1.0, sway_scale=0.0)
    return ground(path_of(course), altitude_m, cover, 0.5, seed, None, False)


def country(
    altitude_m: float, seed: int, kind: str = "meadow", sway: Sway | None = None
) -> tuple[Thing, ...]:
    """Ground, a line of trees 100 m behind the target, forest behind it."""
    trees = tree_row((98.0, 130.0), 75.0, seed, sway=sway)
    return level_ground(kind, altitude_m, seed), trees, forest(185.0, seed)


def bales(seed: int) -> list[Thing]:
    return [things.bale(f"bale{k}", (x, y, 0), yaw, seed + k) for k, (x, y, yaw) in enumerate(BALES)]


def parked(name: str, kind: str, x_m: float, y_m: float, yaw_deg: float, paint: float, seed: int) -> Thing:
    build = {"car": vehicle.car, "van": vehicle.van}[kind]
    return things.one(name, kind, build(paint, np.random.default_rng((seed, 5))), (x_m, y_m, 0.0), yaw_deg)


def tarpaulins(seed: int) -> list[Thing]:
    places = ((-14.0, 3.0, 12.0, 0.72), (-31.0, -5.0, 95.0, 0.06), (14.0, -2.5, 30.0, 0.45))
    return [
        things.tarpaulin(f"tarpaulin{k}", (x, y), 4.0, 6.0, yaw, albedo, seed + k)
        for k, (x, y, yaw, albedo) in enumerate(places)
    ]


def gantry() -> Thing:
    """Spans the path behind the target, its wire far above it."""
    shape = street.gantry(18.0, 14.0).moved((GANTRY_X_M, 0.0, 0.0))
    return thing("gantry", "gantry", shape.solids("gantry"))


def paper_site(target: Thing, altitude_m: float, seed: int) -> Scene:
    """What the paper's pictures show: bales, cars, a van, the gantry and its wire, tarpaulins, trees."""
    return Scene(
        (
            target,
            *country(altitude_m, seed),
            *bales(seed),
            parked("car0", "car", 17.0, -8.0, 62.0, 0.55, seed),
            parked("car1", "car", 38.0, 13.0, 130.0, 0.08, seed + 1),
            parked("van", "van", 28.0, -17.0, 80.0, 0.7, seed),
            gantry(),
            *tarpaulins(seed),
        ),
        to_sun=AFTERNOON_SUN,
        exposure=1.3,
    )


def sign_site(altitude_m: float, seed: int) -> Scene:
    return paper_site(things.sign(altitude_m, seed), altitude_m, seed)


def pole_site(altitude_m: float, seed: int) -> Scene:
    return paper_site(things.foamcore_pole(altitude_m, seed), altitude_m, seed)


def sign_site_at_noon(altitude_m: float, seed: int) -> Scene:
    return replace(sign_site(altitude_m, seed), to_sun=NOON_SUN, exposure=1.1)


def before_hills(scene: Scene, altitude_m: float, seed: int) -> Scene:
    """Puts hills behind sites whose tree line leaves some of the horizon in view."""
    return replace(scene, things=(*scene.things, hills(altitude_m, seed)))


def sign_site_before_hills(altitude_m: float, seed: int) -> Scene:
    return before_hills(sign_site(altitude_m, seed), altitude_m, seed)


def pole_site_in_shade(altitude_m: float, seed: int) -> Scene:
    """A thin cloud before the sun."""
    scene = before_hills(pole_site(altitude_m, seed), altitude_m, seed)
    return replace(scene, sun_irradiance=1.4, fill_irradiance=1.7, exposure=1.9)


def overcast_sign(altitude_m: float, seed: int) -> Scene:
    """White sign before a white sky without any texture; the mown field reaches to the horizon."""
    field = level_ground("stubble", altitude_m, seed)
    everything = (things.sign(altitude_m, seed), field, *bales(seed))
    scene = Scene(everything, to_sun=(0.0, 0.0, 1.0), sky="overcast")
    return replace(scene, sun_irradiance=0.5, fill_irradiance=2.2, overcast_radiance=0.62, exposure=1.4)


def low_sun_pole(altitude_m: float, seed: int) -> Scene:
    """Seven degrees above the horizon, ahead and to the right: long shadows, faces in the dark."""
    scene = Scene(
        (
            things.foamcore_pole(altitude_m, seed),
            *country(altitude_m, seed, "soil"),
            *bales(seed),
            parked("car0", "car", 12.0, 7.0, 35.0, 0.3, seed),
            hills(altitude_m, seed),
        ),
        to_sun=(0.55, -0.82, 0.122),
    )
    return replace(scene, sun_irradiance=3.4, fill_irradiance=1.2, exposure=2.6)


def hazy_sign(altitude_m: float, seed: int) -> Scene:
    """300 m visibility."""
    scene = sign_site(altitude_m, seed)
    return replace(scene, haze=Haze(3.9 / 300.0, 0.55), sun_irradiance=2.4, fill_irradiance=1.4, exposure=1.3)


def bush(
    name: str, x_m: float, y_m: float, size_m: tuple[float, float], rng: np.random.Generator, **more
) -> Thing:
    return things.one(name, "bush", vegetation.bush(*size_m, rng), (x_m, y_m, 0.0), **more)


def windy_pole(altitude_m: float, seed: int) -> Scene:
    """Crowns and bushes move while the aircraft passes."""
    rng = np.random.default_rng((seed, 6))
    places = ((-22.0, 6.0), (-8.0, -6.5), (6.0, 7.5), (20.0, -9.0), (34.0, 9.0), (16.0, 3.0))
    bushes = [
        bush(f"bush{k}", x, y, (rng.uniform(1.2, 2.4), rng.uniform(0.9, 1.6)), rng, sway=BREEZE)
        for k, (x, y) in enumerate(places)
    ]
    trees = [
        things.swaying_tree(f"tree{k}", (x, y, 0.0), 8.0 + k, seed + k, BREEZE)
        for k, (x, y) in enumerate(((12.0, -13.0), (26.0, 14.0), (45.0, -15.0)))
    ]
    scenery = (*country(altitude_m, seed, sway=BREEZE), *bushes, *trees, hills(altitude_m, seed))
    return Scene((things.foamcore_pole(altitude_m, seed), *scenery), to_sun=AFTERNOON_SUN)


def fenced_sign(altitude_m: float, seed: int) -> Scene:
    """Picket fences across the way, below the path: one before the sign, two behind it."""
    rng = np.random.default_rng((seed, 7))
    sizes = ((30.0, 1.8, 0.16, 0.65), (44.0, 2.0, 0.24, 0.6), (60.0, 2.0, 0.2, 0.3))
    fences = []
    for k, (x, size) in enumerate(zip((-20.0, 6.0, 30.0), sizes, strict=True)):
        length, height, pitch, albedo = size
        shape = yard.picket_fence(length, height, pitch, rng, albedo)
        fences.append(things.one(f"fence{k}", "fence", shape, (x, 0.0, 0.0)))
    scenery = (*country(altitude_m, seed), *fences, hills(altitude_m, seed))
    return Scene((things.sign(altitude_m, seed), *scenery), to_sun=NOON_SUN)


def thin_pole(altitude_m: float, seed: int) -> Scene:
    """A banded post, 7 cm across and 3 m taller than the path is high."""
    post = street.banded_post(altitude_m + 3.0, 0.035, 0.08, 0.7, 0.5)
    target = things.one("thin_pole", "post", post, target=True)
    scenery = (*country(altitude_m, seed), *bales(seed), hills(altitude_m, seed))
    return Scene((target, *scenery), to_sun=AFTERNOON_SUN)


def lone_tree(altitude_m: float, seed: int) -> Scene:
    """A lime whose crown is in the way, bushes below it."""
    rng = np.random.default_rng((seed, 8))
    tree = things.tree("tree", "broadleaf", (0.0, 0.3, 0.0), 1.7 * altitude_m, seed, 0.14, target=True)
    places = ((-6.0, -5.0), (4.0, 6.0), (18.0, -7.0))
    bushes = [bush(f"bush{k}", x, y, (1.6, 1.2), rng) for k, (x, y) in enumerate(places)]
    car = parked("car0", "car", 8.0, -9.0, 20.0, 0.4, seed)
    return Scene((tree, *country(altitude_m, seed, "gravel"), *bushes, car), to_sun=NOON_SUN)


def brick_pier(altitude_m: float, seed: int) -> Scene:
    """The pier of a bridge that is gone, inspected: it fills the view before the flight ends at its face."""
    ends = (0.0, 1.6, 0.0), (0.0, -1.6, 0.0)
    pier = things.wall(
        "pier", *ends, altitude_m + 1.2, 0.3, seed, bricks=True, texel_m=PIER_TEXEL_M, target=True
    )
    scenery = (*country(altitude_m, seed), *bales(seed), hills(altitude_m, seed))
    return Scene((pier, *scenery), to_sun=AFTERNOON_SUN, exposure=1.3)


def plain_wall(altitude_m: float, seed: int) -> Scene:
    """A freshly painted wall without any texture stands across the path."""
    ends = (0.0, 8.0, 0.0), (0.0, -8.0, 0.0)
    target = things.wall("wall", *ends, altitude_m + 3.0, 0.5, seed, plain=True, target=True)
    others = (*bales(seed), parked("van", "van", -12.0, 9.0, 70.0, 0.6, seed))
    return Scene((target, *country(altitude_m, seed, "gravel"), *others), to_sun=AFTERNOON_SUN)


def drone(place_m: Point, velocity_m_s: Point, rng: np.random.Generator) -> Thing:
    return things.one("drone", "drone", vehicle.drone(rng), place_m, target=True, velocity_m_s=velocity_m_s)


def approaching_drone(altitude_m: float, seed: int) -> Scene:
    """A delivery drone comes the other way at 2 m/s; a van drives along beside the path."""
    rng = np.random.default_rng((seed, 9))
    target, shape = drone((0.0, 0.3, altitude_m), (-2.0, 0.0, 0.0), rng), vehicle.van(0.65, rng)
    van = things.one("van", "van", shape, (6.0, -8.0, 0.0), 5.0, velocity_m_s=(3.0, 0.26, 0.0))
    return Scene((target, *country(altitude_m, seed), *bales(seed)[1:3], van), to_sun=NOON_SUN)


def crossing_drone(altitude_m: float, seed: int) -> Scene:
    """A drone comes from the right and is in the way for the last two seconds."""
    target = drone((0.0, 0.2, altitude_m), (0.0, 0.8, 0.0), np.random.default_rng((seed, 10)))
    scenery = (*country(altitude_m, seed, "stubble"), *bales(seed))
    return Scene((target, *scenery), to_sun=AFTERNOON_SUN)


def clear_meadow(altitude_m: float, seed: int) -> Scene:
    """Nothing in the way: all that stands is low or aside."""
    scene = paper_site(parked("car2", "car", -6.0, 5.0, 15.0, 0.2, seed), altitude_m, seed)
    return replace(scene, to_sun=NOON_SUN)


def clear_fences(altitude_m: float, seed: int) -> Scene:
    """A flight over fences and hedges, well below the path."""
    rng = np.random.default_rng((seed, 11))
    rows: list[Thing] = []
    for k, x in enumerate((-48.0, -25.0, -4.0, 18.0, 40.0)):
        shape = vegetation.hedge(46.0, 1.5, rng) if k % 2 else yard.picket_fence(50.0, 1.6, 0.18, rng)
        kind = "hedge" if k % 2 else "fence"
        rows.append(things.one(f"{kind}{k}", kind, shape, (x, 0.0, 0.0), rng.uniform(-8, 8)))
    return Scene((*rows, *country(altitude_m, seed, "stubble")), to_sun=AFTERNOON_SUN)
