"""vista-fly for other processors, emulated, finds what it finds on this one (make fly-package ARCH=...)."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from flight_on_disk import write_flight
from fly_process import environment, fly, prepare, timeless
from shared_data import REPOSITORY

pytestmark = [pytest.mark.native, pytest.mark.slow]


@pytest.mark.parametrize("processor", ["aarch64", "armhf", "riscv64"])
def test_the_same_lines(tmp_path: Path, processor: str) -> None:
    program = REPOSITORY / "build" / f"fly-{processor}" / "bin" / "vista-fly"
    emulator = REPOSITORY / "build" / "tools" / processor / "run"
    if not (program.is_file() and emulator.is_file()):
        pytest.skip(f"make fly-package ARCH={processor} was not run")
    played = [
        *prepare(tmp_path, write_flight(tmp_path / "flight", frames=6)),
        "--all-frames",
        "--watchdog",
        600,
    ]
    assert fly(*played, "--out", tmp_path / "here.jsonl").returncode == 0
    command = [emulator, program, *played, "--out", tmp_path / "there.jsonl"]
    run = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, timeout=600, env=environment()
    )
    assert run.returncode == 0, run.stderr
    assert timeless(tmp_path / "there.jsonl") == timeless(tmp_path / "here.jsonl")
