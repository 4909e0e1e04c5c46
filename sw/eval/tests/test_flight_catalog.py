"""The list of flights: enough of them, fairly split, at the paper's speeds, down to where they shall end."""

from __future__ import annotations

import numpy as np
import pytest
from vista_eval.render.course import FOOT_M
from vista_eval.render.flight import frames_of, states_of
from vista_eval.render.rig import PAPER_RIG
from vista_eval.worlds.catalog import COMPANION_TABLE, FLIGHTS, LAST_RANGE_M, TABLE_FIRST_RANGE_M

BESIDE_THE_TABLE = (
    "overcast",
    "low_sun",
    "haze",
    "wind",
    "fences",
    "thin_pole",
    "sign_facade",
    "lamp_facade",
)
AT_SIGN_OR_POLE = (*(flight.name for flight in COMPANION_TABLE), *BESIDE_THE_TABLE)
NEAREST_MATCHED_M = PAPER_RIG.focal_px * PAPER_RIG.baseline_m / 63  # of 64 disparities


def test_there_are_nineteen_or_more_and_half_are_not_tuned_on() -> None:
    assert len(FLIGHTS) >= 19
    assert all(name == flight.name for name, flight in FLIGHTS.items())
    assert len({flight.seed for flight in FLIGHTS.values()}) == len(FLIGHTS)
    test = [flight for flight in FLIGHTS.values() if flight.split == "test"]
    assert 0.4 <= len(test) / len(FLIGHTS) <= 0.6
    for kind in ("clear", "drone"):
        splits = {flight.split for name, flight in FLIGHTS.items() if name.startswith(kind)}
        assert splits == {"dev", "test"}
    speeds_ft_s = [flight.approach.speed_m_s / FOOT_M for flight in COMPANION_TABLE]
    assert speeds_ft_s == pytest.approx([10, 30, 30, 10])


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_ends_where_it_shall_and_the_quick_one_is_its_end(name: str) -> None:
    flight = FLIGHTS[name]
    full, quick = states_of(flight), states_of(flight, "quick")
    x_m = [state.world_from_body[0, 3] for state in full]
    assert x_m[-1] == pytest.approx(-flight.approach.last_range_m) and -x_m[-1] <= LAST_RANGE_M
    assert -x_m[0] >= (29.5 if name == "close" else 63.5)
    assert len(quick) == frames_of(flight, "quick") <= 60
    np.testing.assert_allclose(
        [state.world_from_body for state in quick], [state.world_from_body for state in full[-len(quick) :]]
    )


@pytest.mark.parametrize("name", AT_SIGN_OR_POLE)
def test_a_flight_at_a_sign_or_pole_begins_where_the_papers_tracks_do(name: str) -> None:
    first_m = -states_of(FLIGHTS[name])[0].world_from_body[0, 3]
    assert first_m == pytest.approx(TABLE_FIRST_RANGE_M, abs=0.5)


def test_one_flight_goes_on_nearer_than_anything_is_matched() -> None:
    ranges_m = np.array([-state.world_from_body[0, 3] for state in states_of(FLIGHTS["close"])])
    assert FLIGHTS["close"].split == "test"
    assert np.sum(ranges_m < NEAREST_MATCHED_M) >= 10 and ranges_m[0] > 2 * NEAREST_MATCHED_M
