"""Smoothed and plain frames of any size, good and bad, at any pace, against the numpy model."""

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
from vista_model import smooth

MAX_WIDTH = parameter("MaxWidth")
ALONG = ("width_o", "height_o", "side_o")
LATENCY = 9


def expected(segments):
    """Frames that are expected. One with smoothing off passes as it is, but is cut where smoothed pixels
    would end."""
    return [
        filtered(
            Frame(s.width, s.height, frame.pixels, frame.whole, side=s.side),
            smooth if s.option else (lambda image: image),
            1,
        )
        for s, frame in begun(segments, MAX_WIDTH)
    ]


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.4])
async def frames_of_any_kind(dut, offered, taken):
    driver, rng = await started(dut, "smooth_i", ALONG)
    await check_frames_of_any_kind(driver, rng, 2, expected, offered, taken)


@cocotb.test()
async def reset_inside_a_frame(dut):
    driver, rng = await started(dut, "smooth_i", ALONG)
    await check_reset_inside_a_frame(driver, rng, 2, expected)


@cocotb.test()
async def one_pixel_per_clock(dut):
    driver, rng = await started(dut, "smooth_i", ALONG)
    for width, height in ((4, 2), (7, 5), (MAX_WIDTH, 4)):
        frames = [beats(*random_images(rng, height, width)) for _ in range(6)]
        segments = [Segment(width, height, frame, option=i % 2, side=i) for i, frame in enumerate(frames)]
        seen = await driver.run(segments, 1.0, 1.0)
        assert not seen.errors
        assert_frames(seen, expected(segments))
        assert set(np.diff(seen.in_clock)) == {1}, "the input waited"
        latency = np.subtract(seen.out_clock, seen.in_clock)
        # A pixel leaves behind the one two columns and a row further on; those of the last row run on.
        assert latency.max() <= width + 2 + LATENCY and latency[0] == width + 2 + LATENCY, latency
