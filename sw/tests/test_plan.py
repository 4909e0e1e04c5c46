"""What the planner decides before simple views."""

from __future__ import annotations

import numpy as np
import pytest
from plan_library import Planner, goal_of, seen_world, state_of
from space_library import UNMATCHED, Wall
from stage_library import ffi, lib


def test_before_open_space_it_flies_straight_at_the_speed_of_the_goal() -> None:
    decision = Planner().decide(seen_world(), state_of(velocity=(0.0, 0.0, 5.0)), goal_of())
    assert decision.action == "proceeds"
    chosen = decision.options[decision.chosen]
    assert (chosen.primitive, chosen.ruling) == ("straight", "chosen")
    np.testing.assert_allclose(decision.setpoint.velocity_m_s, [0.0, 0.0, 5.0], atol=0.1)


def test_each_plan_ends_in_a_stop_that_is_held() -> None:
    decision = Planner().decide(seen_world(), state_of(velocity=(0.0, 0.0, 8.0)), goal_of(speed_m_s=8.0))
    assert not decision.points[-1]["velocity_m_s"].any()
    late = decision.at(100.0)
    np.testing.assert_array_equal(late.position_m, decision.points[-1]["position_m"])


@pytest.mark.parametrize("z_m", [12.0, 20.0])
def test_it_leaves_its_way_before_a_board(z_m: float) -> None:
    space = seen_world([Wall(z_m, (-2.0, 2.0))])
    decision = Planner(plan__climb_max_m_s=0.0).decide(space, state_of(velocity=(0.0, 0.0, 5.0)), goal_of())
    assert decision.action == "evades"
    assert abs(decision.options[decision.chosen].direction[0]) > 0.1


def test_before_a_wall_that_fills_the_view_it_stops_and_says_what_is_there() -> None:
    space = seen_world([Wall(8.0)])
    decision = Planner().decide(space, state_of(), goal_of())
    straight = next(o for o in decision.options if o.primitive == "straight")
    assert straight.ends == "by_place" and straight.free_m == pytest.approx(8.0, rel=0.1)
    end = decision.points[-1]["position_m"]
    assert end[2] < 8.0 - 1.0


def test_what_nobody_has_seen_is_not_flown_into() -> None:
    space = seen_world()
    space.reset()
    for k in range(6):
        space.take(UNMATCHED, 1.0 + 0.1 * k)
    decision = Planner().decide(space, state_of(t_s=2.0), goal_of())
    assert decision.action == "holds"
    assert {o.ends for o in decision.options if o.primitive == "straight"} == {"by_unknown"}
    assert not decision.points["velocity_m_s"].any()


def test_a_planner_begins_anew_after_a_reset() -> None:
    planner = Planner()
    space, state, goal = seen_world([Wall(15.0, (-1.0, 3.0))]), state_of(velocity=(0.0, 0.0, 5.0)), goal_of()
    first = planner.decide(space, state, goal)
    lib.vista_planner_reset(planner.handle)
    again = planner.decide(space, state, goal)
    assert first.memory == again.memory


def test_what_is_no_state_is_refused() -> None:
    planner, space, goal = Planner(), seen_world(), goal_of()
    for changes, status in (
        ({"position_m": [float("nan"), 0.0, 0.0]}, "VISTA_ERROR_NUMBER"),
        ({"up": [0.0, -2.0, 0.0]}, "VISTA_ERROR_RANGE"),
        ({"heading": [0.0, 1.0, 0.0]}, "VISTA_ERROR_RANGE"),
    ):
        state = ffi.new("vista_plan_state *", {"t_ns": 1, "up": [0, -1, 0], "heading": [0, 0, 1]} | changes)
        assert planner.try_to(space, state, goal)[0] == status
    assert planner.try_to(space, state_of(t_s=2.0), goal)[0] == "VISTA_OK"
    assert planner.try_to(space, state_of(t_s=1.0), goal)[0] == "VISTA_ERROR_ORDER"
