"""Every family of sampled worlds: for any seed a scene that can be rendered, with something in the way where
the family says so and nothing where it does not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from random_seed import seeded
from vista_eval.cache import content_sha256
from vista_eval.render.course import Course
from vista_eval.render.flight import Flight
from vista_eval.render.motion import moves, solids_at
from vista_eval.render.rig import LEFT
from vista_eval.render.scene import Cylinder, GroundStrip, HeightField, Scene, Thing, bounds_m
from vista_eval.worlds import laying
from vista_eval.worlds.grounds import OPEN_COUNTRY
from vista_eval.worlds.path import Path as FlownPath
from vista_eval.worlds.path import distance_m, nearness_m, path_of, samples
from vista_eval.worlds.sampled import buildings, rows, small_movers
from vista_eval.worlds.sampled.catalog import COUNT, DEV, FAMILIES, SEED, TEST, TEST2
from vista_eval.worlds.sampled.family import Family
from vista_eval.worlds.site import site

pytestmark = pytest.mark.slow

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


def is_ground(thing: Thing) -> bool:
    return isinstance(thing.solids[0], GroundStrip | HeightField)


def around(path: FlownPath, radius_m: float, low_m: float, high_m: float) -> FlownPath:
    """The part of the path between two x, with one radius all along."""
    kept = (path.points_m[:, 0] >= low_m) & (path.points_m[:, 0] <= high_m)
    return FlownPath(path.points_m[kept], np.full(int(kept.sum()), radius_m), 0)


def height_m(ground: Thing, x_m: float, y_m: float) -> float:
    """The height of the ground at a place, between the nodes of the patch that it lies in."""
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
    return -np.inf  # never in view


@pytest.mark.parametrize("name", FAMILIES)
def test_a_scene_of_any_seed(name: str) -> None:
    family = FAMILIES[name]
    flight = family.flight(int(seeded(1).integers(1 << 20)), 0)
    scene = flight.scene(flight.approach.altitude_m, flight.seed)
    assert (flight.family, flight.split) == (name, "dev" if family.split == "dev" else "test")
    is_whole(scene)
    is_flyable(flight)
    the_target_is_in_the_way_and_only_that(family, flight, scene)
    the_ground_is_met_where_it_is_the_target_and_nowhere_before(family, flight, scene)
    level_ground_fills_the_view(flight, scene)


def is_whole(scene: Scene) -> None:
    names = [solid.name for solid in scene.solids]
    assert len(set(names)) == len(names)
    assert len({thing.name for thing in scene.things}) == len(scene.things)
    for solid in scene.solids:
        assert np.all(np.isfinite(solid.albedo)) and 0 <= solid.albedo.min() <= solid.albedo.max() <= 1
        assert np.all(np.isfinite(bounds_m(solid)))
    assert np.linalg.norm(scene.to_sun) == pytest.approx(1.0) and 0.3 <= scene.exposure <= 3.0


def is_flyable(flight: Flight) -> None:
    course = flight.approach
    assert 18 <= course.frames <= 40 and 3.0 <= course.speed_m_s <= 25.0 and 7.5 <= course.rate_hz <= 15.0
    lowest_m = min(course.state_at(k).world_from_body[2, 3] for k in range(course.frames))
    assert lowest_m > 0.6


def the_target_is_in_the_way_and_only_that(family: Family, flight: Flight, scene: Scene) -> None:
    """What moves is met where it is by then."""
    path = path_of(flight.approach)
    targets = [thing for thing in scene.things if thing.target]
    assert len(targets) == (0 if family.clear else 1)
    for thing in targets:
        if moves(thing):
            assert missed_m(flight.approach, thing) < IN_THE_WAY_M
        elif not is_ground(thing):
            met = around(path, IN_THE_WAY_M, -8.0, 8.0)
            assert min(nearness_m(solid, met) for solid in thing.solids) < 0.0
    if family.name == "rows":  # they stand close to the path, some of them within the volume
        return
    before = around(path, BESIDE_M, -200.0, 200.0 if family.clear else -2.0)
    for thing in scene.things:
        if not (
            thing.target or is_ground(thing) or thing.kind in ("bird", "gull")
        ):  # flocks are met as a whole
            assert min(nearness_m(solid, before) for solid in thing.solids) > 0.0, thing.name


def missed_m(course: Course, target: Thing) -> float:
    """The least distance of the aircraft from a thing that moves, after the last frame."""
    closing_m_s = course.speed_m_s - target.velocity_m_s[0]
    last = course.frames - 1
    return min(
        distance_m(
            replace(target, solids=solids_at(target, t_s)),
            course.state_at(last + t_s * course.rate_hz).world_from_body[:3, 3],
        )
        for t_s in np.linspace(0.8, 1.1, 31) * course.last_range_m / closing_m_s
    )


def is_in_view(flight: Flight, target: Thing) -> bool:
    """Any of it, in the last frame."""
    pose = flight.approach.state_at(flight.approach.frames - 1).world_from_body
    points = np.concatenate([samples(solid)[0] for solid in target.solids])
    camera = np.linalg.inv(pose @ flight.rig.body_from_camera(LEFT))
    u, v = flight.rig.project(points @ camera[:3, :3].T + camera[:3, 3]).T
    return bool(np.any((u >= 0) & (u < flight.rig.width_px) & (v >= 0) & (v < flight.rig.height_px)))


def the_ground_is_met_where_it_is_the_target_and_nowhere_before(
    family: Family, flight: Flight, scene: Scene
) -> None:
    (ground,) = [thing for thing in scene.things if is_ground(thing)]
    altitude, path = flight.approach.altitude_m, path_of(flight.approach)
    if ground.target:
        assert height_m(ground, 0.0, 0.0) == pytest.approx(altitude, abs=0.6)
    else:
        assert height_m(ground, 0.0, 0.0) <= altitude - 0.8
    for x, y, z in path.points_m[: path.flown : 4]:
        assert 0.1 < z - height_m(ground, x, y) < 60.0
    if family.clear:
        for x, y, z in path.points_m[::4]:
            assert z - height_m(ground, x, y) > 2.2


def level_ground_fills_the_view(flight: Flight, scene: Scene) -> None:
    """Tells whether there is ground wherever a ray of the image meets z = 0 within a kilometre."""
    (ground,) = [thing for thing in scene.things if is_ground(thing)]
    strips = [solid for solid in ground.solids if isinstance(solid, GroundStrip)]
    if not strips:
        return
    rig, course = flight.rig, flight.approach
    (cu, cv), pixels = rig.center_px, np.mgrid[0 : rig.width_px : 71, 0 : rig.height_px : 53].reshape(2, -1)
    rays = np.stack(
        [(pixels[0] - cu) / rig.focal_px, (pixels[1] - cv) / rig.focal_px, np.ones(pixels.shape[1])]
    )
    for frame in (0, course.frames // 2, course.frames - 1):
        pose = course.state_at(frame).world_from_body @ rig.body_from_camera(0)
        east, north, up = pose[:3, :3] @ rays
        reach_m = -pose[2, 3] / np.minimum(up, -1e-9)
        seen = (up < 0) & (reach_m < 1000)
        x, y = pose[0, 3] + reach_m * east, pose[1, 3] + reach_m * north
        covered = np.zeros(len(x), bool)
        for strip in strips:
            (x0, x1), (y0, y1) = strip.x_m, strip.y_m
            covered |= (x0 <= x) & (x <= x1) & (y0 <= y) & (y <= y1)
        assert np.all(covered[seen]), (
            f"frame {frame}: no ground at {x[seen & ~covered]}, {y[seen & ~covered]}"
        )


@pytest.mark.parametrize("name", ["drone", "road_vehicle", "birds", "small_movers"])
def test_what_moves_is_in_view_and_then_in_the_way(name: str) -> None:
    """However slowly the aircraft flies."""
    for number in seeded(2).integers(1 << 20, size=4):
        flight = FAMILIES[name].flight(int(number), 0)
        scene = flight.scene(flight.approach.altitude_m, flight.seed)
        (target,) = [thing for thing in scene.things if thing.target]
        assert is_in_view(flight, target)
        if moves(target):
            assert missed_m(flight.approach, target) < IN_THE_WAY_M


@pytest.mark.parametrize("number", [1297, 1770, 2539, 79782, 655191])
def test_what_is_met_in_a_turn_is_in_view(number: int) -> None:
    """Slow aircraft whose turn took the target out of the image while only the path bounded its bearing."""
    flight = FAMILIES["small_movers"].flight(number, 0)
    scene = flight.scene(flight.approach.altitude_m, flight.seed)
    (target,) = [thing for thing in scene.things if thing.target]
    assert is_in_view(flight, target)
    assert missed_m(flight.approach, target) < IN_THE_WAY_M


@pytest.mark.parametrize("name", ["containers", "smooth_front"])
def test_large_fronts_are_higher_than_the_path(name: str) -> None:
    for number in seeded(4).integers(1 << 20, size=2):
        flight = FAMILIES[name].flight(int(number), 0)
        scene = flight.scene(flight.approach.altitude_m, flight.seed)
        (target,) = [thing for thing in scene.things if thing.target]
        top_m = max(float(bounds_m(solid)[1][2]) for solid in target.solids)
        assert top_m > flight.approach.altitude_m + 0.8 and target.width_m > 2.4


def test_steep_wires_are_thin_and_steep() -> None:
    """They are from end to end; the wire is 20 m away within 3 s before it is met."""
    for number in seeded(3).integers(1 << 20, size=8):
        flight = FAMILIES["steep_wire"].flight(int(number), 0)
        scene = flight.scene(flight.approach.altitude_m, flight.seed)
        (target,) = [thing for thing in scene.things if thing.target]
        pieces = [solid for solid in target.solids if isinstance(solid, Cylinder)]
        step = np.subtract(pieces[-1].end_m, pieces[0].start_m)
        assert 0.5 - 1e-6 <= abs(step[2]) / np.linalg.norm(step) <= 1.0
        assert all(0.008 <= 2 * piece.radius_m <= 0.030 for piece in pieces)
        assert 3.0 * flight.approach.speed_m_s > 20.0


def test_rows_stand_close_beside_the_path_but_where_it_is_met() -> None:
    random = seeded(4)
    for number in random.integers(1 << 20, size=6):
        course = rows.BETWEEN_ROWS.draw(int(number))
        here = site(course.altitude_m, int(number), rows.BETWEEN_ROWS, OPEN_COUNTRY)
        aside_m, apart_m = float(random.choice([-1, 1]) * random.uniform(1.5, 4.0)), random.uniform(6.0, 13.0)
        places = list(rows.row(here, aside_m, apart_m, 0.3, random))
        assert len(places) >= 3
        assert [place.outermost for place in places].count(True) == 2
        for place in places:
            assert abs(place.x_m) >= rows.UNOBSTRUCTED_M
            assert place.y_m - here.path.y_m(place.x_m) == pytest.approx(aside_m, abs=0.3)


def test_small_movers_are_small_and_move() -> None:
    random = seeded(5)
    for number in random.integers(1 << 20, size=12):
        course = small_movers.IN_THE_AIR.draw(int(number))
        here = site(course.altitude_m, int(number), small_movers.IN_THE_AIR, OPEN_COUNTRY)
        along, across, _ = small_movers.velocity_m_s(here, 15.0, random)
        assert along <= 0.0 < np.hypot(along, across) <= 15.0
        assert abs(across) <= small_movers.MOST_BEARING * (course.speed_m_s - along) + 1e-9
        for build in (
            small_movers.kite,
            small_movers.balloon,
            small_movers.model_aircraft,
            small_movers.gull,
        ):
            size_m = random.uniform(*small_movers.SIZE_M)
            sides_m = np.ptp(build(size_m, random).vertices_m, axis=0)
            assert 0.7 * size_m < sides_m.max() < 2.2 * size_m


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
    assert {family.split for family in TEST2} == {"test2"}
    flights = [flight for family in FAMILIES.values() for flight in family.flights(COUNT, SEED)]
    assert len(flights) >= 200
    assert (
        len({flight.seed for flight in flights}) == len({flight.name for flight in flights}) == len(flights)
    )
    frames = [flight.approach.frames for flight in flights]
    assert 22 <= np.mean(frames) <= 30
    test = sum(flight.approach.frames for flight in flights if flight.split == "test")
    assert test >= 2500
    for split in (DEV, TEST, TEST2):
        assert sum(family.clear for family in split) >= 2
