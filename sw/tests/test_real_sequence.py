"""The command line on a real street (KITTI odometry 00): enough cells, and the same bytes run after run."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from fly_process import fly, timeless
from shared_data import SHARED_DATA
from vista.cli import main

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
FRAMES = 12
NODES_MIN = 5000  # what the host has to segment at 60 Hz

pytestmark = [
    pytest.mark.native,
    pytest.mark.slow,
    pytest.mark.skipif(not STREET.is_dir(), reason="KITTI odometry 00 is not there"),
]


def run_street(folder: Path) -> tuple[str, Path]:
    """obstacles.jsonl without its times, and the recording."""
    recording = folder / "street.rec"
    options = ["--no-overlay", "--all-tracks", "--frames", f"0:{FRAMES}", "--record", str(recording)]
    assert main(["run", str(STREET), "--out", str(folder / "out"), *options]) == 0
    text = (folder / "out" / "obstacles.jsonl").read_text()
    timeless, count = re.subn(r'"processing_ms": [0-9.]+, ', "", text)
    assert count == FRAMES
    return timeless, recording


def test_the_street_run_twice(tmp_path: Path) -> None:
    runs = []
    for name in "ab":
        (tmp_path / name).mkdir()
        runs.append(run_street(tmp_path / name))
    (first, first_recording), (second, second_recording) = runs
    assert first == second
    assert first_recording.read_bytes() == second_recording.read_bytes()

    replays = []
    for name in "ab":
        run = fly("--recording", first_recording, "--all-frames", "--out", tmp_path / f"{name}.jsonl")
        assert run.returncode == 0, run.stderr
        replays.append(timeless(tmp_path / f"{name}.jsonl"))
    assert replays[0] == replays[1]
    written, replayed = ([json.loads(line) for line in lines] for lines in (first.splitlines(), replays[0]))
    assert len(written) == len(replayed) == FRAMES
    assert any(obstacle["confirmed"] for obstacle in written[-1]["obstacles"])
    for line, frame in zip(written, replayed, strict=True):
        confirmed = [o for o in line["obstacles"] if o["confirmed"]]
        assert frame == line | {"obstacles": confirmed}
