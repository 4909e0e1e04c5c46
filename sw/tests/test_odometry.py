"""Poses from the images alone: how far they drift, and that they are never used unasked."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
import source_cases
from command_line import Vista, assert_refused
from fly_process import fly, timeless
from numpy.typing import NDArray
from shared_data import SHARED_DATA
from vista import parameters
from vista.chain import make_chain, run_frame
from vista.geometry import Calibration, Pose
from vista.odometry import LOST_FRAMES, StereoOdometry
from vista.sequence import Frame, Options, Sequence, open_sequence

pytestmark = pytest.mark.slow


def estimated(sequence: Sequence) -> list[Pose]:
    """The estimated pose of every frame, in the frame of the first one."""
    chain = make_chain(sequence, "golden", parameters.defaults(), 1)
    poses = []
    for files in sequence.frames:
        step = run_frame(chain, files)
        assert step.world_from_camera is not None, files.index
        poses.append(step.world_from_camera)
    return poses


def truth(sequence: Sequence) -> list[Pose]:
    first = sequence.frames[0].world_from_camera
    return [first.inverse() @ files.world_from_camera for files in sequence.frames]


def drift(found: list[Pose], true: list[Pose]) -> tuple[float, float, float]:
    """Largest error of the place (m) and of the direction (degrees), and the length of the way (m)."""
    errors = [a.inverse() @ b for a, b in zip(found, true, strict=True)]
    angles_deg = [np.degrees(np.arccos(np.clip((np.trace(e.rotation) - 1) / 2, -1, 1))) for e in errors]
    steps_m = np.diff([pose.translation_m for pose in true], axis=0)
    way_m = float(np.linalg.norm(steps_m, axis=1).sum())
    return max(float(np.linalg.norm(e.translation_m)) for e in errors), max(angles_deg), way_m


def test_a_flight_from_its_images(tmp_path: Path) -> None:
    source_cases.record_flight(tmp_path / "flight")
    sequence = open_sequence(tmp_path / "flight", Options(odometry=True))
    assert all(files.world_from_camera is None for files in sequence.frames)
    error_m, angle_deg, way_m = drift(estimated(sequence), truth(open_sequence(tmp_path / "flight")))
    assert way_m == pytest.approx(19.0)
    assert error_m < 0.03 * way_m
    assert angle_deg < 1.6


@pytest.mark.parametrize(
    ("name", "place_m", "direction_deg"),
    [("kitti_odometry/sequences/00", 0.75, 1.6), ("euroc_v101", 0.006, 0.12)],
)
def test_drift_on_real_recordings(name: str, place_m: float, direction_deg: float) -> None:
    """Measured: 0.54 m and 1.3 degrees on 60 m of a street, 3 mm and 0.06 degrees of a vehicle at rest."""
    folder = SHARED_DATA / name
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there")
    found = estimated(open_sequence(folder, Options(odometry=True)))
    error_m, angle_deg, _ = drift(found, truth(open_sequence(folder)))
    assert error_m < place_m
    assert angle_deg < direction_deg


# ---- when it cannot tell ----

CAMERA = Calibration(320, 240, 300.0, 160.0, 120.0, 0.5)
WORDS = np.full((240, 320), 16 * 12, np.int16)
DARK = np.zeros((240, 320), np.uint8)


def picture(seed: int = 0) -> NDArray[np.uint8]:
    return cases.texture_pair(seed, 320, 240)[0]


def test_standing_still() -> None:
    odometry = StereoOdometry(CAMERA)
    for _ in range(3):
        pose = odometry.update(picture(), WORDS)
        assert pose is not None
        np.testing.assert_allclose(pose.translation_m, 0.0, atol=1e-3)


def test_a_step_to_the_side() -> None:
    """A wall at 12 px is 12.5 m away; 6 px further left it is seen from 0.25 m further right."""
    shifted = np.roll(picture(), -6, axis=1)
    odometry = StereoOdometry(CAMERA)
    odometry.update(picture(), WORDS)
    pose = odometry.update(shifted, WORDS)
    assert pose is not None
    # On one plane a small turn looks much like a small step, so the two together are compared.
    seen_m = pose.inverse().apply(np.array([0.0, 0.0, 12.5]))
    np.testing.assert_allclose(seen_m, [-0.25, 0.0, 12.5], atol=0.03)


def test_no_pose_is_guessed_and_the_reference_waits() -> None:
    odometry = StereoOdometry(CAMERA)
    assert odometry.update(DARK, WORDS) is None
    assert odometry.update(picture(), np.full_like(WORDS, -16)) is None
    assert odometry.update(picture(), WORDS) is not None
    for _ in range(LOST_FRAMES - 1):
        assert odometry.update(DARK, WORDS) is None
    found_again = odometry.update(np.roll(picture(), -3, axis=1), WORDS)
    assert found_again is not None and odometry.restarts == 0
    for _ in range(LOST_FRAMES):
        assert odometry.update(picture(1), WORDS) is None
    anew = odometry.update(picture(1), WORDS)
    assert anew is not None
    np.testing.assert_array_equal(anew.translation_m, 0.0)
    assert odometry.restarts == 1
    odometry.reset()
    assert odometry.update(picture(), WORDS) is not None and odometry.restarts == 1  # nothing went on


# ---- when it begins anew ----


def lost_flight(folder: Path) -> Path:
    """20 frames at 10 m/s; in six of them the cameras see nothing."""
    pairs = source_cases.write_pairs(folder, source_cases.record_flight(folder.with_name("recorded")))
    for path in sorted(pairs.glob("*_left.*"))[8:14] + sorted(pairs.glob("*_right.*"))[8:14]:
        dark = np.zeros_like(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE))
        cv2.imwrite(str(path), dark)
    return pairs


def test_the_host_begins_anew_with_it(tmp_path: Path) -> None:
    """Else the way from the last pose to the first of the new world is taken for motion."""
    sequence = open_sequence(lost_flight(tmp_path / "flight"), Options(odometry=True))
    chain = make_chain(sequence, "golden", parameters.defaults(), 1)
    steps = [run_frame(chain, files) for files in sequence.frames]
    assert [step.raw.index for step in steps if step.anew] == [14]
    assert steps[7].result.motion.velocity_m_s is not None
    assert steps[14].result.motion.velocity_m_s is None and not steps[14].result.motion.restarted
    ids = [{o.id for o in step.result.obstacles if o.kind == "thing"} for step in steps]
    assert ids[7] and ids[16] and not set.union(*ids[:14]) & set.union(*ids[14:])
    velocity_m_s = steps[-1].result.motion.velocity_m_s
    assert velocity_m_s is not None
    np.testing.assert_allclose(velocity_m_s, [0.0, 0.0, 10.0], atol=2.0)


def test_a_recording_of_it_is_replayed_alike(tmp_path: Path, run_vista: Vista) -> None:
    record, out = tmp_path / "flight.rec", tmp_path / "out"
    run = ("run", lost_flight(tmp_path / "flight"), "--no-overlay", "--out", out)
    status, _, err = run_vista(*run, "--poses", "odometry", "--record", record)
    assert status == 0
    assert "frame 14: degraded: the poses began anew; all tracks were dropped" in err
    replayed = fly("--recording", record, "--all-frames", "--out", tmp_path / "lines.jsonl")
    assert replayed.returncode == 0, replayed.stderr
    written = timeless(out / "obstacles.jsonl")
    assert timeless(tmp_path / "lines.jsonl") == written
    assert "pose_jump" in json.loads(written[14])["health"]["reasons"]


# ---- never unasked ----


def test_it_is_said_wherever_results_are(tmp_path: Path, run_vista: Vista) -> None:
    source_cases.record_flight(tmp_path / "flight", frames=5)
    run = ("run", tmp_path / "flight", "--no-overlay", "--out")
    status, out, err = run_vista(*run, tmp_path / "out", "--poses", "odometry")
    assert (status, err) == (0, "")
    note = "poses are estimated from the images (--poses odometry): they drift, and may be wrong"
    assert f"flight: note: {note}" in out
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["notes"] == [note]
    assert summary["stages_ms"]["odometry"]["median"] > 0.0
    assert note in (tmp_path / "out" / "report.html").read_text()
    lines = [json.loads(line) for line in (tmp_path / "out" / "obstacles.jsonl").read_text().splitlines()]
    assert lines[-1]["motion"] == "known"

    (tmp_path / "flight/mav0/state_groundtruth_estimate0/data.csv").unlink()
    status, out, _ = run_vista(*run, tmp_path / "without")
    assert status == 0 and note not in out
    lines = [json.loads(line) for line in (tmp_path / "without/obstacles.jsonl").read_text().splitlines()]
    assert {line["motion"] for line in lines} == {"unknown"}


def test_live_says_it_too(tmp_path: Path, run_vista: Vista) -> None:
    source_cases.record_flight(tmp_path / "flight", frames=3)
    lines = tmp_path / "lines.jsonl"
    status, _, err = run_vista(
        "live", tmp_path / "flight", "--no-page", "--out", lines, "--poses", "odometry"
    )
    assert status == 0
    assert err.startswith("flight: note: poses are estimated from the images (--poses odometry): they drift")


def test_where_it_makes_no_sense(tmp_path: Path, run_vista: Vista) -> None:
    stills = cases.make_board_scenes(tmp_path / "stills", 2, stills=True)
    pairs = cases.make_board_scenes(tmp_path / "pairs", 2, stills=False)
    run = ("--poses", "odometry", "--out", tmp_path / "out")
    assert_refused(run_vista("run", pairs, *run), "times.csv: no such file: odometry needs the times")
    (stills / "times.csv").write_text("name,t_s\nscene00,0\nscene01,1\n")
    assert_refused(run_vista("run", stills, *run), f"--poses: does not go with {stills}, which shows unrel")
    assert not (tmp_path / "out").exists()


def test_frames_are_left_as_they_were(tmp_path: Path) -> None:
    """The reader's own poses are not mixed with those of the odometry."""
    folder = cases.make_flown_pairs(tmp_path / "pairs")
    sequence = open_sequence(folder, Options(odometry=True))
    frame: Frame = sequence.read(sequence.frames[0])
    assert sequence.odometry and frame.world_from_camera is None
    assert len(sequence.frames) == cases.FRAMES
