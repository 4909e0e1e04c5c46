"""Mistakes that are known of other projects, and none of them is ours."""

from __future__ import annotations

import numpy as np
import pytest
from autopilot_rules import UNKNOWN, ArduPilot, Px4
from mavlink_link import (
    CLEAR,
    LEVEL_M,
    START_NS,
    Aircraft,
    Link,
    Thing,
    deliver,
    milliseconds,
    of_kind,
    view,
)


def test_an_obstacle_is_where_it_is_in_the_map_of_px4() -> None:
    """It is 35 degrees to the right, in a view that is turned by 40. With x to the right, angles that count
    to the left or from the edge of the view, an offset of the other sign, a global frame, another number for
    what is not known, or metres, the map would be another."""
    aircraft = Aircraft((0.0, 0.0, 123.0), (0.0, 0.0, 40.0))
    link, px4 = Link("px4", aircraft, {"angle_offset_deg": -45.0}), Px4()
    view(link, Thing(aircraft.at_bearing(35.0, LEVEL_M)))
    deliver(link, px4)
    truth = [UNKNOWN] * 72
    for sector in range(3, 14):  # whole sectors within 10 to 70 degrees
        truth[sector] = CLEAR
    truth[7] = 1195
    assert px4.look(milliseconds(link)) == truth


def test_zero_is_never_a_distance() -> None:
    for thing in (
        Thing(np.zeros(3)),
        Thing(np.array([0.0, 0.0, 1e-9])),
        Thing(np.array([0.0, 0.0, 0.05]), width_m=3.0),
        Thing(np.array([0.0, 0.0, 9.0]), id=0),  # too near to match
    ):
        link = Link("px4")
        view(link, thing)
        message = link.one("OBSTACLE_DISTANCE")
        assert min(message.distances) == message.min_distance == 30
        link, ardupilot = Link("ardupilot"), ArduPilot()
        view(link, thing)
        deliver(link, ardupilot)
        if np.any(thing.position_camera_m):
            assert min(ardupilot.faces.values()) == pytest.approx(0.3)


def test_frames_within_a_millisecond_are_told_apart() -> None:
    link = Link("ardupilot")
    stamps = []
    for k in range(3):
        link.update([Thing(np.array([0.0, 0.0, 9.0]))], t_ns=START_NS + 1000 * k)
        stamps += [m.time_boot_ms for m in of_kind(link.step(50.0), "OBSTACLE_DISTANCE_3D")]
    assert len(set(stamps)) == 3


def test_a_repeated_frame_keeps_its_time() -> None:
    link = Link("ardupilot")
    link.update([Thing(np.array([0.0, 0.0, 9.0]))])
    stamps = [m.time_boot_ms for _ in range(25) for m in of_kind(link.step(10.0), "OBSTACLE_DISTANCE_3D")]
    assert len(stamps) >= 3 and len(set(stamps)) == 1
