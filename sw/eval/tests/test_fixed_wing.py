"""The fixed wing in the loop: what its autopilot follows, and the worlds that it can turn round in."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from command_line import assert_refused, call
from small_worlds import coarse_textures
from vista import parameters
from vista_eval.closed_loop.collision import Geometry
from vista_eval.closed_loop.loop import Conditions, arrived, fly, legs_of
from vista_eval.closed_loop.outcome import outcome_of
from vista_eval.closed_loop.pilots import Straight
from vista_eval.closed_loop.places.catalog import FAMILIES
from vista_eval.closed_loop.places.parts import scene
from vista_eval.closed_loop.setpoint import Setpoint
from vista_eval.closed_loop.vehicle import GRAVITY_M_S2, STEP_S
from vista_eval.closed_loop.vehicles import VEHICLES, fitted
from vista_eval.closed_loop.wing import FixedWing, rotation_of
from vista_eval.closed_loop.world import World

pytest.importorskip("jsbsim")
START_M, SPEED_M_S, CALM = np.array([0.0, 0.0, 30.0]), 18.0, np.zeros(3)
KIND = VEHICLES["fixed-wing"]
WINGED = Conditions(width_px=640, view_deg=70.0, vehicle="fixed-wing")


def flown_straight(
    wing: FixedWing, seconds: float, wind_m_s: np.ndarray = CALM, climb_m_s: float = 0.0
) -> None:
    for _ in range(round(seconds / STEP_S)):
        wing.step(Setpoint(np.array([SPEED_M_S, 0.0, climb_m_s]), 0.0), wind_m_s)


def test_it_keeps_its_airspeed_its_height_and_its_course_in_wind():
    wing, wind = FixedWing(START_M, 0.0, SPEED_M_S), np.array([-4.0, 3.0, 0.0])
    flown_straight(wing, 20.0, wind)
    state = wing.state
    assert np.linalg.norm(state.velocity_m_s - wind) == pytest.approx(SPEED_M_S, abs=0.3)
    assert abs(state.velocity_m_s[1]) < 0.2
    before = state.position_m
    flown_straight(wing, 10.0, wind)
    assert abs(wing.state.position_m[2] - before[2]) < 1.0


def test_it_climbs_as_fast_as_it_is_told():
    wing = FixedWing(START_M, 0.0, SPEED_M_S)
    flown_straight(wing, 6.0, climb_m_s=3.0)
    assert wing.state.velocity_m_s[2] == pytest.approx(3.0, abs=0.3)
    assert np.linalg.norm(wing.state.velocity_m_s) > 0.9 * SPEED_M_S


@pytest.mark.parametrize("side", [1, -1])
def test_it_follows_a_circle_of_the_planner(side):
    """Rolled into as the planner does it, at 1 rad/s to 40 degrees."""
    wing = FixedWing(START_M, 0.0, SPEED_M_S)
    flown_straight(wing, 2.0)
    place, heading, bank = wing.state.position_m, 0.0, 0.0
    for _ in range(1000):
        bank = min(bank + STEP_S, math.radians(40.0))
        rate = side * GRAVITY_M_S2 * math.tan(bank) / SPEED_M_S
        heading += rate * STEP_S
        way, left = (np.array([math.cos(a), math.sin(a), 0.0]) for a in (heading, heading + math.pi / 2))
        place = place + SPEED_M_S * STEP_S * way
        wing.step(Setpoint(SPEED_M_S * way, heading, place, SPEED_M_S * rate * left), CALM)
        assert np.linalg.norm(wing.state.position_m - place) < 3.0
    assert np.linalg.norm(wing.state.position_m - place) < 1.0
    leaning = wing.state.rotation[2, 1]  # of the left wing, upwards
    assert leaning == pytest.approx(-side * math.sin(math.radians(40.0)), abs=0.06)


def test_it_does_not_stall_whatever_is_asked():
    wing = FixedWing(START_M, 0.0, SPEED_M_S)
    for k in range(1500):
        heading = math.pi * (k // 200)  # about turns
        wing.step(Setpoint(SPEED_M_S * np.array([math.cos(heading), math.sin(heading), 0.3]), heading), CALM)
        assert np.linalg.norm(wing.state.velocity_m_s) > 12.8


def test_climbing_turns_to_both_sides_in_turn_do_not_pull_it_into_a_stall():
    """The lift is greatest at an angle of attack of 10 degrees."""
    wing = FixedWing(START_M, 0.0, SPEED_M_S)
    flown_straight(wing, 2.0)
    place, heading, bank = wing.state.position_m, 0.0, 0.0
    for k in range(1500):
        side = 1 if k // 200 % 2 else -1
        bank += float(np.clip(side * math.radians(40.0) - bank, -STEP_S, STEP_S))
        rate = GRAVITY_M_S2 * math.tan(bank) / SPEED_M_S
        heading += rate * STEP_S
        way, left = (np.array([math.cos(a), math.sin(a), 0.0]) for a in (heading, heading + math.pi / 2))
        told = SPEED_M_S * way + np.array([0.0, 0.0, 3.0])
        place = place + told * STEP_S
        if np.linalg.norm(place - wing.state.position_m) > 1.5:  # it has left the trajectory
            place = wing.state.position_m
        wing.step(Setpoint(told, heading, place, SPEED_M_S * rate * left), CALM)
        assert wing.angle_of_attack_rad < math.radians(10.0)
    assert np.linalg.norm(wing.state.velocity_m_s) > 0.95 * SPEED_M_S


def test_axes_of_the_body_lead_ahead_left_and_up():
    nose_up = rotation_of(0.0, -0.2, 0.0) @ [1.0, 0.0, 0.0]
    assert nose_up == pytest.approx([math.cos(0.2), 0.0, math.sin(0.2)])
    right_wing_down = rotation_of(0.3, 0.0, 0.0) @ [0.0, -1.0, 0.0]
    assert right_wing_down[2] == pytest.approx(-math.sin(0.3))


def test_an_empty_world_is_flown_past_its_goal():
    made = scene(3, "gravel", [], (-2.0, 20.0), (-8.0, 8.0))
    world = fitted(World("small", "small", made, ((0.0, 0.0, 9.0), (80.0, 30.0, 9.0)), 3.0), KIND)
    flight = fly(world, lambda seen: Straight(), parameters.defaults(), WINGED, sees=False)
    outcome = outcome_of(flight, "none")
    assert (outcome.end, outcome.speed_m_s) == ("reached", SPEED_M_S)
    assert abs(outcome.detour) < 0.2


@pytest.mark.slow
def test_a_goal_counts_as_passed_when_it_lies_behind_and_not_far_off():
    world = replace(FAMILIES["clear"].world(0, 1), route_m=((0.0, 0.0, 10.0), (100.0, 0.0, 10.0)))
    (leg,) = legs_of(world, KIND)
    assert arrived(np.array([93.0, 5.0, 10.0]), leg, KIND)
    assert arrived(np.array([101.0, 25.0, 10.0]), leg, KIND)
    assert not arrived(np.array([99.0, 25.0, 10.0]), leg, KIND)
    (stopped,) = legs_of(world, VEHICLES["multirotor"])
    assert not arrived(np.array([101.0, 5.0, 10.0]), stopped, VEHICLES["multirotor"])


@pytest.mark.slow
@pytest.mark.parametrize("family", [name for name, family in FAMILIES.items() if family.wide])
def test_on_the_route_something_stands_in_every_wide_world_but_the_clear_one(family, monkeypatch):
    coarse_textures(monkeypatch)
    world = FAMILIES[family].world(1, 1)
    geometry, (start, goal) = Geometry(world.scene), map(np.array, world.route_m)
    shares = np.linspace(0.0, 1.0, 320)[:, None]
    nearest = [geometry.nearest(place).distance_m for place in start + shares * (goal - start)]
    assert (min(nearest) > 50.0) if family == "wide_clear" else (min(nearest) < KIND.radius_m)
    assert nearest[0] > 25.0


def test_a_rival_that_stops_is_refused(tmp_path, capsys):
    options = "--vehicle", "fixed-wing", "--rival", "brake"
    assert_refused(call(capsys, "fly", tmp_path, *options), "cannot stop")
