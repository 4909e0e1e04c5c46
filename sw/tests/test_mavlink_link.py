"""The moments at which a link sends what: rates, silence, staleness, health, collisions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mavlink_link import (
    MS,
    UNKNOWN,
    Aircraft,
    Link,
    Thing,
    clear_sectors,
    dialect,
    obstacle_sectors,
    of_kind,
)
from random_seed import seeded

AHEAD = Thing(np.array([0.0, 0.0, 10.0]))
DISTANCES = {"px4": "OBSTACLE_DISTANCE", "ardupilot": "OBSTACLE_DISTANCE_3D"}


def fly(
    link: Link, seconds: float, frame_ms: float, poll_ms: float = 10.0, things=(AHEAD,), **frame
) -> list[tuple[float, object]]:
    """(seconds, message) of a time in which a frame comes every frame_ms."""
    sent, start_ns, next_ms = [], link.now_ns, 0.0
    while (passed_ms := (link.now_ns - start_ns) / MS) < 1000 * seconds:
        if passed_ms >= next_ms:
            assert link.update(list(things), 100.0, **frame) == "VISTA_OK"
            next_ms += frame_ms
        sent += [(passed_ms / 1000, message) for message in link.step(poll_ms)]
    return sent


def times_of(sent, kind: str) -> np.ndarray:
    times = [t for t, message in sent if message.get_type() == kind]
    return np.unique(times)


@pytest.mark.parametrize("autopilot", DISTANCES)
@pytest.mark.parametrize("frame_ms", [10.0, 33.3, 50.0, 100.0, 240.0])
def test_at_least_ten_and_at_most_33_times_a_second(autopilot: str, frame_ms: float) -> None:
    """Also when frames come seldom, as long as the last is not stale; polled every 20 ms."""
    times = times_of(fly(Link(autopilot), 3.0, frame_ms, 20.0), DISTANCES[autopilot])
    gaps_s = np.diff(times)
    assert gaps_s.max() <= 0.1 + 1e-9 and gaps_s.min() >= 0.03 - 1e-9


@pytest.mark.parametrize("autopilot", DISTANCES)
def test_never_silent_for_half_a_second_with_irregular_frames(autopilot: str) -> None:
    random = seeded(1)
    link = Link(autopilot)
    times = []
    start_ns = link.now_ns
    for _ in range(200):
        link.update([AHEAD] if random.random() < 0.5 else [], 100.0)
        for _ in range(random.integers(1, 25)):
            times += [link.now_ns] * len(of_kind(link.step(10.0), DISTANCES[autopilot]))
    assert np.diff([start_ns, *times, link.now_ns]).max() < 500 * MS


def test_px4_is_told_unknown_when_blind_and_when_frames_cease() -> None:
    link = Link("px4")
    fly(link, 0.5, 50.0)
    blind = fly(link, 1.0, 50.0, health="blind")
    assert len(times_of(blind, "OBSTACLE_DISTANCE")) >= 10
    assert all(set(m.distances) == {UNKNOWN} for t, m in blind if t > 0.05 and m.id == 330)
    fly(link, 0.5, 50.0)
    ceased = [(k * 0.01, m) for k in range(200) for m in link.step(10.0) if m.id == 330]
    assert len(ceased) >= 20
    for seconds, message in ceased:
        known = bool(obstacle_sectors(message))
        assert known or seconds > 0.2
        assert not known or seconds <= 0.3  # stale_s after the last frame
    assert np.diff([t for t, _ in ceased]).max() <= 0.1


def test_ardupilot_hears_nothing_when_nothing_is_known() -> None:
    """It keeps what it was told last as long as anything comes, and has no word for unknown."""
    link = Link("ardupilot")
    fly(link, 0.5, 50.0)
    blind = fly(link, 1.0, 50.0, things=[], health="blind")
    assert all(t < 0.05 for t in times_of(blind, "OBSTACLE_DISTANCE_3D"))
    assert len(times_of(blind, "HEARTBEAT")) >= 1
    fly(link, 0.5, 50.0)
    ceased = [k * 0.01 for k in range(200) for m in link.step(10.0) if m.id == 11037]
    assert max(ceased) <= 0.3


def test_ardupilot_goes_on_hearing_of_obstacles_that_are_held_while_blind() -> None:
    """Silence would make it stop avoiding them."""
    link = Link("ardupilot")
    blind = fly(link, 1.0, 50.0, health="blind")
    assert np.diff(times_of(blind, "OBSTACLE_DISTANCE_3D")).max() <= 0.1


def test_before_the_first_frame_nothing_is_known() -> None:
    for autopilot in DISTANCES:
        messages = Link(autopilot).poll()
        assert [m.system_status for m in of_kind(messages, "HEARTBEAT")] == [dialect.MAV_STATE_BOOT]
        assert not of_kind(messages, "OBSTACLE_DISTANCE_3D")
        for message in of_kind(messages, "OBSTACLE_DISTANCE"):
            assert set(message.distances) == {UNKNOWN}


def test_a_degraded_frame_has_obstacles_and_nothing_clear() -> None:
    link = Link("px4")
    link.update([AHEAD], 100.0, "degraded")
    message = link.one("OBSTACLE_DISTANCE")
    assert list(obstacle_sectors(message)) == [0] and not clear_sectors(message)


def test_the_heartbeat_says_who_and_how_well() -> None:
    link = Link("px4", changes={"system_id": 7, "component_id": 42})
    states = []
    for health, seconds in (("healthy", 3.0), ("degraded", 3.0), ("blind", 3.0)):
        sent = fly(link, seconds, 50.0, health=health)
        beats = [m for _, m in sent if m.get_type() == "HEARTBEAT"]
        assert len(beats) == 3
        states.append(beats[-1].system_status)
        for beat in beats:
            assert (beat.get_srcSystem(), beat.get_srcComponent()) == (7, 42)
            assert beat.type == dialect.MAV_TYPE_ONBOARD_CONTROLLER
            assert beat.autopilot == dialect.MAV_AUTOPILOT_INVALID
    active, critical = dialect.MAV_STATE_ACTIVE, dialect.MAV_STATE_CRITICAL
    assert states == [active, active, critical]
    default = Link("px4")
    assert default.one("HEARTBEAT").get_srcComponent() == dialect.MAV_COMP_ID_OBSTACLE_AVOIDANCE


def test_changes_of_health_are_told_once_and_again_after_ten_seconds() -> None:
    link = Link("px4")
    texts: list[tuple[int, str]] = []
    for health, reason in (("healthy", ""), ("blind", "no_contrast"), ("degraded", "few_disparities")):
        sent = fly(link, 12.0, 50.0, health=health, reason=reason)
        texts += [(m.severity, m.text) for _, m in sent if m.get_type() == "STATUSTEXT"]
    error, warning, info = (getattr(dialect, f"MAV_SEVERITY_{n}") for n in ("ERROR", "WARNING", "INFO"))
    blind, degraded = (error, "VISTA blind: no_contrast"), (warning, "VISTA degraded: few_disparities")
    assert texts == [(info, "VISTA healthy"), blind, blind, degraded, degraded]


def test_flickering_health_does_not_flood_the_pilot() -> None:
    link = Link("px4")
    texts = []
    for k in range(300):
        link.update([], health=("healthy", "blind")[k % 2])
        texts += of_kind(link.step(20.0), "STATUSTEXT")
    assert len(texts) <= 7  # 6 s


def test_a_long_reason_fits() -> None:
    link = Link("px4")
    link.update([], health="blind", reason="x" * 200)
    assert link.one("STATUSTEXT").text == "VISTA blind: " + "x" * 31


# ---- collisions ----


def test_a_collision_has_its_time_from_now_and_its_distance() -> None:
    """The aircraft flies 10 m/s straight ahead; the thing is 1.5 m to the right of and 0.5 m below the path,
    20 m away."""
    aircraft = Aircraft((12.0, -8.0, 200.0), (2.0, 4.0, 30.0))
    link = Link("px4", aircraft)
    collision = {
        "valid": True,
        "id": 9,
        "position_camera_m": (aircraft.ned_from_camera.T @ np.array([20.0, 1.5, 0.5])).tolist(),
        "velocity_camera_m_s": (aircraft.ned_from_camera.T @ np.array([10.0, 0.0, 0.0])).tolist(),
        "time_s": 2.0,
    }
    link.update([], collision=collision, t_ns=link.now_ns - 150 * MS)
    message = link.one("COLLISION")
    assert message.id == 9 and message.action == dialect.MAV_COLLISION_ACTION_REPORT
    assert message.time_to_minimum_delta == pytest.approx(1.85)
    assert message.horizontal_minimum_delta == pytest.approx(1.5, abs=1e-5)
    assert message.altitude_minimum_delta == pytest.approx(0.5, abs=1e-5)
    assert message.threat_level == dialect.MAV_COLLISION_THREAT_LEVEL_HIGH
    assert not of_kind(link.step(500.0), "COLLISION")  # once a frame


@pytest.mark.parametrize("time_s, level", [(8.0, "LOW"), (4.9, "HIGH")])
def test_the_threat_is_high_when_it_is_near(time_s: float, level: str) -> None:
    link = Link("px4")
    link.update([], collision={"valid": True, "id": 1, "time_s": time_s})
    assert link.one("COLLISION").threat_level == getattr(dialect, f"MAV_COLLISION_THREAT_LEVEL_{level}")


@pytest.mark.parametrize("time_s", [0.0, -1.0, math.nan])
def test_without_a_time_there_is_no_collision(time_s: float) -> None:
    link = Link("px4")
    link.update([], collision={"valid": True, "id": 1, "time_s": time_s})
    assert not of_kind(link.poll(), "COLLISION")


def test_a_blind_frame_still_warns_of_what_was_seen_before() -> None:
    link = Link("px4")
    link.update([], health="blind", collision={"valid": True, "id": 1, "time_s": 2.0})
    assert link.one("COLLISION").time_to_minimum_delta == 2.0


def test_frames_of_a_link_are_numbered_without_a_gap() -> None:
    link = Link("ardupilot")
    fly(link, 3.0, 50.0)
    numbers = [data[4] for data in link.raw]
    assert numbers == [k % 256 for k in range(len(numbers))] and len(numbers) > 50


def test_a_frame_amid_the_points_of_another_is_sent_at_once_and_whole() -> None:
    """The caller takes one message at a time: what is left of the older frame is not the newer's."""
    link = Link("ardupilot")
    link.update([Thing(np.array([x, 0.0, 10.0]), id=1) for x in (-3.0, 0.0, 3.0)])
    first = link.next()
    link.now_ns += MS
    link.update([Thing(np.array([x, 0.0, 20.0]), id=2) for x in (-3.0, 0.0, 3.0)])
    points = of_kind(link.poll(), "OBSTACLE_DISTANCE_3D")
    assert first.obstacle_id == 1 and [p.obstacle_id for p in points] == [2, 2, 2]
    assert {p.time_boot_ms for p in points} == {first.time_boot_ms + 1}
