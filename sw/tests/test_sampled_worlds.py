"""Every family of sampled worlds: for any seed a scene that can be rendered, with something in the way where
the family says so and nothing where it does not."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from random_seed import seeded
from vista_eval.cache import content_sha256
from vista_eval.render.flight import Flight
from vista_eval.render.motion import solids_at
from vista_eval.render.scene import GroundStrip, HeightField, Scene, Thing, bounds_m
from vista_eval.worlds.sampled import buildings, laying
from vista_eval.worlds.sampled.catalog import COUNT, DEV, FAMILIES, SEED, TEST
from vista_eval.worlds.sampled.family import Family
from vista_eval.worlds.sampled.path import Path as FlownPath
from vista_eval.worlds.sampled.path import nearness_m, path_of

IN_THE_WAY_M = 1.0  # of the path, half the radius of the collision volume
BESIDE_M = 2.0  # what is not the target keeps out of the collision volume before it


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Textures take most of the time, and nothing here is seen."""
    whole = laying.albedo_of

    def small(patch: laying.Patch, *rest: object) -> np.ndarray:
        side = max(patch.x_m[1] - patch.x_m[0], patch.y_m[1] - patch.y_m[0])
        return whole(patch._replace(texel_m=side / 20, stretch=1), *rest)

    monkeypatch.setattr(laying, "albedo_of", small)
    monkeypatch.setattr(buildings, "FRONT_TEXEL_M", 0.1)
    monkeypatch.setattr(buildings, "OTHER_TEXEL_M", 0.25)
    yield


def any_flight(family: Family, stream: int) -> tuple[Flight, Scene]:
    flight = family.flight(int(seeded(stream).integers(1 << 20)), 0)
    return flight, flight.scene(flight.approach.altitude_m, flight.seed)


def is_ground(thing: Thing) -> bool:
    return isinstance(thing.solids[0], GroundStrip | HeightField)


def around(path: FlownPath, radius_m: float, low_m: float, high_m: float) -> FlownPath:
    """The part of the path between two x, with one radius all along."""
    kept = (path.points_m[:, 0] >= low_m) & (path.points_m[:, 0] <= high_m)
    return FlownPath(path.points_m[kept], np.full(int(kept.sum()), radius_m))


def height_m(ground: Thing, x_m: float, y_m: float) -> float:
    """Of the ground at a place, between the nodes of the patch that it lies in."""
    for solid in ground.solids:
        inside = solid.x_m[0] <= x_m <= solid.x_m[1] and solid.y_m[0] <= y_m <= solid.y_m[1]
        if inside and isinstance(solid, GroundStrip):
            return 0.0
        if inside:
            rows, columns = solid.height_m.shape
            row = (x_m - solid.x_m[0]) / (solid.x_m[1] - solid.x_m[0]) * (rows - 1)
            column = (y_m - solid.y_m[0]) / (solid.y_m[1] - solid.y_m[0]) * (columns - 1)
            r, c = min(int(row), rows - 2), min(int(column), columns - 2)
            a, b = row - r, column - c
            four = solid.height_m[r : r + 2, c : c + 2]
            return float(np.array([1 - a, a]) @ four @ np.array([1 - b, b]))
    raise AssertionError(f"no ground at {x_m}, {y_m}")


@pytest.mark.parametrize("name", FAMILIES)
def test_a_scene_of_any_seed_is_whole(name: str) -> None:
    flight, scene = any_flight(FAMILIES[name], 1)
    names = [solid.name for solid in scene.solids]
    assert len(set(names)) == len(names)
    assert len({thing.name for thing in scene.things}) == len(scene.things)
    for solid in scene.solids:
        assert np.all(np.isfinite(solid.albedo)) and 0 <= solid.albedo.min() <= solid.albedo.max() <= 1
        assert np.all(np.isfinite(bounds_m(solid)))
    assert np.linalg.norm(scene.to_sun) == pytest.approx(1.0) and 0.3 <= scene.exposure <= 3.0
    course = flight.approach
    assert 18 <= course.frames <= 40 and 3.0 <= course.speed_m_s <= 25.0 and 7.5 <= course.rate_hz <= 15.0
    assert (flight.family, flight.split) == (name, FAMILIES[name].split)


@pytest.mark.parametrize("name", FAMILIES)
def test_what_is_in_the_way_is_the_target_and_only_that(name: str) -> None:
    """In the last frame, where things that move are met."""
    family = FAMILIES[name]
    flight, scene = any_flight(family, 2)
    path = path_of(flight.approach)
    targets = [thing for thing in scene.things if thing.target]
    assert len(targets) == (0 if family.clear else 1)
    for thing in targets:
        if not is_ground(thing):
            met = around(path, IN_THE_WAY_M, -8.0, 8.0)
            assert min(nearness_m(solid, met) for solid in solids_at(thing, 0.0)) < 0.0
    before = around(path, BESIDE_M, -200.0, 200.0 if family.clear else -2.0)
    others = [thing for thing in scene.things if not thing.target and not is_ground(thing)]
    in_flock = name == "birds"
    for thing in others:
        near = min(nearness_m(solid, before) for solid in thing.solids)
        assert near > 0.0 or (in_flock and thing.kind == "bird"), thing.name


@pytest.mark.parametrize("name", FAMILIES)
def test_the_ground_is_met_where_it_is_the_target_and_nowhere_before(name: str) -> None:
    family = FAMILIES[name]
    flight, scene = any_flight(family, 3)
    (ground,) = [thing for thing in scene.things if is_ground(thing)]
    altitude, path = flight.approach.altitude_m, path_of(flight.approach)
    if ground.target:
        assert height_m(ground, 0.0, 0.0) == pytest.approx(altitude, abs=0.6)
    else:
        assert height_m(ground, 0.0, 0.0) <= altitude - (6.0 if family.name == "clear_crest" else 0.8)
    flown = path.points_m[path.points_m[:, 0] <= -flight.approach.last_range_m]
    seen = [p for p in flown if p[0] >= ground.solids[0].x_m[0]]
    assert all(p[2] - height_m(ground, p[0], p[1]) > 0.1 for p in seen[::4])
    if family.clear:
        ahead = [p for p in path.points_m[::4] if p[0] > ground.solids[0].x_m[0]]
        assert all(p[2] - height_m(ground, p[0], p[1]) > 2.2 for p in ahead)


def test_the_same_seed_makes_the_same_flight_and_another_another() -> None:
    for name in ("cable", "hillside"):
        family = FAMILIES[name]
        made = [
            content_sha256(flight.scene(flight.approach.altitude_m, flight.seed), flight.sensor)
            for flight in (family.flight(3, 1), family.flight(3, 1), family.flight(4, 1), family.flight(3, 2))
        ]
        assert made[0] == made[1] and len(set(made)) == 3


def test_there_are_enough_and_no_two_flights_share_a_seed() -> None:
    assert len(DEV) + len(TEST) >= 14 and len(TEST) >= 4
    assert {family.split for family in DEV} == {"dev"} and {family.split for family in TEST} == {"test"}
    flights = [flight for family in FAMILIES.values() for flight in family.flights(COUNT, SEED)]
    assert len(flights) >= 200
    assert (
        len({flight.seed for flight in flights}) == len({flight.name for flight in flights}) == len(flights)
    )
    frames = [flight.approach.frames for flight in flights]
    assert 22 <= np.mean(frames) <= 30
    test = sum(flight.approach.frames for flight in flights if flight.split == "test")
    assert test >= 2500
    for split in (DEV, TEST):
        assert sum(family.clear for family in split) >= 2
