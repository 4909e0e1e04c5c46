"""What autopilots make of our messages, by rules from their public sources."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from autopilot_rules import UNKNOWN, ArduPilot, Px4
from mavlink_link import CLEAR, LEVEL_M, MS, Aircraft, Link, Thing, deliver, milliseconds, of_kind, view
from random_seed import seeded
from stage_library import lib

PX4 = [
    pytest.param(Px4, lib.VISTA_MAVLINK_SECTORS_72, id="72 bins"),
    pytest.param(partial(Px4, 36, overlapping=True), lib.VISTA_MAVLINK_SECTORS_36, id="36 bins"),
    pytest.param(partial(Px4, 36), lib.VISTA_MAVLINK_SECTORS_36, id="36 bins, older"),
]


def turned(bearing_deg: float) -> Aircraft:
    return Aircraft((10.0, -5.0, 200.0), (0.0, 0.0, float(round(bearing_deg / 30) * 30)))


# ---- PX4 ----


@pytest.mark.parametrize("make, sectors", PX4)
def test_px4_finds_an_obstacle_in_each_direction(make: Callable[[], Px4], sectors: int) -> None:
    bins = make().bins
    for index in range(bins):
        bearing_deg = index * 360.0 / bins
        aircraft = turned(bearing_deg)
        link, px4 = Link("px4", aircraft, {"sectors": sectors}), make()
        view(link, Thing(aircraft.at_bearing(bearing_deg, LEVEL_M)))
        deliver(link, px4)
        distances = px4.look(milliseconds(link))
        assert [k for k, d in enumerate(distances) if d < CLEAR] == [index]
        assert distances[index] == pytest.approx(100 * LEVEL_M, abs=10)
        assert px4.warnings == 0


@pytest.mark.parametrize("make, sectors", PX4)
def test_px4_may_move_where_it_was_seen_to_be_clear_and_nowhere_else(
    make: Callable[[], Px4], sectors: int
) -> None:
    link, px4 = Link("px4", changes={"sectors": sectors}), make()
    view(link)
    deliver(link, px4)
    now_ms = milliseconds(link)
    for bearing_deg in range(-180, 180):
        if abs(bearing_deg) <= 20:
            assert px4.may_move(bearing_deg, now_ms)
        elif abs(bearing_deg) >= 40:
            assert not px4.may_move(bearing_deg, now_ms)


def test_older_px4_reads_every_second_sector_of_72() -> None:
    """Why there are sectors of 10 degrees."""
    aircraft = turned(5.0)
    link, px4 = Link("px4", aircraft), Px4(36)
    view(link, Thing(aircraft.at_bearing(5.0, LEVEL_M)))
    deliver(link, px4)
    assert not [d for d in px4.look(milliseconds(link)) if d < CLEAR]


@pytest.mark.parametrize("how", ["blind", "no frames", "no messages"])
def test_px4_stops_within_a_second_when_the_view_is_lost(how: str) -> None:
    link, px4 = Link("px4"), Px4()
    view(link)
    deliver(link, px4)
    assert px4.may_move(0.0, milliseconds(link))
    for _ in range(85):
        if how == "blind":
            link.now_ns += MS
            view(link, health="blind")
        if how == "no messages":
            link.now_ns += 10 * MS
        else:
            deliver(link, px4, 9.0 if how == "blind" else 10.0)
    assert not px4.may_move(0.0, milliseconds(link))
    assert set(px4.look(milliseconds(link))) == {UNKNOWN}


def test_px4_keeps_its_data_between_seldom_frames() -> None:
    link, px4 = Link("px4"), Px4()
    for k in range(300):
        if k % 25 == 0:
            view(link)
        deliver(link, px4, 10.0)
        assert px4.may_move(0.0, milliseconds(link))


# ---- ArduPilot ----


def test_ardupilot_finds_a_point_in_each_direction_and_layer() -> None:
    for bearing_deg in range(0, 360, 5):
        for height_m in (-14.0, -5.0, 0.0, 5.0, 14.0):
            aircraft = Aircraft((0.0, 0.0, 77.0), (0.0, 0.0, float(bearing_deg)))
            link, ardupilot = Link("ardupilot", aircraft), ArduPilot()
            view(link, Thing(aircraft.at_bearing(bearing_deg, LEVEL_M, height_m), height_m=0.1))
            deliver(link, ardupilot)
            elevation_deg = math.degrees(math.atan2(height_m, LEVEL_M))
            face = ArduPilot.face(elevation_deg, bearing_deg)
            assert list(ardupilot.faces) == [face]
            assert ardupilot.faces[face] == pytest.approx(math.hypot(LEVEL_M, height_m), abs=0.15)


def test_ardupilot_has_all_points_of_a_frame_and_none_of_the_one_before() -> None:
    random = seeded(1)
    link, ardupilot = Link("ardupilot", Aircraft(mount_deg=(0.0, 0.0, 90.0))), ArduPilot()
    for _ in range(50):
        bearings = random.uniform(30.0, 150.0, random.integers(0, 8))
        distances = np.sort(random.uniform(5.0, 30.0, len(bearings)))
        things = [
            Thing(link.aircraft.at_bearing(bearing, distance), width_m=0.0, id=k + 1)
            for k, (bearing, distance) in enumerate(zip(bearings, distances, strict=True))
        ]
        view(link, *things)
        deliver(link, ardupilot)
        expected: dict[tuple[int, int], float] = {}
        for bearing, distance in zip(bearings, distances, strict=True):
            face = ArduPilot.face(0.0, bearing)
            expected[face] = min(distance, expected.get(face, math.inf))
        assert ardupilot.faces == pytest.approx(expected, rel=1e-5)
        assert ardupilot.healthy(milliseconds(link))
        link.now_ns += 50 * MS


def test_ardupilot_forgets_what_is_gone_and_stays_healthy() -> None:
    link, ardupilot = Link("ardupilot"), ArduPilot()
    view(link, Thing(np.array([0.0, 0.0, LEVEL_M])))
    deliver(link, ardupilot)
    assert ardupilot.faces
    link.now_ns += 50 * MS
    view(link)
    deliver(link, ardupilot)
    assert not ardupilot.faces and ardupilot.healthy(milliseconds(link))


def test_ardupilot_is_unhealthy_within_a_second_when_the_view_is_lost() -> None:
    link, ardupilot = Link("ardupilot"), ArduPilot()
    view(link, Thing(np.array([0.0, 0.0, LEVEL_M])))
    for _ in range(90):
        deliver(link, ardupilot, 10.0)
    assert not ardupilot.healthy(milliseconds(link))


def test_why_ardupilot_is_not_sent_unknown_sectors() -> None:
    """They keep it healthy with what it had: an obstacle that is gone, or one that has come since."""
    link, ardupilot = Link("px4"), ArduPilot()
    view(link, Thing(np.array([0.0, 0.0, LEVEL_M])))
    deliver(link, ardupilot)
    for _ in range(200):
        deliver(link, ardupilot, 10.0)  # no frames: all unknown
    assert ardupilot.healthy(milliseconds(link)) and ardupilot.faces


# ---- loss and reordering ----


@pytest.mark.parametrize("make, sectors", PX4)
def test_loss_and_reordering_never_make_px4_believe_what_is_not(
    make: Callable[[], Px4], sectors: int
) -> None:
    """A third lost, the others up to 80 ms late, out of order: nothing is believed for a second more."""
    random = seeded(2)
    for _ in range(5):
        link, px4 = Link("px4", changes={"sectors": sectors}), make()
        on_the_way: list[tuple[float, int, Any]] = []
        near_ms = -math.inf  # when the obstacle came
        for k in range(400):
            now_ms = milliseconds(link)
            if k == 200:
                near_ms = now_ms
            if k % 5 == 0:
                view(link, *([Thing(np.array([0.0, 0.0, 5.0]))] if k >= 200 else []))
            for message in link.step(10.0):
                if random.random() > 0.33:
                    on_the_way.append((now_ms + random.uniform(0.0, 80.0), len(on_the_way), message))
            arrived = sorted(entry for entry in on_the_way if entry[0] <= now_ms)
            on_the_way = [entry for entry in on_the_way if entry[0] > now_ms]
            for _, _, message in arrived:
                px4.receive(message, now_ms)
            if now_ms > near_ms + 1000.0 and k >= 200:
                assert px4.look(now_ms)[0] in (UNKNOWN, *range(480, 501))


def test_reordered_points_leave_no_obstacle_of_old() -> None:
    """Points of two frames arrive mixed: once a frame has arrived in order, only its points are there."""
    random = seeded(3)
    for _ in range(50):
        link, ardupilot = Link("ardupilot"), ArduPilot()
        frames = []
        for bearing in (-20.0, 20.0, 0.0):
            things = [Thing(link.aircraft.at_bearing(bearing, 5.0 + k), width_m=0.0) for k in range(3)]
            view(link, *things)
            frames.append(of_kind(link.poll(), "OBSTACLE_DISTANCE_3D"))
            link.now_ns += 50 * MS
        mixed = frames[0] + frames[1]
        random.shuffle(mixed)
        for message in mixed:
            if random.random() > 0.3:
                ardupilot.receive(message, milliseconds(link))
        for message in frames[2]:
            ardupilot.receive(message, milliseconds(link))
        assert list(ardupilot.faces.values()) == [pytest.approx(5.0, abs=1e-3)]
