"""Random scenes of everything there is, with labels to develop and test the segmentation on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vista_eval.render.scene import Haze, Scene, Thing, bounds_m
from vista_eval.worlds import street, things, vegetation, vehicle, yard
from vista_eval.worlds.ground import KINDS, MEAN_ALBEDO, ground
from vista_eval.worlds.landscape import far_houses, forest, hills, tree_row

NEAREST_M, FARTHEST_M = 12.0, 90.0
MOST_TRIES = 30
PIXEL_PER_RANGE = 1e-3  # of the paper's rig


@dataclass(frozen=True)
class Viewpoint:
    """The camera's body: at x = 0, y = 0, looking along +x. Positive pitch is nose down."""

    altitude_m: float
    roll_deg: float
    pitch_deg: float


@dataclass(frozen=True)
class Site:
    """Where a thing is to stand and how fine its detail has to be."""

    name: str
    foot_m: tuple[float, float, float]
    altitude_m: float  # the camera's
    seed: int

    @property
    def tuft_m(self) -> float:
        """Leaves some six pixels across."""
        return float(np.clip(6 * PIXEL_PER_RANGE * self.foot_m[0], 0.09, 0.5))


def leafy(form: str, low_m: float, high_m: float) -> Callable[[Site, np.random.Generator], Thing]:
    def build(site: Site, rng: np.random.Generator) -> Thing:
        return things.tree(site.name, form, site.foot_m, rng.uniform(low_m, high_m), site.seed, site.tuft_m)

    return build


def bush(site: Site, rng: np.random.Generator) -> Thing:
    shape = vegetation.bush(rng.uniform(0.8, 2.6), rng.uniform(0.7, 1.8), rng, site.tuft_m)
    return things.one(site.name, "bush", shape, site.foot_m)


def hedge(site: Site, rng: np.random.Generator) -> Thing:
    shape = vegetation.hedge(rng.uniform(4, 12), rng.uniform(1.0, 2.2), rng)
    return things.one(site.name, "hedge", shape, site.foot_m, rng.uniform(-50, 50))


def parked(build: Callable, kind: str) -> Callable[[Site, np.random.Generator], Thing]:
    def at(site: Site, rng: np.random.Generator) -> Thing:
        paint = rng.choice([0.05, 0.12, 0.3, 0.5, 0.75]) * rng.uniform(0.8, 1.1)
        return things.one(site.name, kind, build(paint, rng), site.foot_m, rng.uniform(0, 360))

    return at


def board_sign(site: Site, rng: np.random.Generator) -> Thing:
    z = max(1.5, site.altitude_m + rng.uniform(-1.5, 1.0))
    return things.sign(z, site.seed, *site.foot_m[:2])


def foamcore_pole(site: Site, rng: np.random.Generator) -> Thing:
    z = max(1.2, site.altitude_m + rng.uniform(-1.5, 1.0))
    return things.foamcore_pole(z, site.seed, *site.foot_m[:2])


def thin_post(site: Site, rng: np.random.Generator) -> Thing:
    height, radius = rng.uniform(2.5, 9), rng.uniform(0.03, 0.12)
    low, high = rng.uniform(0.05, 0.3), rng.uniform(0.3, 0.8)
    shape = street.banded_post(height, radius, low, high, rng.uniform(0.2, 1.2))
    return things.one(site.name, "post", shape, site.foot_m)


def lamp_post(site: Site, rng: np.random.Generator) -> Thing:
    shape = street.lamp_post(rng.uniform(4.5, 9), rng)
    return things.one(site.name, "lamp post", shape, site.foot_m, rng.choice([0.0, 180.0]))


def gantry(site: Site, rng: np.random.Generator) -> Thing:
    shape = street.gantry(rng.uniform(8, 22), rng.uniform(6, 12))
    return things.one(site.name, "gantry", shape, site.foot_m, rng.uniform(-15, 15))


def bale(site: Site, rng: np.random.Generator) -> Thing:
    return things.bale(site.name, site.foot_m, rng.uniform(0, 180), site.seed, rng.uniform(0.6, 0.9))


def crates(site: Site, rng: np.random.Generator) -> Thing:
    return things.one(site.name, "crates", yard.crates(rng), site.foot_m, rng.uniform(0, 90))


def person(site: Site, rng: np.random.Generator) -> Thing:
    return things.one(site.name, "person", yard.person(rng), site.foot_m, rng.uniform(0, 360))


def picket_fence(site: Site, rng: np.random.Generator) -> Thing:
    shape = yard.picket_fence(
        rng.uniform(5, 14), rng.uniform(0.9, 1.8), rng.uniform(0.1, 0.2), rng, rng.uniform(0.2, 0.75)
    )
    return things.one(site.name, "fence", shape, site.foot_m, rng.uniform(-45, 45))


def rail_fence(site: Site, rng: np.random.Generator) -> Thing:
    shape = yard.rail_fence(2.5 * rng.integers(3, 8), rng.uniform(1.0, 1.5), rng)
    return things.one(site.name, "fence", shape, site.foot_m, rng.uniform(-60, 60))


def ends_of(site: Site, width_m: float, yaw_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """Left and right foot of an upright plane seen from -x."""
    half = width_m / 2 * np.array([np.sin(np.radians(yaw_deg)), -np.cos(np.radians(yaw_deg)), 0.0])
    return np.array(site.foot_m) - half, np.array(site.foot_m) + half


def wall(site: Site, rng: np.random.Generator) -> Thing:
    ends = ends_of(site, rng.uniform(3, 12), rng.uniform(-50, 50))
    plain = bool(rng.random() < 0.25)
    return things.wall(
        site.name,
        *ends,
        rng.uniform(1.2, 3.5),
        rng.uniform(0.15, 0.65),
        site.seed,
        bool(rng.random() < 0.5),
        plain,
    )


def house(site: Site, rng: np.random.Generator) -> Thing:
    ends = ends_of(site, rng.uniform(7, 18), rng.choice([0.0, rng.uniform(-60, 60)]))
    style = street.any_style(rng)
    height = street.FLOOR_M * rng.integers(1, 5) + 0.8
    with_balconies, texel_m = bool(rng.random() < 0.3), max(street.TEXEL_M, 0.6e-3 * site.foot_m[0])
    return things.house(
        site.name, *ends, height, rng.uniform(6, 10), style, site.seed, with_balconies, texel_m
    )


# Kind -> (how often, nearest range in metres, how it is built).
STANDING: dict[str, tuple[float, float, Callable[[Site, np.random.Generator], Thing]]] = {
    "sign": (1.5, NEAREST_M, board_sign),
    "pole": (1.5, NEAREST_M, foamcore_pole),
    "thin post": (1.5, NEAREST_M, thin_post),
    "lamp post": (1.0, NEAREST_M, lamp_post),
    "broadleaf": (1.4, 20.0, leafy("broadleaf", 4, 13)),
    "conifer": (1.0, 18.0, leafy("conifer", 4, 14)),
    "poplar": (0.6, 18.0, leafy("poplar", 6, 15)),
    "bare": (0.7, 18.0, leafy("bare", 5, 10)),
    "bush": (1.2, NEAREST_M, bush),
    "hedge": (0.6, 15.0, hedge),
    "car": (1.5, NEAREST_M, parked(vehicle.car, "car")),
    "van": (1.0, 15.0, parked(vehicle.van, "van")),
    "bale": (1.2, NEAREST_M, bale),
    "crates": (1.0, NEAREST_M, crates),
    "person": (1.0, NEAREST_M, person),
    "picket fence": (0.5, 14.0, picket_fence),
    "rail fence": (0.5, 14.0, rail_fence),
    "wall": (0.8, 14.0, wall),
    "house": (0.9, 28.0, house),
    "gantry": (0.4, 25.0, gantry),
}


def plan_radius_m(thing: Thing) -> tuple[np.ndarray, float]:
    """Middle and radius of a circle on the ground around the thing."""
    lows, highs = zip(*(bounds_m(solid) for solid in thing.solids), strict=True)
    low, high = np.min(lows, axis=0)[:2], np.max(highs, axis=0)[:2]
    return (low + high) / 2, float(np.linalg.norm(high - low)) / 2


def standing_things(count: int, altitude_m: float, seed: int) -> list[Thing]:
    """`count` things in view that do not stand in each other."""
    rng = np.random.default_rng((seed, 1))
    kinds = list(STANDING)
    often = np.array([STANDING[kind][0] for kind in kinds])
    placed: list[Thing] = []
    unique = {"sign", "pole"}  # one name each
    for attempt in range(MOST_TRIES):
        if len(placed) == count:
            break
        kind = kinds[rng.choice(len(kinds), p=often / often.sum())]
        if kind in unique and any(thing.kind == kind for thing in placed):
            continue
        _, nearest, build = STANDING[kind]
        # As many at each distance as at its double.
        x = nearest * (FARTHEST_M / nearest) ** rng.uniform(0, 1)
        y = x * rng.uniform(-0.27, 0.27)
        site = Site(f"{kind}{attempt}", (x, y, 0.0), altitude_m, int(rng.integers(1 << 30)))
        thing = build(site, rng)
        middle, radius = plan_radius_m(thing)
        circles = (plan_radius_m(other) for other in placed)
        apart = all(np.linalg.norm(middle - m) > 0.8 * (radius + r) for m, r in circles)
        if apart and middle[0] - radius > 0.7 * NEAREST_M:
            placed.append(thing)
    return placed


def any_light(rng: np.random.Generator, elevation_deg: float, albedo: float) -> dict:
    """Sun or cloud, and the exposure that shows the ground as a camera's automatic would, give or take."""
    overcast = bool(rng.random() < 0.35)
    sun = float(rng.uniform(0.0, 0.8) if overcast else rng.uniform(2.8, 4.6))
    fill = float(rng.uniform(2.0, 2.6) if overcast else rng.uniform(0.9, 1.6))
    falling = sun * np.sin(np.radians(elevation_deg)) + 0.55 * fill
    exposure = rng.uniform(0.22, 0.42) / (albedo * falling / np.pi)
    exposure = float(np.clip(exposure, 0.6, 3.0))
    return {
        "sun_irradiance": sun,
        "fill_irradiance": fill,
        "sky": "overcast" if overcast else "blue",
        "overcast_radiance": float(rng.uniform(0.5, 1.3)) / exposure,
        "exposure": exposure,
    }


def random_scene(seed: int) -> tuple[Scene, Viewpoint]:
    """2 to 7 standing things at 12 to 90 m before a camera; the same seed gives the same scene."""
    rng = np.random.default_rng((seed, 0))
    altitude = float(rng.uniform(2.5, 9.0))
    view = Viewpoint(altitude, float(rng.normal(0, 1.2)), float(rng.uniform(-1.5, 3.0)))
    kind = list(KINDS)[rng.choice(len(KINDS), p=[0.35, 0.25, 0.12, 0.14, 0.14])]
    contrast = float(rng.uniform(0.6 if kind == "asphalt" else 0.15, 0.85))
    scenery: list[Thing] = [ground(kind, altitude, 0.0, 0.0, seed, contrast)]
    background = rng.choice(["trees", "forest", "houses", "open", "both"], p=[0.3, 0.2, 0.2, 0.15, 0.15])
    far_m = float(rng.uniform(95, 170))
    if background in ("trees", "both"):
        scenery.append(tree_row((far_m, far_m + 30), 0.45 * far_m + 8, seed))
    if background in ("houses", "both"):
        scenery += far_houses(far_m - 5 if background == "houses" else far_m + 40, seed)
    if background in ("forest", "trees"):
        scenery.append(forest(far_m + 60, seed))
    scenery.append(hills(altitude, seed))
    if rng.random() < 0.25:
        x = rng.uniform(15, 45)
        place = (x, x * rng.uniform(-0.2, 0.2))
        size = (rng.uniform(2, 5), rng.uniform(3, 8))
        scenery.append(
            things.tarpaulin(
                "tarpaulin", place, *size, rng.uniform(0, 180), rng.choice([0.06, 0.3, 0.7]), seed
            )
        )
    azimuth, elevation = np.radians(rng.uniform(0, 360)), np.radians(rng.uniform(8, 65))
    to_sun = (np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation))
    light = any_light(rng, np.degrees(elevation), MEAN_ALBEDO[kind])
    haze = None
    if rng.random() < 0.3:
        haze = Haze(3.9 / float(rng.uniform(400, 2500)), float(rng.uniform(0.4, 0.9)) / light["exposure"])
    things_ = standing_things(int(rng.integers(2, 8)), altitude, seed)
    east, north, up = (float(c) for c in to_sun)
    scene = Scene((*things_, *scenery), to_sun=(east, north, up), haze=haze, **light)
    return scene, view
