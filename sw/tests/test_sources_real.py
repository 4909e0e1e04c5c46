"""Real recordings through several sources give the same obstacles: 15 frames of a street, EuRoC's V1_01.

Videos have times in milliseconds, so the frames are given even times first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import source_cases as cases
from bag_cases import write_bag
from command_line import Vista, lines_without_times
from shared_data import SHARED_DATA
from source_cases import Recording
from vista.sequence import Sequence, open_sequence

START_NS, PERIOD_NS = 1_600_000_000_000_000_000, 50_000_000
RECORDINGS = {"street": "kitti_odometry/sequences/00", "EuRoC": "euroc_v101"}


def record(sequence: Sequence, frames: int = 15) -> Recording:
    taken = [sequence.read(files) for files in sequence.frames[:frames]]
    timed = [replace(frame, t_ns=START_NS + index * PERIOD_NS) for index, frame in enumerate(taken)]
    up = "" if sequence.up_world is None else f"up_world = {sequence.up_world.tolist()}\n"
    return Recording(timed, sequence.calibration, up)


WRITERS: dict[str, Callable[[Path, Recording], Path]] = {
    "video": lambda tmp_path, recording: cases.write_stacked(tmp_path / "flight.mkv", recording, 1),
    "two videos": cases.write_two_videos,
    "ROS 1": lambda tmp_path, recording: write_bag(tmp_path / "flight.bag", recording, "ros1", "none"),
    "MCAP": lambda tmp_path, recording: write_bag(tmp_path / "flight", recording, "mcap", "none", True),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", RECORDINGS)
def test_real_recordings(tmp_path: Path, run_vista: Vista, name: str) -> None:
    folder = SHARED_DATA / RECORDINGS[name]
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there")
    recording = record(open_sequence(folder))
    poses = cases.write_trajectory(tmp_path / "poses.txt", recording)

    def run(source: Path, *options: object) -> list[str]:
        out = tmp_path / "out" / source.parent.name
        status, _, err = run_vista("run", source, "--out", out, "--no-overlay", "--poses", poses, *options)
        assert status == 0, err
        return lines_without_times(out)

    expected = run(cases.write_pairs(tmp_path / "pairs" / "flight", recording))
    assert len(expected) == len(recording.frames)
    for kind, write in WRITERS.items():
        path = write(tmp_path / kind, recording)
        rig = tmp_path / "rig.toml"
        rig.write_text(recording.calibration)
        timed = ("--start", cases.seconds(START_NS)) if "video" in kind else ()
        assert run(path, "--calibration", rig, *timed) == expected, kind
