"""libvista compiled for AArch64, under qemu: the obstacles of this machine. `make test-aarch64` builds it."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from typing import Any

import pytest
import recording_cases as cases
from board_flight import board_flight
from shared_data import REPOSITORY, SHARED_DATA
from vista import native
from vista.cli import main

RUN, PROGRAM = REPOSITORY / "build/tools/aarch64/run", REPOSITORY / "build/aarch64/bin/vista-fly"
STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
TOLERANCE = 1e-9  # relative: the mathematical functions of two C libraries differ in the last digit

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PROGRAM.exists(), reason="not built for AArch64: make test-aarch64"),
]


def frames(*command: object) -> list[dict[str, Any]]:
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def assert_same(here: Any, there: Any, where: str) -> None:
    assert type(here) is type(there), where
    if isinstance(here, dict):
        assert here.keys() == there.keys(), where
        for key in here:
            assert_same(here[key], there[key], f"{where}.{key}")
    elif isinstance(here, list):
        assert len(here) == len(there), where
        for k, pair in enumerate(zip(here, there, strict=True)):
            assert_same(*pair, f"{where}[{k}]")
    elif isinstance(here, float):
        assert math.isclose(here, there, rel_tol=TOLERANCE, abs_tol=TOLERANCE), (where, here, there)
    else:
        assert here == there, where


def compare(recording: Path) -> list[dict[str, Any]]:
    options = ["--recording", recording, "--all-frames", "--watchdog", 600, "--out", "-"]
    here, there = frames(native.build_folder() / "bin/vista-fly", *options), frames(RUN, PROGRAM, *options)
    for frame in (*here, *there):
        del frame["processing_ms"]
    assert_same(here, there, "frames")
    return there


def test_a_flight(tmp_path: Path) -> None:
    recording = cases.record(tmp_path / "board.rec", board_flight()[:9])
    assert any(o["confirmed"] for o in compare(recording)[-1]["obstacles"])


@pytest.mark.skipif(not STREET.exists(), reason=f"{STREET} is absent")
def test_a_street(tmp_path: Path) -> None:
    recording = tmp_path / "street.rec"
    arguments = ["run", STREET, "--out", tmp_path / "out", "--no-overlay", "--record", recording]
    assert main([str(argument) for argument in arguments]) == 0
    found = compare(recording)
    assert len(found) == 51
    print(f"{sum(len(frame['obstacles']) for frame in found)} obstacles in {len(found)} frames are the same")
