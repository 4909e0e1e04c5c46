"""The list of flights: enough of them, fairly split, at the paper's speeds, down to where they shall end."""

from __future__ import annotations

import numpy as np
import pytest
from vista.flights.catalog import COMPANION_TABLE, FLIGHTS, LAST_RANGE_M
from vista.flights.flight import frames_of, states_of
from vista.flights.labelled import labelled
from vista.flights.trajectory import FOOT_M


def test_there_are_nineteen_or_more_and_half_are_not_tuned_on() -> None:
    assert len(FLIGHTS) >= 19
    assert all(name == flight.name for name, flight in FLIGHTS.items())
    assert len({flight.seed for flight in FLIGHTS.values()}) == len(FLIGHTS)
    report = [flight for flight in FLIGHTS.values() if flight.split == "report"]
    assert 0.4 <= len(report) / len(FLIGHTS) <= 0.6
    for kind in ("clear", "drone"):
        splits = {flight.split for name, flight in FLIGHTS.items() if name.startswith(kind)}
        assert splits == {"tune", "report"}
    speeds_ft_s = [flight.approach.speed_m_s / FOOT_M for flight in COMPANION_TABLE]
    assert speeds_ft_s == pytest.approx([10, 30, 30, 10])


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_ends_where_it_shall_and_the_quick_one_is_its_end(name: str) -> None:
    flight = FLIGHTS[name]
    full, quick = states_of(flight), states_of(flight, "quick")
    x_m = [state.world_from_body[0, 3] for state in full]
    assert x_m[-1] == pytest.approx(-flight.approach.last_range_m) and -x_m[-1] <= LAST_RANGE_M
    assert -x_m[0] >= 63.5
    assert len(quick) == frames_of(flight, "quick") <= 60
    np.testing.assert_allclose(
        [state.world_from_body for state in quick], [state.world_from_body for state in full[-len(quick) :]]
    )


def test_a_labelled_scene_is_a_flight_of_one_frame() -> None:
    flight = labelled(7)
    assert (flight.name, flight.split, frames_of(flight), frames_of(flight, "quick")) == (
        "scene_0007",
        "report",
        1,
        1,
    )
    pose = states_of(flight)[0].world_from_body
    assert pose[2, 3] == flight.approach.altitude_m
    assert labelled(8).split == "tune"
