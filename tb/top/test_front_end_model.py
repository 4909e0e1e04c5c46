"""The front end of the SystemC model beside the Verilated one: clocks of frames of any size, all levels."""

from __future__ import annotations

import json
import os
import subprocess

import numpy as np
import pytest
from frames import random_parameters
from raw_frames import RawFrame, written
from registers import CONTROL, ENABLE
from tools import ROOT
from verilated import FRONT_END, Rtl

pytestmark = pytest.mark.slow

PROGRAM = ROOT / "build" / "bin" / "vista_system"
CLOCK_HZ = 60e6
SEEDS = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(3)


def model_clocks(width: int, height: int, levels: int) -> int:
    """Clocks from the first pixel that is asked for to the last word, with memory that is never late."""
    settings = {
        "width_px": width, "height_px": height, "disparities": FRONT_END.num_disparities,
        "block_px": FRONT_END.block_size, "max_width_px": FRONT_END.max_width,
        "rectify_rows": FRONT_END.rows, "levels": levels, "engine_clock_hz": CLOCK_HZ,
        "memory_bandwidth_bytes_s": 1e12, "memory_latency_ns": 0, "camera_rate_hz": 0,
        "camera_pixel_clock_hz": 1e6, "compute_words": "off", "frames": 1,
    }  # fmt: skip
    text = "\n".join(f"{key} = {value}" for key, value in settings.items())
    done = subprocess.run([PROGRAM, "-", "-"], input=text, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (frame,) = json.loads(done.stdout)["frames"]
    return frame["engine_last_word_clock"] - round(frame["fetch_start_ns"] * CLOCK_HZ / 1e9)


EXACT_PX = 20  # width from which each clock is that of the RTL
FEW_CLOCKS = 10


@pytest.mark.parametrize("seed", SEEDS)
def test_a_frame_takes_the_clocks_of_the_rtl(seed: int) -> None:
    """Narrower frames, whose rows wait for the rectification, take those but for a few."""
    rng = np.random.default_rng(seed)
    with Rtl(FRONT_END, seed=1) as rtl:
        rtl.write(CONTROL, ENABLE)
        for _ in range(12):
            narrow = rng.random() < 0.5
            width = int(
                rng.integers(4, EXACT_PX) if narrow else rng.integers(EXACT_PX, FRONT_END.max_width + 1)
            )
            height = int(rng.integers(2, 90))
            images = rng.integers(0, 256, (2, height, width), dtype=np.uint8)
            frame = RawFrame(
                *images,
                random_parameters(rng, FRONT_END.num_disparities, FRONT_END.block_size),
                smooth=bool(rng.integers(2)),
                levels=int(rng.integers(1, 5)),
            )
            written(rtl, frame.writes())
            count = sum(level.left.size for level in frame.matched())
            got = rtl.stream(frame.stream, count)
            clocks = int(got.out_clock[-1] - got.in_clock[0])
            off = abs(model_clocks(width, height, frame.levels) - clocks)
            assert off <= (FEW_CLOCKS if narrow else 0), (width, height, frame.levels, clocks)
