"""The checks of a run's own input: each fault of a sequence is named on the screen, in the summary and in the
lines of its frames; without a fault nothing is said."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
import vista.chain
from command_line import Vista, call
from fake_pipeline import FakeDetector
from numpy.typing import NDArray
from obstacle_schema import valid_lines
from random_seed import seeded
from vista.health import checks
from vista.health.features import image_motion_px, match_pair
from vista.health.finding import Finding, FrameHealth, Reason, State
from vista.sequence import read_grey

pytestmark = pytest.mark.slow

FRAMES = 6
WIDTH, HEIGHT = 320, 240
CALIBRATION = "focal_px = 240.0\ncx = 160.0\ncy = 120.0\nbaseline_m = 0.25\n"


@pytest.fixture
def run_vista(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Vista:
    monkeypatch.setattr(vista.chain, "Detector", FakeDetector)
    return partial(call, capsys)


def make_kitti(root: Path, frames: int = FRAMES) -> Path:
    """A flight past one wall with texture, 3 px a frame; returns sequences/00."""
    folder = cases.make_kitti(root, frames)
    wide, _ = cases.texture_pair(1, WIDTH + 3 * frames + 20, HEIGHT)
    for index in range(frames):
        for name, shift in (("image_0", 0), ("image_1", 8)):
            first = 3 * index + shift
            cases.write_image(folder / name / f"{index:06d}.png", wide[:, first : first + WIDTH])
    rows = {"P0": 0.0, "P1": -240.0 * 0.25}
    lines = [f"{key}: 240 0 160 {offset} 0 240 120 0 0 0 1 0\n" for key, offset in rows.items()]
    (folder / "calib.txt").write_text("".join(lines))
    aside_m = 3 * 0.25 / 8  # the wall's disparity is 8 px
    poses = "".join(f"1 0 0 {index * aside_m} 0 1 0 0 0 0 1 0\n" for index in range(frames))
    (root / "poses" / "00.txt").write_text(poses)
    return folder


def each_image(folder: Path, name: str, change: Callable[[NDArray[np.uint8]], NDArray[np.uint8]]) -> None:
    for path in sorted((folder / name).iterdir()):
        cases.write_image(path, change(read_grey(path)))


def swap(folder: Path) -> None:
    (folder / "image_0").rename(folder / "other")
    (folder / "image_1").rename(folder / "image_0")
    (folder / "other").rename(folder / "image_1")


def copy_left(folder: Path) -> None:
    for path in (folder / "image_0").iterdir():
        (folder / "image_1" / path.name).write_bytes(path.read_bytes())


def other_scene(folder: Path) -> None:
    for index, path in enumerate(sorted((folder / "image_1").iterdir())):
        cases.write_image(path, cases.texture_pair(100 + index, WIDTH, HEIGHT)[0])


ALL = list(range(FRAMES))

# Reason, state, frames, and what the line on the screen says.
FAULTS: dict[str, tuple[cases.Damage, Reason, State, list[int], str]] = {
    "left and right swapped": (
        swap,
        Reason.LEFT_RIGHT_SWAPPED,
        State.BLIND,
        ALL,
        "are left and right swapped?",
    ),
    "right image 6 rows off": (
        lambda folder: each_image(folder, "image_1", lambda image: np.roll(image, 6, axis=0)),
        Reason.ROWS_MISALIGNED,
        State.BLIND,
        ALL,
        "features lie 6.0 px apart in rows",
    ),
    "right image 1.5 rows off": (
        lambda folder: each_image(
            folder,
            "image_1",
            lambda image: cv2.warpAffine(image, np.array([[1, 0, 0], [0, 1, 1.5]]), (WIDTH, HEIGHT)),
        ),
        Reason.ROWS_MISALIGNED,
        State.DEGRADED,
        ALL,
        "features lie 1.4 px apart in rows",
    ),
    "right image of another scene": (
        other_scene,
        Reason.MOMENTS_DIFFER,
        State.BLIND,
        ALL,
        "do left and right image, in this order, show one moment?",
    ),
    "black image": (
        lambda folder: cases.write_image(folder / "image_1/000003.png", np.zeros((HEIGHT, WIDTH), np.uint8)),
        Reason.NO_CONTRAST,
        State.BLIND,
        [3],
        "the right image is nearly constant: grey level 0",
    ),
    "identical images": (
        copy_left,
        Reason.IMAGES_IDENTICAL,
        State.BLIND,
        ALL,
        "the left and the right image are identical",
    ),
    "calibration of images half the size": (
        cases.edit("calib.txt", "160", "80"),
        Reason.CALIBRATION_MISFIT,
        State.DEGRADED,
        ALL,
        "does the calibration belong to images of another size?",
    ),
    "focal length of another camera": (
        cases.edit("calib.txt", " 240", " 24000"),
        Reason.CALIBRATION_MISFIT,
        State.DEGRADED,
        ALL,
        "field of view 1 degrees wide",
    ),
    "baseline in millimetres": (
        cases.edit("calib.txt", "-60.0", "-60000.0"),
        Reason.BASELINE_IMPLAUSIBLE,
        State.DEGRADED,
        ALL,
        "the baseline is 250 m, expected 0.01 to 5 m: is it in millimetres?",
    ),
    "a moving camera without poses": (
        lambda folder: (folder / "../../poses/00.txt").resolve().unlink(),
        Reason.MOTION_UNKNOWN,
        State.DEGRADED,
        ALL[1:],
        "the image moves by 3.0 px a frame, but no poses are given",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_every_fault_is_named_wherever_results_are(tmp_path: Path, run_vista: Vista, name: str) -> None:
    damage, reason, state, frames, text = FAULTS[name]
    folder, out = make_kitti(tmp_path / "flight"), tmp_path / "out"
    damage(folder)
    status, stdout, stderr = run_vista("run", folder, "--out", out, "--no-overlay")
    assert status == 0
    named = [line for line in stderr.splitlines() if text in line]
    assert named == [line for line in named if line.startswith(f"vista: frame {frames[0]}: {state}: ")]
    assert len(named) == 1
    assert sum(text in line for line in stdout.splitlines()) == 1

    lines = valid_lines(out)
    affected = [line["frame"] for line in lines if reason in line["health"]["reasons"]]
    assert affected == frames
    assert all(line["health"]["state"] == state for line in lines if line["frame"] in frames)
    health = json.loads((out / "summary.json").read_text())["health"]
    problem = next(problem for problem in health["problems"] if problem["reason"] == reason)
    assert (problem["state"], problem["frames"], problem["first_frame"]) == (state, len(frames), frames[0])
    assert text in problem["text"]
    assert health["state"] == state
    share = f"all {FRAMES} frames" if frames == ALL else f"{len(frames)} of {FRAMES} frames"
    assert f"the view was {state} in {share}: " in stdout
    assert ("does not mean free space" in stdout) == (state == State.BLIND)


def test_a_pair_that_is_swapped_and_has_no_poses_is_blind_and_nothing_else(
    tmp_path: Path, run_vista: Vista
) -> None:
    """What is found in blind frames is neither counted as an obstacle nor as a warning; the health is one
    line, and the lesser problem does not call the same frames degraded."""
    folder, out = make_kitti(tmp_path / "flight"), tmp_path / "out"
    swap(folder)
    (tmp_path / "flight/poses/00.txt").unlink()
    _, stdout, _ = run_vista("run", folder, "--out", out, "--no-overlay")
    assert any(line["nearest_collision"] for line in valid_lines(out))
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["frames_with_collision"], summary["obstacles_confirmed"]) == (0, 0)
    figures, health, report = stdout.splitlines()
    assert "6 frames, 0 obstacles tracked, 0 frames with a collision warning" in figures
    assert "the view was blind in all 6 frames: " in health and "are left and right swapped?" in health
    assert "also motion_unknown" in health and "degraded" not in stdout
    page = Path(report.removeprefix("report: ")).read_text()
    assert "Nothing can be said of obstacles: the view was blind in all 6 frames." in page
    assert "are left and right swapped? That nothing is found there" in page


def test_a_recording_without_poses_is_told_how_to_have_them_estimated(
    tmp_path: Path, run_vista: Vista
) -> None:
    folder, out = make_kitti(tmp_path / "flight"), tmp_path / "out"
    (tmp_path / "flight/poses/00.txt").unlink()
    _, stdout, stderr = run_vista("run", folder, "--out", out, "--no-overlay")
    for said in (stdout, stderr):
        assert "--poses odometry estimates poses from the images" in said


def test_nothing_is_said_of_a_sequence_without_fault(tmp_path: Path, run_vista: Vista) -> None:
    out = tmp_path / "out"
    status, stdout, stderr = run_vista("run", make_kitti(tmp_path / "flight"), "--out", out, "--no-overlay")
    assert (status, stderr) == (0, "")
    assert stdout.splitlines()[1].endswith("the view was healthy in all 6 frames")
    assert len(stdout.splitlines()) == 3
    assert [line["health"] for line in valid_lines(out)] == [{"state": "healthy", "reasons": []}] * FRAMES
    assert {line["motion"] for line in valid_lines(out)} == {"known"}
    summary = json.loads((out / "summary.json").read_text())
    assert summary["health"] == {
        "state": "healthy",
        "frames": {"healthy": FRAMES, "degraded": 0, "blind": 0},
        "frames_with_known_motion": FRAMES,
        "problems": [],
    }
    assert summary["stages_ms"]["checks"]["median"] > 0.0


def test_a_camera_that_stands_still_needs_no_poses(tmp_path: Path, run_vista: Vista) -> None:
    folder = make_kitti(tmp_path / "flight")
    (tmp_path / "flight/poses/00.txt").unlink()
    for name in ("image_0", "image_1"):
        first = read_grey(folder / name / "000000.png")
        noise = np.random.default_rng(0)
        each_image(folder, name, lambda _: cv2.add(first, noise.integers(0, 5, first.shape, np.uint8)))  # noqa: B023
    assert run_vista("run", folder, "--out", tmp_path / "out", "--no-overlay")[2] == ""
    assert {line["motion"] for line in valid_lines(tmp_path / "out")} == {"unknown"}
    assert {line["health"]["state"] for line in valid_lines(tmp_path / "out")} == {"healthy"}


def test_a_fault_that_begins_later_is_found_at_once_and_ends_with_its_cause(
    tmp_path: Path, run_vista: Vista
) -> None:
    """Features are matched in some frames only; that fewer disparities are valid calls for it in between."""
    folder, out = make_kitti(tmp_path / "flight", 8), tmp_path / "out"
    for index in (3, 4, 5):
        image = cases.texture_pair(100 + index, WIDTH, HEIGHT)[0]
        cases.write_image(folder / f"image_1/{index:06d}.png", image)
    assert run_vista("run", folder, "--out", out, "--no-overlay")[0] == 0
    states = [line["health"]["state"] for line in valid_lines(out)]
    assert states == ["healthy"] * 3 + ["blind"] * 3 + ["healthy"] * 2


def poses(folder: Path, *places_m: float) -> None:
    lines = "".join(f"1 0 0 0 0 1 0 0 0 0 1 {place_m}\n" for place_m in places_m)
    (folder / "../../poses/00.txt").resolve().write_text(lines)


def test_what_libvista_says_is_passed_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The real pipeline sees a pose that jumps by 5 km once, and a frame whose left image is black."""
    folder, out = make_kitti(tmp_path / "flight"), tmp_path / "out"
    poses(folder, 0, 1, 5002, 3, 4, 5)
    cases.write_image(folder / "image_0/000004.png", np.zeros((HEIGHT, WIDTH), np.uint8))
    status, stdout, stderr = call(capsys, "run", folder, "--out", out, "--no-overlay")
    assert status == 0
    lines = valid_lines(out)
    reasons = [line["health"]["reasons"] for line in lines]
    assert reasons == [[], [], ["pose_jump"], [], ["no_contrast", "no_disparities"], []]
    assert [line["motion"] for line in lines] == ["known", "known", "unknown", "known", "known", "known"]
    assert [line["health"]["state"] for line in lines if line["health"]["reasons"]] == ["degraded", "blind"]
    assert len(stderr.splitlines()) == 3
    assert "the view was blind in 1 of 6 frames and degraded in 1 of 6 frames: the left image" in stdout
    assert "pose_jump" in stdout.splitlines()[-2]


def test_the_worst_finding_gives_the_state() -> None:
    bad = Finding(Reason.POSE_JUMP, State.DEGRADED, "")
    worse = Finding(Reason.NO_DISPARITIES, State.BLIND, "")
    assert FrameHealth().state == State.HEALTHY
    assert FrameHealth((bad,)).state == State.DEGRADED
    assert FrameHealth((bad, worse, bad)).state == State.BLIND


def test_matches_measure_disparity_and_row() -> None:
    left, right = cases.texture_pair(0, WIDTH, HEIGHT)
    matches = match_pair(left, np.roll(right, -2, axis=0), features=400)
    assert len(matches.disparity_px) > 50
    assert np.median(matches.disparity_px) == pytest.approx(cases.DISPARITY_PX, abs=0.05)
    assert np.median(matches.row_error_px) == pytest.approx(-2.0, abs=0.05)


@pytest.mark.parametrize("level", [0, 128, 255])
def test_an_image_without_features_has_no_matches_and_no_motion(level: int) -> None:
    flat, textured = np.full((HEIGHT, WIDTH), level, np.uint8), cases.texture_pair(0, WIDTH, HEIGHT)[0]
    for pair in ((flat, flat), (flat, textured), (textured, flat)):
        matches = match_pair(*pair, features=400)
        assert len(matches.disparity_px) == len(matches.row_error_px) == 0
        assert checks.check_pair(matches) is None
        assert checks.check_image_motion(image_motion_px(*pair)) is None


@pytest.mark.parametrize("noise_grey", [0.0, 2.0, 4.0, 8.0, 10.0])
def test_sensor_noise_neither_hides_motion_nor_makes_it(noise_grey: float) -> None:
    """Three pixels a frame, and none; the check asks for 20 features and more than one pixel."""
    random = seeded(1)
    wide, _ = cases.texture_pair(int(random.integers(1000)), WIDTH + 3, HEIGHT)

    def shown(first: int) -> NDArray[np.uint8]:
        noise = random.normal(0.0, noise_grey, (HEIGHT, WIDTH))
        return np.clip(np.rint(wide[:, first : first + WIDTH] + noise), 0, 255).astype(np.uint8)

    moved = checks.check_image_motion(image_motion_px(shown(0), shown(3)))
    assert moved is not None and moved.reason == Reason.MOTION_UNKNOWN
    assert moved.text.startswith("the image moves by 3.0 px a frame, but no poses are given")
    assert len(image_motion_px(shown(0), shown(0))) >= checks.MIN_FOLLOWED
    assert checks.check_image_motion(image_motion_px(shown(0), shown(0))) is None


@pytest.mark.parametrize("baseline_m", [0.003, 0.05, 0.54, 4.0, 120.0])
def test_plausible_baselines(baseline_m: float, tmp_path: Path, run_vista: Vista) -> None:
    folder = make_kitti(tmp_path / "flight")
    cases.edit("calib.txt", "-60.0", f"{-240 * baseline_m}")(folder)
    _, stdout, _ = run_vista("run", folder, "--out", tmp_path / "out", "--no-overlay")
    assert ("the baseline is" in stdout) == (not 0.01 <= baseline_m <= 5.0)
    assert ("millimetres" in stdout) == (baseline_m > 5.0)
