"""Poses as a navigation filter with faults records them, beside the true ones."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from vista.sequence import open_sequence
from vista_eval.dataset.truth import read_truth
from vista_eval.render.course import NO_FAULTS, START_NS, Course, Gusts, PoseFaults, recorded_states
from vista_eval.render.flight import Flight, content_of, render_flight
from vista_eval.render.optics import FlawedSensor
from vista_eval.render.rig import LEFT, Rig
from vista_eval.render.scene import Scene, board, thing

COURSE = Course(6.0, 12.0, 15.0, 20, 10.0, climb_deg=5.0, bank_deg=20.0, gusts=Gusts(1.0, 3))
TRUE = [COURSE.state_at(frame) for frame in range(20)]


def test_without_faults_the_record_is_true() -> None:
    for recorded, true in zip(recorded_states(COURSE, NO_FAULTS), TRUE, strict=True):
        assert recorded.t_ns == true.t_ns
        np.testing.assert_allclose(recorded.world_from_body, true.world_from_body, atol=1e-12)
        np.testing.assert_array_equal(recorded.velocity_world_m_s, true.velocity_world_m_s)


def test_a_delayed_pose_is_that_of_before() -> None:
    recorded = recorded_states(COURSE, PoseFaults(delay_s=0.2))
    for frame in range(2, 20):
        np.testing.assert_allclose(
            recorded[frame].world_from_body, TRUE[frame - 2].world_from_body, atol=1e-9
        )
        assert recorded[frame].t_ns == TRUE[frame].t_ns
    between = recorded_states(COURSE, PoseFaults(delay_s=0.05))[5].world_from_body[:3, 3]
    before, after = (TRUE[k].world_from_body[:3, 3] for k in (4, 5))
    assert np.linalg.norm(between - (before + after) / 2) < 0.05 * np.linalg.norm(after - before)


def test_drift_grows_from_the_first_frame_on() -> None:
    recorded = recorded_states(COURSE, PoseFaults(drift_m_s=0.5, drift_deg_s=2.0, seed=5))
    errors_m = [
        a.world_from_body[:3, 3] - b.world_from_body[:3, 3] for a, b in zip(recorded, TRUE, strict=True)
    ]
    np.testing.assert_allclose(np.linalg.norm(errors_m, axis=1), 0.5 * np.arange(20) / 10, atol=1e-9)
    assert np.all(np.abs([error[2] for error in errors_m]) < 1e-9)
    turn = TRUE[10].world_from_body[:3, :3].T @ recorded[10].world_from_body[:3, :3]
    assert np.degrees(np.arccos((np.trace(turn) - 1) / 2)) == pytest.approx(2.0, rel=1e-3)
    velocity = recorded[3].velocity_world_m_s - TRUE[3].velocity_world_m_s
    np.testing.assert_allclose(velocity, errors_m[10], atol=1e-9)  # of 1 s


def test_lost_poses_are_the_last_one_again() -> None:
    recorded = recorded_states(COURSE, PoseFaults(lost=((4, 3), (18, 9))))
    for frame in range(20):
        source = 3 if 4 <= frame < 7 else 17 if frame >= 18 else frame
        np.testing.assert_array_equal(recorded[frame].world_from_body, TRUE[source].world_from_body)
        assert recorded[frame].t_ns == START_NS + round(frame * 1e8)


def one_board(altitude_m: float, _: int) -> Scene:
    grey = np.full((4, 4), 0.5, np.float32)
    sign = thing("board", "sign", [board("board", (0.0, 0.0, altitude_m), 3.0, 3.0, grey)], target=True)
    return Scene((sign,), to_sun=(-0.6, 0.4, 0.7))


FLIGHT = Flight(
    "faults",
    "poses that drift, a lens that is dirty",
    "dev",
    replace(COURSE, frames=3),
    one_board,
    Rig(96, 72, 150.0, 0.4572),
    FlawedSensor(defocus_px=(0.5, 0.8), exposure_s=0.01, vignetting=0.2, glare=0.1, dirt=(0.0, 0.05)),
    pose_faults=PoseFaults(delay_s=0.1, drift_m_s=1.0),
)


def test_the_flight_holds_both(tmp_path: Path) -> None:
    assert list(render_flight(FLIGHT, tmp_path / "a")) == [0, 1, 2]
    truth, recorded = read_truth(tmp_path / "a"), open_sequence(tmp_path / "a").frames
    faulty = recorded_states(FLIGHT.approach, FLIGHT.pose_faults)
    for frame, state in enumerate(faulty):
        expected = state.world_from_body @ FLIGHT.rig.body_from_camera(LEFT)
        found = recorded[frame].world_from_camera
        assert found is not None
        np.testing.assert_allclose(found.translation_m, expected[:3, 3], atol=1e-8)
    true = FLIGHT.approach.state_at(2).world_from_body @ FLIGHT.rig.body_from_camera(LEFT)
    assert np.linalg.norm(recorded[2].world_from_camera.translation_m - true[:3, 3]) > 0.5
    told = json.loads((tmp_path / "a" / "truth.json").read_text())["frames"][2]
    np.testing.assert_allclose(told["world_from_camera"], true, atol=1e-12)
    assert truth.times_ns[2] == told["t_ns"]
    assert content_of(FLIGHT, "full") != content_of(replace(FLIGHT, pose_faults=NO_FAULTS), "full")


def test_a_flawed_flight_is_rendered_the_same_again(tmp_path: Path) -> None:
    for name in ("a", "b"):
        list(render_flight(FLIGHT, tmp_path / name))
    files = [sorted(path for path in (tmp_path / name).rglob("*") if path.is_file()) for name in ("a", "b")]
    assert len(files[0]) > 10
    for one, other in zip(*files, strict=True):
        assert one.read_bytes() == other.read_bytes()
