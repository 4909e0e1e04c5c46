"""Tells where the flight path meets the ground: hillsides, ridges, rolling ground, a meadow to land on are
warned of at the right distance; level and low flight, steep walls and images of textures are not."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from random_seed import seeded
from stage_library import ffi, lib
from terrain_flight import (
    RADIUS_M,
    RATE_HZ,
    Elevation,
    Seen,
    TerrainFlight,
    first_contact_m,
    ridge,
    rolling,
    slope,
)

NEAR_M, FAR_M = 14.5, 45.0
SPEED_M_S = 20.0


def level(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    return np.zeros_like(z)


def turn(axis: tuple[float, float, float], degrees: float) -> np.ndarray:
    return cv2.Rodrigues(np.radians(degrees) * np.asarray(axis, float))[0]


def approach(
    flight: TerrainFlight, elevation: Elevation, height_m: float, frames: int, climb_deg: float = 0.0, **how
) -> list[tuple[float, Seen]]:
    """Flown straight from z = 0: the true distance to the first contact, and what the stage says."""
    climb = np.radians(climb_deg)
    direction = np.array([0.0, -np.sin(climb), np.cos(climb)])
    found = []
    for frame in range(frames):
        position = np.array([0.0, -height_m, 0.0]) + frame * SPEED_M_S / RATE_HZ * direction
        seen = flight.fly(elevation, position, SPEED_M_S * direction, **how)
        found.append((first_contact_m(elevation, position, direction), seen))
    return found


def assert_met(found: list[tuple[float, Seen]], share: float = 0.05, least_m: float = 1.0) -> None:
    """Warned of in every frame at 14.5 to 45 m, with the distance."""
    band = [(true, seen) for true, seen in found if NEAR_M <= true <= FAR_M]
    assert len(band) >= 10
    for true, seen in band:
        assert seen.warned, true
        assert abs(seen.along_m - true) <= max(share * true, least_m), (true, seen)


@pytest.mark.slow
@pytest.mark.same_c
@pytest.mark.parametrize("degrees", [5, 10, 15, 25, 40])
def test_a_hillside_is_met(degrees: int) -> None:
    random = seeded(degrees)
    height_m = random.uniform(3.5, 7.0)
    foot_m = 62.0 - (height_m - RADIUS_M) / np.tan(np.radians(degrees))
    assert_met(approach(TerrainFlight(random), slope(degrees, foot_m), height_m, 25))


@pytest.mark.same_c
def test_a_ridge_is_met() -> None:
    random = seeded(50)
    top_m = random.uniform(4.0, 6.0)
    assert_met(approach(TerrainFlight(random), ridge(20.0, 65.0, top_m), 5.0, 24), least_m=1.5)


def test_a_ridge_that_stays_below_is_not_met() -> None:
    random = seeded(51)
    found = approach(TerrainFlight(random), ridge(15.0, 50.0, 3.0), 5.0 + random.uniform(0.7, 2.0), 24)
    assert not any(seen.warned for _, seen in found)


@pytest.mark.slow
@pytest.mark.same_c
def test_rolling_ground_is_met_where_it_rises_into_the_path_and_not_where_it_stays_below() -> None:
    random = seeded(52)
    hills = rolling(6.0, 90.0, -2 * np.pi * 70.0 / 90.0)  # a top at z = 70
    assert_met(approach(TerrainFlight(random), hills, 6.0, 24), share=0.08, least_m=2.0)
    for _, seen in approach(TerrainFlight(random), rolling(2.0, 50.0, random.uniform(0, 6.28)), 5.0, 25):
        assert not seen.warned


@pytest.mark.slow
@pytest.mark.same_c
@pytest.mark.parametrize("seed", [12, 26, 51])
def test_a_hill_met_at_just_over_the_angle_of_grazing_is_warned_of_without_a_break(seed: int) -> None:
    """The angle falls below ten degrees again with these disparities once it is warned of."""
    flight = TerrainFlight(np.random.default_rng([52, seed]))
    found = approach(flight, rolling(6.0, 90.0, -2 * np.pi * 70.0 / 90.0), 6.0, 19)
    assert any(seen.warned and true > FAR_M for true, seen in found)
    assert_met(found, share=0.08, least_m=2.0)


@pytest.mark.slow
@pytest.mark.same_c
@pytest.mark.parametrize("height_m", [1.65, 2.3, 3.0, 6.0, 20.0])
def test_level_and_low_flight_meets_nothing(height_m: float) -> None:
    random = seeded(60)
    flight = TerrainFlight(random)
    found = approach(flight, level, height_m, 30, climb_deg=random.uniform(-0.7, 0.7), sigma_px=0.35)
    assert not any(seen.warned for _, seen in found)


def test_who_sinks_in_a_gust_low_over_level_ground_is_not_warned() -> None:
    """The path goes down by up to 6 degrees and up again, over and over: the place where it would meet the
    ground comes nearer by more than is flown, and goes away."""
    random = seeded(69)
    speed_m_s, period_s = random.uniform(9.0, 14.0), random.uniform(2.5, 4.0)
    sink_m_s, phase = speed_m_s * np.radians(random.uniform(4.5, 6.0)), random.uniform(0.0, 2.0 * np.pi)
    way_m = sink_m_s * period_s / (2.0 * np.pi)
    flight, time_s = TerrainFlight(random), np.arange(34) / RATE_HZ
    angle = 2.0 * np.pi * time_s / period_s + phase
    height_m = 3.0 + 2.0 * way_m + way_m * np.sin(angle)
    contacts = 0
    for t_s, height, a in zip(time_s, height_m, angle, strict=True):
        velocity = np.array([0.0, -sink_m_s * np.cos(a), speed_m_s])
        seen = flight.fly(level, np.array([0.0, -height, speed_m_s * t_s]), velocity)
        contacts += not np.isnan(seen.along_m)
        assert not seen.warned
    assert contacts > 3


@pytest.mark.parametrize(
    "descent_deg", [*(pytest.param(deg, marks=pytest.mark.same_c) for deg in (4.0, 8.0)), 20.0]
)
def test_a_path_that_descends_on_a_meadow_meets_it(descent_deg: float) -> None:
    """Be it to land: that is what the aircraft will touch."""
    random = seeded(61)
    height_m = RADIUS_M + 58.0 * np.sin(np.radians(descent_deg))
    pitch = turn((1, 0, 0), -0.5 * descent_deg)
    assert_met(
        approach(TerrainFlight(random), level, height_m, 25, -descent_deg, rotation=pitch), least_m=1.5
    )


@pytest.mark.same_c
def test_a_camera_that_rolls_sees_the_same() -> None:
    random = seeded(62)
    for roll_deg in (-30.0, 75.0):
        found = approach(TerrainFlight(random), slope(15, 50.0), 5.0, 24, rotation=turn((0, 0, 1), roll_deg))
        assert_met(found)


@pytest.mark.same_c
def test_a_wall_is_no_ground() -> None:
    """What stands steeper than LEAN_MIN_DEG is an obstacle with a track of its own."""
    random = seeded(63)
    found = approach(TerrainFlight(random), slope(70, 60.0), 5.0, 25)
    assert not any(seen.warned for _, seen in found)


@pytest.mark.same_c
def test_the_image_of_a_texture_moves_with_the_aircraft() -> None:
    """A hillside matched one period off appears at a share of its range: what recedes is no hillside."""
    random = seeded(64)
    found = approach(
        TerrainFlight(random), slope(25, 70.0), 6.0, 24, range_scale=random.uniform(0.4, 0.7), wrong=0.0
    )
    last = [seen for _, seen in found[-10:]]
    assert not any(seen.warned for seen in last)
    assert all(seen.verdict == lib.VISTA_WORLD_REFUTED for seen in last if not np.isnan(seen.along_m))


def test_one_frame_warns_of_nothing_and_a_few_without_words_end_no_warning() -> None:
    random = seeded(65)
    flight, hill = TerrainFlight(random), slope(20, 50.0)
    velocity = np.array([0.0, 0.0, SPEED_M_S])

    def at(frame: int) -> np.ndarray:
        return np.array([0.0, -5.0, frame * 2.0])

    assert not flight.fly(hill, at(0), velocity).warned
    for frame in range(1, 8):
        seen = flight.fly(hill, at(frame), velocity)
    assert seen.warned and not seen.coasting
    flight.stages.disparity_px[:] = -1.0
    for frame in (8, 9):
        seen = flight.update(at(frame), velocity)
        assert seen.warned and seen.coasting
        assert seen.along_m == pytest.approx(first_contact_m(hill, at(frame), velocity / SPEED_M_S), abs=2.0)
    for frame in range(10, 17):  # the view is free: no hill is there any more
        seen = flight.fly(level, at(frame), velocity)
    assert not seen.warned


@pytest.mark.parametrize("seed", [61, pytest.param(125, marks=pytest.mark.same_c), None])
def test_ground_below_the_image_is_held_as_what_is_too_near(seed: int | None) -> None:
    """A descent with a level camera: the contact leaves the image at its lower edge while the rest of
    the meadow is matched as before. In those of the seeds given, a wrong plane is found then."""
    random = seeded(69) if seed is None else np.random.default_rng([69, seed])
    flight, angle = TerrainFlight(random), np.radians(8.0)
    direction = np.array([0.0, np.sin(angle), np.cos(angle)])
    half_view = (flight.view.height_px - flight.view.center_v_px) / flight.view.focal_px
    height_m, held = RADIUS_M + 50.0 * np.sin(angle), 0
    for frame in range(24):
        position = np.array([0.0, -height_m, 0.0]) + frame * SPEED_M_S / RATE_HZ * direction
        seen = flight.fly(level, position, SPEED_M_S * direction)
        to_contact = seen.point_m - position
        if seen.blind:
            held += 1
            assert seen.coasting and to_contact[1] > 0.95 * half_view * to_contact[2]
        if frame > 6 and seen.warned:
            assert seen.along_m == pytest.approx(first_contact_m(level, position, direction), abs=2.0)
        assert seen.warned or frame <= 6 or held
    assert held >= 2


@pytest.mark.same_c
def test_an_arc_into_a_hillside_is_met_along_it() -> None:
    """A turn leads into the bank beside it, which straight on would never be met."""
    random = seeded(70)
    radius_m, rise, toe_m = random.uniform(150.0, 190.0), np.radians(35.0), 3.0
    side = 1.0 if random.integers(2) else -1.0

    def bank(x: np.ndarray, z: np.ndarray) -> np.ndarray:
        return np.maximum(np.tan(rise) * (side * x - toe_m), 0.0)

    def met_m() -> float:
        """The way to where the arc's middle, 5 m above the plain, is within a radius of the bank's plane."""
        along = np.arange(0.0, 100.0, 0.05)
        over = 5.0 - np.tan(rise) * (radius_m * (1.0 - np.cos(along / radius_m)) - toe_m)
        return float(along[np.argmax(over * np.cos(rise) <= RADIUS_M)])

    curved, straight = TerrainFlight(random), TerrainFlight(random)
    for frame in range(14):
        flown_m = frame * SPEED_M_S / RATE_HZ
        turned = flown_m / radius_m
        ahead = np.array([side * np.sin(turned), 0.0, np.cos(turned)])
        inwards = [side * np.cos(turned), 0.0, -np.sin(turned)]
        position = np.array([side * radius_m * (1.0 - np.cos(turned)), -5.0, radius_m * np.sin(turned)])
        seen = curved.fly(
            bank,
            position,
            SPEED_M_S * ahead,
            rotation=turn((0, 1, 0), side * np.degrees(turned)),
            arc={"normal": inwards, "curvature_1_m": 1.0 / radius_m},
        )
        if frame >= 8:
            assert seen.warned and seen.along_m == pytest.approx(met_m() - flown_m, abs=2.0)
        beside = straight.fly(bank, np.array([0.0, -5.0, flown_m]), np.array([0.0, 0.0, SPEED_M_S]))
        assert not beside.warned


@pytest.mark.parametrize(("length_m", "met"), [(60.0, True), (30.0, False)])
def test_an_arc_that_touches_flat_and_goes_on_into_the_ground_meets_it_where_it_touched(
    length_m: float, met: bool
) -> None:
    """Bent downwards with a radius of 400 m, 1 m above level ground: touched at 1.8 degrees, entered at 5
    degrees 35 m ahead."""
    down, ahead = [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]
    arc = [[0.0, 0.0, 0.0], ahead, down, 1.0 / 400.0, length_m]
    volume = ffi.new("vista_terrain_volume *", [arc, RADIUS_M, 0.8])
    plane = ffi.new("vista_terrain_plane *", [down, 1.0])
    contact = ffi.new("vista_terrain_contact *")
    assert lib.vista_terrain_meet(volume, plane, np.sin(np.radians(5.0)), contact) == met
    if met:
        touched_m = 400.0 * np.arccos(1.0 - (1.0 - contact.radius_m) / 400.0)
        assert contact.along_m == pytest.approx(touched_m, abs=0.7)


def test_without_own_motion_there_is_no_path() -> None:
    flight = TerrainFlight(seeded(66))
    for _ in range(8):
        seen = flight.fly(slope(25, 20.0), np.array([0.0, -5.0, 0.0]), np.zeros(3))
        assert not seen.warned and np.isnan(seen.along_m)


def test_a_restart_of_the_world_forgets_the_ground() -> None:
    flight, velocity = TerrainFlight(seeded(67)), np.array([0.0, 0.0, SPEED_M_S])
    for frame in range(8):
        seen = flight.fly(slope(25, 60.0), np.array([0.0, -5.0, 2.0 * frame]), velocity)
    assert seen.warned
    seen = flight.fly(slope(25, 60.0), np.array([0.0, -5.0, 16.0]), velocity, restarted=True)
    assert not seen.warned


def brute_force_m(volume, plane, path_at, short_m: float = 0.0) -> float:
    """The way along a path to where a ball on it first comes within short_m of the plane."""
    normal, offset = np.array(list(plane.normal)), plane.offset_m
    clearance = offset - normal @ np.array(list(volume.path.start_m))
    radius = min(volume.radius_m, volume.clearance_share * clearance)
    length = volume.path.length_m
    for along in np.append(np.arange(0.0, length, 0.05), length):
        point, direction = path_at(along)
        if normal @ point + radius >= offset - short_m:
            return along + radius * (normal @ direction)
    return np.inf


@pytest.mark.slow
def test_the_contact_of_any_path_with_any_plane() -> None:
    random = seeded(68)
    contact = ffi.new("vista_terrain_contact *")
    met = 0
    for trial in range(120):
        curvature = 0.0 if trial % 2 else random.uniform(0.002, 0.03)
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        aside = np.cross(direction, random.normal(size=3))
        aside /= np.linalg.norm(aside)
        start, length = random.normal(size=3) * 20, min(100.0, 1.5 / max(curvature, 1e-9))
        normal = random.normal(size=3)
        normal *= np.sign(normal @ direction) / np.linalg.norm(normal)
        volume = ffi.new(
            "vista_terrain_volume *",
            [[list(start), list(direction), list(aside), curvature, length], 2.0, 0.8],
        )
        plane = ffi.new("vista_terrain_plane *", [list(normal), normal @ start + random.uniform(0.5, 60.0)])

        def path_at(along, c=curvature, a=direction, n=aside, o=start):
            if c == 0.0:
                return o + along * a, a
            angle = c * along
            return (
                o + (np.sin(angle) * a + (1 - np.cos(angle)) * n) / c,
                np.cos(angle) * a + np.sin(angle) * n,
            )

        # A bent path that all but grazes the plane may be said to meet it or to miss it.
        grazed_m = 0.1 if curvature > 0 else 0.0
        first, last = (brute_force_m(volume, plane, path_at, short_m) for short_m in (grazed_m, -grazed_m))
        found = lib.vista_terrain_meet(volume, plane, -1.0, contact)
        if not found:
            assert last > length - 1.1
            continue
        met += 1
        step_m = 0.06 + 0.011 * length * (curvature > 0)
        assert first - step_m <= contact.along_m <= last + step_m
        point = np.array(list(contact.point_m))
        assert np.array(list(plane.normal)) @ point == pytest.approx(plane.offset_m, abs=0.02)
        center, along_direction = path_at(contact.along_m - contact.radius_m * contact.sine)
        assert np.linalg.norm(point - center) == pytest.approx(contact.radius_m, abs=1e-6)
        assert contact.sine == pytest.approx(np.array(list(plane.normal)) @ along_direction, abs=1e-6)
    assert met > 30
