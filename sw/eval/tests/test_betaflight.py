"""The multirotor that Betaflight flies: what it follows, that flights repeat, and what is said if it ends."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from command_line import assert_refused, call
from test_closed_loop import flown, small_world
from vista import parameters
from vista.errors import InputError
from vista_eval.closed_loop import betaflight
from vista_eval.closed_loop.betaflight import Betaflight, FlightController, stick
from vista_eval.closed_loop.loop import Conditions, fly
from vista_eval.closed_loop.pilots import Straight
from vista_eval.closed_loop.record import lines_of
from vista_eval.closed_loop.setpoint import Setpoint

START_M, CALM = np.array([0.0, 0, 10]), np.zeros(3)


def has_program() -> bool:
    try:
        betaflight.program()
    except InputError:
        return False
    return True


needs_program = pytest.mark.skipif(not has_program(), reason=f"needs Betaflight: {betaflight.INSTALL}")


def test_where_it_is_not_built_the_command_says_what_builds_it(tmp_path, capsys, monkeypatch):
    pytest.importorskip("rotorpy")
    monkeypatch.setattr(betaflight, "FOLDER", "build/tools/nothing")
    assert_refused(call(capsys, "fly", tmp_path, "--vehicle", "betaflight"), "make betaflight")


def test_a_stick_stands_for_a_rate_and_goes_no_further_than_its_end():
    assert (stick(0.0), stick(math.radians(180)), stick(-9.0)) == (1500, 1750, 1000)


@needs_program
def test_it_takes_up_a_velocity_and_a_heading_and_comes_to_rest():
    vehicle = Betaflight(START_M, 0.0)
    flown(vehicle, Setpoint(np.array([5.0, 0, 0]), 0.0), 3.0)
    assert vehicle.state.velocity_m_s == pytest.approx([5.0, 0.0, 0.0], abs=0.1)
    flown(vehicle, Setpoint(np.array([0.0, 5, 0]), 1.5), 3.0)
    assert vehicle.state.velocity_m_s == pytest.approx([0.0, 5.0, 0.0], abs=0.1)
    assert vehicle.state.heading_rad == pytest.approx(1.5, abs=0.03)
    flown(vehicle, Setpoint(CALM, 1.5), 3.0)
    assert np.linalg.norm(vehicle.state.velocity_m_s) < 0.1
    assert abs(vehicle.state.position_m[2] - 10.0) < 0.4


@needs_program
def test_it_turns_to_each_side_as_it_is_told():
    """The signs of all three axes, from the stick to the gyroscope."""
    for way, heading in (((3.0, 3.0), 1.0), ((-3.0, 3.0), -1.0), ((3.0, -3.0), -1.0)):
        vehicle = Betaflight(START_M, 0.0)
        flown(vehicle, Setpoint(np.array([*way, 0.0]), heading), 2.5)
        assert vehicle.state.velocity_m_s[:2] == pytest.approx(way, abs=0.15)
        assert vehicle.state.heading_rad == pytest.approx(heading, abs=0.05)


@needs_program
def test_the_same_flight_is_the_same_to_the_byte_beside_another():
    world, conditions = small_world(goal_m=6.0), Conditions(width_px=160, vehicle="betaflight")
    beside = FlightController()  # which has the first ports
    first, second = (
        fly(world, lambda seen: Straight(), parameters.defaults(), conditions, sees=False) for _ in range(2)
    )
    assert first.end == "reached"
    assert list(lines_of(first, "none")) == list(lines_of(second, "none"))
    assert beside.process.poll() is None


@needs_program
def test_it_flies_from_a_folder_whose_name_has_a_space(tmp_path, monkeypatch):
    (tmp_path / "a b").symlink_to(betaflight.CHECKOUT)
    monkeypatch.setattr(betaflight, "CHECKOUT", tmp_path / "a b")
    FlightController().run(1_000_000)


@needs_program
def test_its_process_ends_with_it_and_one_that_ended_is_named():
    controller = FlightController()
    controller.process.kill()
    controller.process.wait()
    with pytest.raises(InputError, match="ended with status -9"):
        controller.run(1_000_000)
    vehicle = Betaflight(START_M, 0.0)
    process, folder = vehicle._controller.process, vehicle._controller.memory.parent
    del vehicle
    assert process.poll() is not None
    assert not folder.exists()


@needs_program
def test_a_setting_that_it_does_not_take_is_named(monkeypatch):
    betaflight.settled.cache_clear()
    monkeypatch.setattr(betaflight, "SETTINGS", ("set no_such_thing = 1",))
    try:
        with pytest.raises(InputError, match=re.escape('does not take "set no_such_thing = 1"')):
            betaflight.settled()
    finally:
        betaflight.settled.cache_clear()


@needs_program
def test_a_dialogue_without_an_answer_is_begun_anew(monkeypatch):
    """None is answered within no time at all; the second has time, also beside other programs."""
    memory, begun, patience_s = betaflight.settled(), [], betaflight.TYPED_S

    def tell(controller):
        begun.append(controller)
        monkeypatch.setattr(betaflight, "TYPED_S", 10 * patience_s if len(begun) > 1 else -1.0)
        return told_settings(controller)

    told_settings = betaflight.told_settings
    monkeypatch.setattr(betaflight, "told_settings", tell)
    betaflight.settled.cache_clear()
    assert betaflight.settled() == memory
    assert len(begun) == 2
    betaflight.settled.cache_clear()
    monkeypatch.setattr(betaflight, "DIALOGUES", 1)
    begun.clear()
    with pytest.raises(InputError, match="does not answer"):
        betaflight.settled()
