"""Runs vista_system on a configuration and reads what it wrote."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

from vista import native

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = native.build_folder() / "bin" / "vista_system"

# Small and quick to run: 4096 pixels, read out in 0.7 ms, matched in 0.41 ms.
SMALL: dict[str, Any] = {
    "width_px": 128, "height_px": 32, "disparities": 16, "block_px": 5, "engine_clock_hz": 10e6,
    "camera_pixel_clock_hz": 10e6, "camera_rate_hz": 1000, "camera_horizontal_blanking_px": 72,
    "camera_vertical_blanking_lines": 8, "memory_bandwidth_bytes_s": 400e6, "frames": 20,
}  # fmt: skip


def run(text: str) -> subprocess.CompletedProcess[str]:
    if not PROGRAM.is_file():
        raise FileNotFoundError(f"{PROGRAM} is missing: run `make systemc`")
    return subprocess.run([PROGRAM, "-", "-"], input=text, capture_output=True, text=True)


def simulate(**keys: Any) -> dict[str, Any]:
    """The output of SMALL with other keys; `host_stage` is a dictionary of lists."""
    settings = SMALL | keys
    stages = settings.pop("host_stage", {})
    lines = [f"{key} = {value}" for key, value in settings.items()]
    lines += [f"host_stage.{name}_ms = {', '.join(map(str, ms))}" for name, ms in stages.items()]
    done = run("\n".join(lines))
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def delivered(output: dict[str, Any]) -> list[dict[str, Any]]:
    return [frame for frame in output["frames"] if frame["dropped"] is None]
