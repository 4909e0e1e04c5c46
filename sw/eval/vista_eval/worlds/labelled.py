"""Single scenes drawn at random, which the segmentation is tuned and scored on.

Each is a flight of one frame, scene_NNNN of seed NNNN; even seeds are the group dev."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vista_eval.render.course import Course
from vista_eval.render.flight import Flight
from vista_eval.render.scene import Scene, Thing, bounds_m
from vista_eval.worlds import things
from vista_eval.worlds.draws import draws, some_seed
from vista_eval.worlds.grounds import COUNTRY_AND_TOWN, COVERS
from vista_eval.worlds.laying import ground
from vista_eval.worlds.light import light
from vista_eval.worlds.path import path_of
from vista_eval.worlds.site import Site, background
from vista_eval.worlds.standing import NEAREST_M, STANDING, Place

FARTHEST_M = 90.0
MOST_TRIES = 30
LAST_RANGE_M = 0.1  # the camera stands where the scene begins


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
        place = Place(f"{kind}{attempt}", (x, y, 0.0), altitude_m, some_seed(rng))
        thing = build(place, rng)
        middle, radius = plan_radius_m(thing)
        circles = (plan_radius_m(other) for other in placed)
        apart = all(np.linalg.norm(middle - m) > 0.8 * (radius + r) for m, r in circles)
        if apart and middle[0] - radius > 0.7 * NEAREST_M:
            placed.append(thing)
    return placed


def course_of(seed: int) -> Course:
    rng = draws(seed, "view")
    altitude_m, climb_deg, phase_s = (float(rng.uniform(*span)) for span in ((2.5, 9), (-3, 1.5), (0, 1000)))
    return Course(
        altitude_m, 10.0, LAST_RANGE_M, 1, 10.0, climb_deg=climb_deg, sway_phase_s=phase_s, sway_scale=2.0
    )


def labelled_scene(altitude_m: float, seed: int) -> Scene:
    """2 to 7 standing things at 12 to 90 m before the camera."""
    rng = draws(seed, "scene")
    cover, contrast = str(rng.choice(COUNTRY_AND_TOWN)), float(rng.uniform(0.3, 0.9))
    course = replace(course_of(seed), frames=9)  # the ground is laid along a path
    here = Site(seed, altitude_m, course, path_of(course), cover, contrast)
    scenery = [ground(here.path, altitude_m, cover, contrast, seed, None, False), *background(here)]
    if rng.random() < 0.25:
        x, width, length = rng.uniform([15, 2, 3], [45, 5, 8])
        place, shade = (x, x * rng.uniform(-0.2, 0.2)), rng.choice([0.06, 0.3, 0.7])
        scenery.append(things.tarpaulin("tarpaulin", place, width, length, rng.uniform(0, 180), shade, seed))
    standing = standing_things(int(rng.integers(2, 8)), altitude_m, seed)
    return Scene((*standing, *scenery), **light(seed, COVERS[cover].mean))


def labelled(seed: int) -> Flight:
    name, title = f"scene_{seed:04d}", f"random scene {seed}"
    return Flight(name, title, "test" if seed % 2 else "dev", course_of(seed), labelled_scene, seed=seed)
