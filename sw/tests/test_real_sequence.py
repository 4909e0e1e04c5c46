"""The command line on a real street (KITTI odometry 00): enough cells, and the same bytes run after run."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
from shared_data import SHARED_DATA
from vista import native
from vista.cli import main

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
REPLAY = native.build_folder() / "bin" / "replay"
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

    kept = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    replays = [
        subprocess.run([REPLAY, first_recording], capture_output=True, text=True, check=True, env=kept).stdout
        for _ in range(2)
    ]
    assert replays[0] == replays[1]
    written, replayed = ([json.loads(line) for line in text.splitlines()] for text in (first, replays[0]))
    assert len(written) == len(replayed) == FRAMES
    assert any(obstacle["confirmed"] for obstacle in written[-1]["obstacles"])
    for line, frame in zip(written, replayed, strict=True):
        assert frame["cells"] >= NODES_MIN
        assert frame["regions"] == line["regions"]
        assert [(o["id"], o["confirmed"], round(o["distance_m"], 3)) for o in frame["obstacles"]] == [
            (o["id"], o["confirmed"], o["distance_m"]) for o in line["obstacles"]
        ]
