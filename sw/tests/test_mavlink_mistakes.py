"""Known mistakes of other projects: each gives a receiver another picture, and none of them is ours."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from autopilot_rules import UNKNOWN, ArduPilot, Px4
from mavlink_link import CLEAR, LEVEL_M, START_NS, Aircraft, Link, Thing, deliver, of_kind, view

Mistake = Callable[[Any], None]


def yaw_90(message: Any) -> None:
    """x to the right and y ahead, as in a frame of ENU."""
    message.distances = message.distances[18:] + message.distances[:18]


def mirrored(message: Any) -> None:
    """Angles that count to the left, as those of ROS."""
    message.distances = message.distances[:1] + message.distances[:0:-1]


def halves_swapped(message: Any) -> None:
    """Counts from the left edge of the view instead of from ahead."""
    message.distances = message.distances[36:] + message.distances[:36]


def offset_of_the_wrong_sign(message: Any) -> None:
    message.angle_offset = -message.angle_offset


def global_frame(message: Any) -> None:
    """The default of the field: north aligned."""
    message.frame = 0


def clear_for_unknown(message: Any) -> None:
    message.distances = [CLEAR if d == UNKNOWN else d for d in message.distances]


def zero_for_unknown(message: Any) -> None:
    message.distances = [0 if d == UNKNOWN else d for d in message.distances]


def metres(message: Any) -> None:
    message.distances = [d if d >= CLEAR else d // 100 for d in message.distances]


def map_of(messages: list[Any]) -> list[int]:
    px4 = Px4()
    for message in messages:
        px4.receive(message, 0.0)
    return px4.look(0.0)


@pytest.mark.parametrize(
    "mistake",
    [
        yaw_90, mirrored, halves_swapped, offset_of_the_wrong_sign, global_frame, clear_for_unknown,
        zero_for_unknown, metres,
    ],
)  # fmt: skip
def test_a_known_mistake_is_not_ours(mistake: Mistake) -> None:
    """An obstacle 35 degrees to the right, in a view that is turned by 40: each mistake gives another map."""
    aircraft = Aircraft((0.0, 0.0, 123.0), (0.0, 0.0, 40.0))
    link = Link("px4", aircraft, {"angle_offset_deg": -45.0})
    view(link, Thing(aircraft.at_bearing(35.0, LEVEL_M)))
    ours = of_kind(link.poll(), "OBSTACLE_DISTANCE")
    truth = [UNKNOWN] * 72
    for sector in range(3, 14):  # whole sectors within 10 to 70 degrees
        truth[sector] = CLEAR
    truth[7] = 1195
    assert map_of(ours) == truth
    wrong = copy.deepcopy(ours)
    for message in wrong:
        mistake(message)
    assert map_of(wrong) != truth


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


def test_points_grouped_wrongly_would_lose_obstacles() -> None:
    """A time of its own for each point leaves the last one only; one for all frames never forgets."""
    link = Link("ardupilot")
    view(
        link,
        *(Thing(link.aircraft.at_bearing(b, LEVEL_M), id=k) for k, b in enumerate((-50.0, 0.0, 50.0), 1)),
    )
    points = of_kind(link.poll(), "OBSTACLE_DISTANCE_3D")

    def faces(messages: list[Any]) -> int:
        ardupilot = ArduPilot()
        for message in messages:
            ardupilot.receive(message, 0.0)
        return len(ardupilot.faces)

    assert faces(points) == 3
    apart = copy.deepcopy(points)
    for k, message in enumerate(apart):
        message.time_boot_ms += k
    assert faces(apart) == 1


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
