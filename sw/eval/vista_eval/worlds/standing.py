"""Everything that stands on the ground, by kind, as a place wants it: how fine its detail has to be follows
from the range."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vista_eval.render.scene import Thing, thing
from vista_eval.worlds import street, things, vegetation, vehicle, yard

NEAREST_M = 12.0
PIXEL_PER_RANGE = 1e-3  # of the paper's rig


@dataclass(frozen=True)
class Place:
    """The place where a thing is to stand, and how fine its detail has to be."""

    name: str
    foot_m: tuple[float, float, float]
    altitude_m: float  # the camera's
    seed: int

    @property
    def tuft_m(self) -> float:
        """Leaves some six pixels across."""
        return float(np.clip(6 * PIXEL_PER_RANGE * self.foot_m[0], 0.09, 0.5))


def leafy(form: str, low_m: float, high_m: float) -> Callable[[Place, np.random.Generator], Thing]:
    def build(place: Place, rng: np.random.Generator) -> Thing:
        return things.tree(
            place.name, form, place.foot_m, rng.uniform(low_m, high_m), place.seed, place.tuft_m
        )

    return build


def bush(place: Place, rng: np.random.Generator) -> Thing:
    shape = vegetation.bush(rng.uniform(0.8, 2.6), rng.uniform(0.7, 1.8), rng, place.tuft_m)
    return things.one(place.name, "bush", shape, place.foot_m)


def hedge(place: Place, rng: np.random.Generator) -> Thing:
    shape = vegetation.hedge(rng.uniform(4, 12), rng.uniform(1.0, 2.2), rng)
    return things.one(place.name, "hedge", shape, place.foot_m, rng.uniform(-50, 50))


def parked(build: Callable, kind: str) -> Callable[[Place, np.random.Generator], Thing]:
    def at(place: Place, rng: np.random.Generator) -> Thing:
        paint = rng.choice([0.05, 0.12, 0.3, 0.5, 0.75]) * rng.uniform(0.8, 1.1)
        return things.one(place.name, kind, build(paint, rng), place.foot_m, rng.uniform(0, 360))

    return at


def board_sign(place: Place, rng: np.random.Generator) -> Thing:
    z = max(1.5, place.altitude_m + rng.uniform(-1.5, 1.0))
    return things.sign(z, place.seed, *place.foot_m[:2])


def foamcore_pole(place: Place, rng: np.random.Generator) -> Thing:
    z = max(1.2, place.altitude_m + rng.uniform(-1.5, 1.0))
    return things.foamcore_pole(z, place.seed, *place.foot_m[:2])


def thin_post(place: Place, rng: np.random.Generator) -> Thing:
    height, radius = rng.uniform(2.5, 9), rng.uniform(0.03, 0.12)
    low, high = rng.uniform(0.05, 0.3), rng.uniform(0.3, 0.8)
    shape = street.banded_post(height, radius, low, high, rng.uniform(0.2, 1.2))
    return things.one(place.name, "post", shape, place.foot_m)


def lamp_post(place: Place, rng: np.random.Generator) -> Thing:
    shape = street.lamp_post(rng.uniform(4.5, 9), rng)
    return things.one(place.name, "lamp post", shape, place.foot_m, rng.choice([0.0, 180.0]))


def gantry(place: Place, rng: np.random.Generator) -> Thing:
    shape = street.gantry(rng.uniform(8, 22), rng.uniform(6, 12))
    return thing(place.name, "gantry", shape.moved(place.foot_m, rng.uniform(-15, 15)).solids(place.name))


def bale(place: Place, rng: np.random.Generator) -> Thing:
    return things.bale(place.name, place.foot_m, rng.uniform(0, 180), place.seed, rng.uniform(0.6, 0.9))


def crates(place: Place, rng: np.random.Generator) -> Thing:
    return things.one(place.name, "crates", yard.crates(rng), place.foot_m, rng.uniform(0, 90))


def person(place: Place, rng: np.random.Generator) -> Thing:
    return things.one(place.name, "person", yard.person(rng), place.foot_m, rng.uniform(0, 360))


def picket_fence(place: Place, rng: np.random.Generator) -> Thing:
    shape = yard.picket_fence(
        rng.uniform(5, 14), rng.uniform(0.9, 1.8), rng.uniform(0.1, 0.2), rng, rng.uniform(0.2, 0.75)
    )
    return things.one(place.name, "fence", shape, place.foot_m, rng.uniform(-45, 45))


def rail_fence(place: Place, rng: np.random.Generator) -> Thing:
    shape = yard.rail_fence(2.5 * rng.integers(3, 8), rng.uniform(1.0, 1.5), rng)
    return things.one(place.name, "fence", shape, place.foot_m, rng.uniform(-60, 60))


def ends_of(place: Place, width_m: float, yaw_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """Left and right foot of an upright plane seen from -x."""
    half = width_m / 2 * np.array([np.sin(np.radians(yaw_deg)), -np.cos(np.radians(yaw_deg)), 0.0])
    return np.array(place.foot_m) - half, np.array(place.foot_m) + half


def wall(place: Place, rng: np.random.Generator) -> Thing:
    ends = ends_of(place, rng.uniform(3, 12), rng.uniform(-50, 50))
    plain = bool(rng.random() < 0.25)
    return things.wall(
        place.name,
        *ends,
        rng.uniform(1.2, 3.5),
        rng.uniform(0.15, 0.65),
        place.seed,
        bool(rng.random() < 0.5),
        plain,
    )


def house(place: Place, rng: np.random.Generator) -> Thing:
    ends = ends_of(place, rng.uniform(7, 18), rng.choice([0.0, rng.uniform(-60, 60)]))
    style = street.any_style(rng)
    height = street.FLOOR_M * rng.integers(1, 5) + 0.8
    with_balconies, texel_m = bool(rng.random() < 0.3), max(street.TEXEL_M, 0.6e-3 * place.foot_m[0])
    return things.house(
        place.name, *ends, height, rng.uniform(6, 10), style, place.seed, with_balconies, texel_m
    )


# Kind -> (how often, nearest range in metres, how it is built).
STANDING: dict[str, tuple[float, float, Callable[[Place, np.random.Generator], Thing]]] = {
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
