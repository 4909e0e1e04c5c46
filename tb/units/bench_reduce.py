"""Half-size frames of any size, good and bad, at any pace, against the numpy model."""

from __future__ import annotations

import cocotb
import numpy as np
from cocotb_helpers import parameter
from frames import beats
from video import (
    Frame,
    Segment,
    assert_frames,
    begun,
    check_frames_of_any_kind,
    check_reset_inside_a_frame,
    filtered,
    random_images,
    started,
)
from vista_model import reduce

MAX_WIDTH = parameter("MaxWidth")
LATENCY = 12


def expected(segments):
    return [
        filtered(Frame(s.width, s.height, frame.pixels, frame.whole), reduce, 2)
        for s, frame in begun(segments, MAX_WIDTH)
    ]


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.2])
async def frames_of_any_kind(dut, offered, taken):
    driver, rng = await started(dut)
    await check_frames_of_any_kind(driver, rng, 1, expected, offered, taken)


@cocotb.test()
async def reset_inside_a_frame(dut):
    driver, rng = await started(dut)
    await check_reset_inside_a_frame(driver, rng, 1, expected)


@cocotb.test()
async def one_pixel_per_clock(dut):
    driver, rng = await started(dut)
    for width, height in ((4, 2), (7, 5), (8, 6), (MAX_WIDTH, 4)):
        segments = [Segment(width, height, beats(*random_images(rng, height, width))) for _ in range(6)]
        seen = await driver.run(segments, 1.0, 1.0)
        assert not seen.errors
        assert_frames(seen, expected(segments))
        assert set(np.diff(seen.in_clock)) == {1}, "the input waited"
        if height > 2:  # pixel (0, 0) needs (2, 2), and waits for the one that follows it, which needs (4, 2)
            behind = seen.out_clock[0] - seen.in_clock[2 * width + min(4, width - 1)]
            assert behind == LATENCY, behind
