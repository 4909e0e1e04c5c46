"""Forests: trees as a Poisson process, and the forest with poles of the ICST 2027 track.

poisson   0.0625 trees a square metre (Agile Autonomy, YOPO), flown at 2 m height over 45 m. The originals are
          of Unity; here four of five trees have a bare trunk of 0.1 to 0.35 m radius, the others are young
          spruces.
forest    0.012 to 0.12 trees a square metre, at least 2 m apart, in a field of 20 m to each side; a lane of 2
          to 12 m cleared along the route; up to 10 poles of radius 0.02 to 0.10 m and height 1 to 5 m in the
          lane, 3 m off every waypoint and 1.5 m apart; 2 to 4 waypoints, legs of 8 to 34 m, turns of 25 to
          160 degrees, wind of 0 to 8 m/s, 1.2 to 3.5 m/s, 0.5 to 4 m high, a vehicle of radius 0.444 m
          (IDeaLS-Lab/uav-testing-track-2027). The original has PX4 and EGO-Planner with a depth camera of 87
          degrees in Isaac Sim, uneven terrain, and up to 6 waypoints; the ground is level here, and the trees
          are those of `poisson`."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from vista_eval.closed_loop.places import parts
from vista_eval.closed_loop.world import World
from vista_eval.render.course import Gusts
from vista_eval.render.scene import Point, Thing
from vista_eval.worlds.draws import draws, log_uniform, seed_of
from vista_eval.worlds.grounds import WOODED

DENSITY_PER_M2, POISSON_HEIGHT_M, POISSON_WAY_M = 0.0625, 2.0, 45.0
AREA_M, MARGIN_M = 20.0, 3.0
SWEPT_RADIUS_M = 0.444
LEG_M, TURN_DEG = (8.0, 34.0), (25.0, 160.0)


def build_poisson(number: int, seed: int, speed_m_s: float | None) -> World:
    own = seed_of(seed, "poisson", number)
    rng = draws(own, "places")
    x, y = (-4.0, POISSON_WAY_M + 12.0), (-14.0, 14.0)
    count = int(rng.poisson(DENSITY_PER_M2 * (x[1] - x[0]) * (y[1] - y[0])))
    places = [(float(rng.uniform(*x)), float(rng.uniform(*y))) for _ in range(count)]
    start, goal = (0.0, 0.0, POISSON_HEIGHT_M), (POISSON_WAY_M, 0.0, POISSON_HEIGHT_M)
    places = parts.away_from(places, [(start, 3.0), (goal, 3.0)])
    cover = str(rng.choice(WOODED))
    scene = parts.scene(own, cover, parts.trees(places, own), (-6.0, 62.0), (-18.0, 18.0))
    return World(
        f"poisson_{number:03d}", "poisson", scene, (start, goal), speed_m_s or 5.0, room_m=0.8, seed=own
    )


def build_forest(number: int, seed: int, speed_m_s: float | None) -> World:
    own = seed_of(seed, "forest", number)
    rng = draws(own, "forest")
    height = float(rng.uniform(0.8, 4.0))
    route = route_of(rng, height)
    lane = float(rng.uniform(2.0, 12.0))
    standing = parts.trees(wood(rng, route, lane), own, young=0.15)
    standing += poles(rng, route, lane)
    wind, towards = float(rng.uniform(0.0, 8.0)), float(rng.uniform(0, 2 * np.pi))
    scene = parts.scene(
        own, str(rng.choice(WOODED)), standing, (-AREA_M - 4, AREA_M + 4), (-AREA_M - 4, AREA_M + 4)
    )
    return World(
        f"forest_{number:03d}",
        "forest",
        scene,
        route,
        speed_m_s or float(rng.uniform(1.2, 3.5)),
        radius_m=SWEPT_RADIUS_M,
        room_m=0.8,
        wind_m_s=(wind * float(np.cos(towards)), wind * float(np.sin(towards)), 0.0),
        gusts=Gusts(0.1 * wind, own),
        seed=own,
    )


def route_of(rng: np.random.Generator, height_m: float) -> tuple[Point, ...]:
    most, legs = AREA_M - MARGIN_M, int(rng.integers(1, 4))
    while True:
        points = rng.uniform(-most, most, (legs + 1, 2))
        steps = np.diff(points, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        headings = np.degrees(np.arctan2(steps[:, 1], steps[:, 0]))
        turns = np.abs((np.diff(headings) + 180) % 360 - 180)
        fits = np.all((lengths >= LEG_M[0]) & (lengths <= LEG_M[1]))
        if fits and np.all((turns >= TURN_DEG[0]) & (turns <= TURN_DEG[1])):
            return tuple((float(x), float(y), height_m) for x, y in points)


def off_route_m(x: float, y: float, route: tuple[Point, ...]) -> float:
    return min(parts.distance_to_leg_m(x, y, a, b) for a, b in pairwise(route))


def wood(rng: np.random.Generator, route: tuple[Point, ...], lane_m: float) -> list[tuple[float, float]]:
    wanted = round(log_uniform(rng, 0.012, 0.12) * (2 * AREA_M) ** 2)
    found: list[tuple[float, float]] = []
    for _ in range(30 * wanted):
        x, y = (float(c) for c in rng.uniform(-AREA_M, AREA_M, 2))
        near = any(np.hypot(x - a, y - b) < 2.0 for a, b in found)
        if not near and off_route_m(x, y, route) > lane_m / 2:
            found.append((x, y))
        if len(found) >= wanted:
            break
    return found


def poles(rng: np.random.Generator, route: tuple[Point, ...], lane_m: float) -> list[Thing]:
    found: list[tuple[float, float]] = []
    wanted = int(rng.integers(0, 11))
    for _ in range(40 * wanted):
        if len(found) >= wanted:
            break
        leg = int(rng.integers(len(route) - 1))
        a, b = np.array(route[leg][:2]), np.array(route[leg + 1][:2])
        along = (b - a) / np.linalg.norm(b - a)
        aside = np.array([-along[1], along[0]]) * rng.uniform(-lane_m / 2, lane_m / 2)
        x, y = (float(c) for c in a + rng.uniform(0, 1) * (b - a) + aside)
        near = any(np.hypot(x - px, y - py) < 1.5 for px, py in found)
        if not near and all(np.hypot(x - w[0], y - w[1]) > 3.0 for w in route):
            found.append((x, y))
    return [
        parts.pole(
            f"pole{k}",
            at,
            float(rng.uniform(0.02, 0.10)),
            float(rng.uniform(1, 5)),
            float(rng.uniform(0.2, 0.6)),
        )
        for k, at in enumerate(found)
    ]
