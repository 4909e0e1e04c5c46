"""One recording through every source gives the same obstacles."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
import source_cases as cases
from bag_cases import write_bag
from command_line import call, lines_without_times
from source_cases import Recording

pytestmark = pytest.mark.slow

Written = tuple[object, ...]  # SEQUENCE and options of `vista run`


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("recording")


@pytest.fixture(scope="module")
def recording(folder: Path) -> Recording:
    return cases.record_flight(folder / "flight")


def run(capsys: pytest.CaptureFixture[str], out: Path, source: Written) -> list[str]:
    status, _, err = call(capsys, "run", *source, "--out", out, "--no-overlay")
    assert status == 0, err
    return lines_without_times(out)


@pytest.fixture(scope="module")
def expected(folder: Path, recording: Recording) -> Callable[[pytest.CaptureFixture[str]], list[str]]:
    """The lines of the EuRoC layout, computed once."""
    lines: list[str] = []

    def of_euroc(capsys: pytest.CaptureFixture[str]) -> list[str]:
        if not lines:
            lines.extend(run(capsys, folder / "out", (folder / "flight",)))
        return lines

    return of_euroc


def posed(tmp_path: Path, recording: Recording) -> Written:
    return "--poses", cases.write_trajectory(tmp_path / "poses.txt", recording)


def timed(tmp_path: Path, recording: Recording) -> Written:
    """The container of a video has no date."""
    return *posed(tmp_path, recording), "--start", cases.seconds(recording.frames[0].t_ns)


def pairs(tmp_path: Path, recording: Recording) -> Written:
    return cases.write_pairs(tmp_path / "pairs", recording), *posed(tmp_path, recording)


def kitti(tmp_path: Path, recording: Recording) -> Written:
    return (cases.write_kitti(tmp_path / "kitti", recording),)


def video(tmp_path: Path, recording: Recording, name: str, axis: int) -> Written:
    return cases.write_stacked(tmp_path / name, recording, axis), *timed(tmp_path, recording)


def video_at_rate(tmp_path: Path, recording: Recording) -> Written:
    """The container says another rate."""
    source = cases.write_stacked(tmp_path / "flight.avi", recording, axis=1, rate_hz=25.0)
    return source, *timed(tmp_path, recording), "--rate", recording.rate_hz


def two_videos(tmp_path: Path, recording: Recording) -> Written:
    return cases.write_two_videos(tmp_path, recording), *timed(tmp_path, recording)


def any_two_videos(tmp_path: Path, recording: Recording) -> Written:
    left = cases.write_two_videos(tmp_path, recording)
    right = left.with_name("flight_right.mkv").rename(tmp_path / "starboard.mkv")
    calibration = (tmp_path / "calibration.toml").rename(tmp_path / "rig.toml")
    return left, "--right", right, "--calibration", calibration, *timed(tmp_path, recording)


def bag(tmp_path: Path, recording: Recording, kind: str, poses: str, compressed: bool = False) -> Written:
    name = "flight.bag" if kind == "ros1" else "flight"
    path = write_bag(tmp_path / name, recording, kind, poses, compressed)
    return (path, "--pose-frame", "camera") if poses == "pose" else (path,)


def lone_mcap(tmp_path: Path, recording: Recording) -> Written:
    """One file without metadata.yaml, and the poses elsewhere."""
    folder = write_bag(tmp_path / "flight", recording, "mcap", "none")
    (file,) = folder.glob("*.mcap")
    calibration = tmp_path / "rig.toml"
    calibration.write_text(recording.calibration)
    return file, "--calibration", calibration, *posed(tmp_path, recording)


SOURCES: dict[str, Callable[[Path, Recording], Written]] = {
    "pairs and a TUM trajectory": pairs,
    "KITTI odometry": kitti,
    "video, side by side": partial(video, name="flight.mkv", axis=1),
    "video, top and bottom": partial(video, name="flight.avi", axis=0),
    "video, at a rate": video_at_rate,
    "two videos": two_videos,
    "two videos of any name": any_two_videos,
    "ROS 1 bag": partial(bag, kind="ros1", poses="odometry"),
    "ROS 1 bag, compressed images, poses by tf": partial(bag, kind="ros1", poses="tf", compressed=True),
    "ROS 2 bag, sqlite3": partial(bag, kind="sqlite3", poses="tf"),
    "ROS 2 bag, sqlite3, compressed images": partial(bag, kind="sqlite3", poses="odometry", compressed=True),
    "ROS 2 bag, MCAP, poses of the camera": partial(bag, kind="mcap", poses="pose"),
    "MCAP file": lone_mcap,
}


def without_up(lines: list[str]) -> list[str]:
    """The KITTI layout does not say where up is in its world; nothing else differs."""
    return [re.sub(r'"up_camera": (null|\[[^]]*\])', "", line) for line in lines]


@pytest.mark.parametrize("name", SOURCES)
def test_every_source_gives_the_same_obstacles(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    recording: Recording,
    expected: Callable[[pytest.CaptureFixture[str]], list[str]],
    name: str,
) -> None:
    lines = expected(capsys)
    assert sum('"nearest_collision": null' not in line for line in lines) >= len(lines) // 2
    of_source = run(capsys, tmp_path / "out", SOURCES[name](tmp_path, recording))
    if SOURCES[name] is kitti:
        lines, of_source = without_up(lines), without_up(of_source)
    assert of_source == lines
