"""A bad configuration gives one line that names the key, exit status 2, and no file."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from simulation import PROGRAM, run

pytestmark = pytest.mark.native

BAD = [
    ("engine_clock_hz", "engine_clock_hz = 0"),
    ("engine_clock_hz", "engine_clock_hz = nan"),
    ("engine_clock_hz", "engine_clock_hz = 1e9999"),
    ("engine_clock_hz", "engine_clock_hz = fast"),
    ("engine_clock_hz", "engine_clock_hz ="),
    ("width_px", "width_px = 0"),
    ("height_px", "height_px = -3"),
    ("height_px", "height_px = 4.5"),
    ("width_px", "width_px = 1025"),
    ("disparities", "disparities = 33"),
    ("block_px", "block_px = 6"),
    ("max_width_px", "max_width_px = 40\nwidth_px = 30"),
    ("lanes", "lanes = 0"),
    ("memory_bandwidth_bytes_s", "memory_bandwidth_bytes_s = 0"),
    ("memory_bandwidth_bytes_s", "memory_bandwidth_bytes_s = inf"),
    ("memory_arbitration", "memory_arbitration = fair"),
    ("memory_clock_hz", "memory_clock_hz = 1e8"),
    ("memory_clock_hz", "link_bytes_s = 1e8"),
    ("memory_clock_hz", "memory_clock_hz = 1e4\nlink_bytes_s = 1e8"),
    ("burst_bytes", "burst_bytes = 48"),
    ("dma_fifo_bytes", "dma_fifo_bytes = 256"),
    ("camera_rate_hz", "camera_rate_hz = 65"),
    ("camera_pixel_clock_hz", "camera_pixel_clock_hz = 0"),
    ("buffers", "buffers = 4"),
    ("host_stage.cut_ms", "host_stage.cut_ms = 1, -2"),
    ("host_stage.cut_ms", "host_stage.cut_ms = 1, nan"),
    ("host_stage.cut_ms", "host_stage.cut_ms ="),
    ("result_bytes_px", "result_bytes_px = 3"),
    ("frames", "frames = 0"),
    ("seed", "seed = 9223372036854775808"),
    ("seed", "seed = 12 monkeys"),
    ("frames", "frames = 3\nframes = 4"),
    ("clock", "clock = 3"),
    ("line 2", "frames = 2\nengine_clock_hz 3"),
    ("left_images", "left_images = /nowhere\nright_images = /nowhere"),
    ("right_images", "left_images = /nowhere"),
    ("words_out", "words_out = /nowhere/words"),
    ("rectify_rows", "rectify_rows = 48\ncompute_words = off"),
    ("levels", "levels = 2"),
    ("levels", "levels = 5"),
    ("compute_words", "rectify_rows = 16"),
    ("link_bytes_s", "link_bytes_s = 10"),
    ("lanes", "lanes = 2\nlink_bytes_s = 1e8\nmemory_clock_hz = 1e8"),
    ("rectify_ms", "rectify_ms = 1\nlink_bytes_s = 1e8\nmemory_clock_hz = 1e8"),
]


@pytest.mark.parametrize(("key", "text"), BAD, ids=lambda v: v.replace("\n", "; "))
def test_bad_key_is_named(key: str, text: str) -> None:
    done = run(text)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.startswith(f"vista_system: {key}") and done.stderr.count("\n") == 1


def test_images_that_are_not_whole_are_refused(tmp_path: Path) -> None:
    (tmp_path / "left").write_bytes(b"x" * 1000)
    done = run(f"left_images = {tmp_path}/left\nright_images = {tmp_path}/left")
    assert done.returncode == 2 and "left_images" in done.stderr and "1000 bytes" in done.stderr


def run_files(config: Path, out: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, config, out], capture_output=True, text=True)


def test_nothing_is_left_behind(tmp_path: Path) -> None:
    text = f"left_images = /nowhere\nright_images = /nowhere\nwords_out = {tmp_path}/words"
    (tmp_path / "config").write_text(text)
    done = run_files(tmp_path / "config", tmp_path / "out.json")
    assert done.returncode == 2 and [f.name for f in tmp_path.iterdir()] == ["config"]
    done = run_files(tmp_path / "missing", tmp_path / "out.json")
    assert done.returncode == 2 and "missing: cannot be read" in done.stderr
