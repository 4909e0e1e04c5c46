"""Courses: they meet x = 0 along +x, and velocity and turn are the derivatives of place and attitude."""

from __future__ import annotations

import math

import numpy as np
import pytest
from random_seed import seed_of
from vista.geometry import quaternion_from_rotation, rotation_from_quaternion
from vista_eval.render.course import GRAVITY_M_S2, Course, Gusts, rotation_from_angles

STEP = 1e-3  # frames


def drawn(name: str) -> list[Course]:
    random = np.random.default_rng(seed_of(name))
    return [
        Course(
            altitude_m=float(random.uniform(2, 40)),
            speed_m_s=float(random.uniform(3, 25)),
            last_range_m=float(random.uniform(8, 30)),
            frames=25,
            rate_hz=10.0,
            climb_deg=float(random.uniform(-30, 30)),
            bank_deg=float(random.uniform(-45, 45)),
            gusts=Gusts(float(random.uniform(0, 3)), int(random.integers(1 << 30))),
            sway_phase_s=float(random.uniform(0, 10)),
        )
        for _ in range(6)
    ]


DIFFERENCE_S = 1e-3  # over which rates are found


def body_rate_rad_s(course: Course, frame: float) -> np.ndarray:
    """(3,) how fast the body turns about its own axes."""
    step = DIFFERENCE_S * course.rate_hz
    before, after = (
        course.state_at(frame + offset).world_from_body[:3, :3] for offset in (-step / 2, step / 2)
    )
    turn = before.T @ after
    skew = (turn - turn.T) / (2 * DIFFERENCE_S)
    return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


def test_velocity_is_the_derivative_of_the_place() -> None:
    for course in drawn("velocity"):
        for frame in (0, 11, 24):
            before, after = (course.state_at(frame + step).world_from_body[:3, 3] for step in (-STEP, STEP))
            moved_m_s = (after - before) / (2 * STEP / course.rate_hz)
            np.testing.assert_allclose(course.state_at(frame).velocity_world_m_s, moved_m_s, atol=2e-5)


def test_a_steady_turn_keeps_bank_speed_and_height_and_its_lift_bends_the_path() -> None:
    """Speed 12 m/s, bank 30 degrees: the acceleration is what the lift adds to gravity, and the body turns
    about the world's z as fast as the path does."""
    for climb_deg, bank_deg in ((0.0, 30.0), (0.0, -45.0), (15.0, 30.0), (-20.0, -20.0)):
        course = Course(10.0, 12.0, 20.0, 25, 10.0, climb_deg, bank_deg, sway_scale=0.0)
        for frame in (0, 12, 24):
            state = course.state_at(frame)
            rotation, velocity = state.world_from_body[:3, :3], state.velocity_world_m_s
            np.testing.assert_allclose(rotation[:, 0] * 12.0, velocity, atol=1e-9)
            before, after = (course.state_at(frame + s).velocity_world_m_s for s in (-STEP, STEP))
            lift = (after - before) / (2 * STEP / course.rate_hz) + [0.0, 0.0, GRAVITY_M_S2]
            assert lift @ rotation[:, 1] == pytest.approx(0.0, abs=1e-4)  # nothing pushes it sideways
            rate = rotation @ body_rate_rad_s(course, frame)
            np.testing.assert_allclose(rate, [0.0, 0.0, course.turn_rate_rad_s], atol=1e-5)
        expected = -GRAVITY_M_S2 * math.tan(math.radians(bank_deg)) / 12.0
        assert course.turn_rate_rad_s == pytest.approx(expected)


def test_every_course_meets_the_scene_along_x() -> None:
    """The meeting is last range / speed after the last frame; without sway exactly."""
    for course in drawn("meeting"):
        still = Course(
            course.altitude_m, course.speed_m_s, course.last_range_m, 25, 10.0, course.climb_deg,
            course.bank_deg, course.gusts, sway_scale=0.0,
        )  # fmt: skip
        meeting = 24 + still.rate_hz * still.last_range_m / still.speed_m_s
        pose, velocity = still.state_at(meeting).world_from_body, still.state_at(meeting).velocity_world_m_s
        np.testing.assert_allclose(pose[:3, 3], [0.0, 0.0, course.altitude_m], atol=1e-9)
        through_air = velocity - course.gusts.wind_m_s(0.0)
        climb = math.radians(course.climb_deg)
        expected = course.speed_m_s * np.array([math.cos(climb), 0.0, math.sin(climb)])
        np.testing.assert_allclose(through_air, expected, atol=1e-9)
        way_m = [
            np.linalg.norm(
                np.diff([still.path_m(t) for t in np.linspace(still.before_meeting_s(24), 0, 400)], axis=0),
                axis=1,
            ).sum()
        ]
        assert way_m[0] == pytest.approx(course.last_range_m, rel=1e-3)


def test_a_bank_to_the_right_turns_to_the_right() -> None:
    course = Course(10.0, 20.0, 20.0, 25, 10.0, bank_deg=40.0, sway_scale=0.0)
    first, last = course.state_at(0).world_from_body, course.state_at(24).world_from_body
    assert first[2, 1] > 0.5  # the left wing is up
    assert np.cross(first[:3, 0], last[:3, 0])[2] < -0.1  # clockwise from above
    assert first[1, 3] < -5.0 and first[0, 0] < last[0, 0]


def test_straight_and_level_leads_along_x_but_for_the_sway() -> None:
    course = Course(6.0, 9.0, 20.0, 25, 10.0, sway_phase_s=3.0)
    for frame in (0, 13, 24):
        place_m = course.state_at(frame).world_from_body[:3, 3]
        expected = [-20.0 - 0.9 * (24 - frame), 0.0, 6.0]
        np.testing.assert_allclose(place_m, expected, atol=max(0.06, 0.04) + 1e-9)
        assert place_m[0] == pytest.approx(expected[0], abs=1e-9)


def test_gusts_have_their_strength_and_depend_on_the_seed() -> None:
    seed = seed_of("gusts")
    # At random times over days: at regular ones a wave that keeps step with them shows one phase alone.
    gusts, times_s = Gusts(2.0, seed), np.random.default_rng(seed).uniform(0.0, 1e6, 40_000)
    winds = np.array([gusts.wind_m_s(t_s) for t_s in times_s])
    np.testing.assert_allclose(winds.std(axis=0), 2.0, rtol=0.03)
    np.testing.assert_allclose(winds.mean(axis=0), 0.0, atol=0.05)
    assert np.abs(Gusts(2.0, seed + 1).wind_m_s(1.0) - Gusts(2.0, seed).wind_m_s(1.0)).max() > 1e-6
    assert not np.any(Gusts(0.0, seed).wind_m_s(1.0)) and not np.any(Gusts(0.0, seed).drift_m(1.0))


def test_quaternions_of_half_turns_too() -> None:
    random = np.random.default_rng(seed_of("quaternions"))
    turns = [(0, 0, 180), (180, 0, 0), (0, 180, 0), (45, 0, 179.9), *random.uniform(-180, 180, (50, 3))]
    for angles in turns:
        rotation = rotation_from_angles(*angles)
        np.testing.assert_allclose(
            rotation_from_quaternion(quaternion_from_rotation(rotation)), rotation, atol=1e-9
        )
