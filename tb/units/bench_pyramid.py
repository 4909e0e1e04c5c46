"""All levels of frames of any size, good and bad, at any pace, against the numpy model; with a memory."""

from __future__ import annotations

import cocotb
from cocotb_helpers import parameter
from frames import beats
from video import (
    MIN_HEIGHT,
    MIN_WIDTH,
    Segment,
    assert_frames,
    begun,
    check_frames_of_any_kind,
    check_reset_inside_a_frame,
    filtered,
    guarded,
    random_images,
    started,
)
from vista_model import reduce

MAX_WIDTH = parameter("MaxWidth")
MAX_LEVELS = 4
LATENCY = 3  # of level 0, in clocks; the last of them waits for the next pixel
LEVEL_LATENCY = 16  # clocks until the last pixels of a level have passed the reducer and a prompt memory
ALONG = ("level_o", "width_o", "height_o", "side_o")


def levels_of(segment, received):
    frames = [guarded(segment, received)]
    while len(frames) < min(max(segment.option, 1), MAX_LEVELS):
        following = filtered(frames[-1], reduce, 2, len(frames))
        if following.width < MIN_WIDTH or following.height < MIN_HEIGHT:
            break
        frames.append(following)
    return frames


def expected(segments):
    return [level for s, frame in begun(segments, MAX_WIDTH) for level in levels_of(s, frame)]


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.3])
async def frames_of_any_kind(dut, offered, taken):
    driver, rng = await started(dut, "levels_i", ALONG)
    # Also 0 and more than four levels, which act as one and as four.
    await check_frames_of_any_kind(driver, rng, MAX_LEVELS + 2, expected, offered, taken)


@cocotb.test()
async def reset_inside_a_frame(dut):
    driver, rng = await started(dut, "levels_i", ALONG)
    await check_reset_inside_a_frame(driver, rng, MAX_LEVELS + 1, expected)


@cocotb.test()
async def one_pixel_per_clock(dut):
    """Frames of one level follow each other without a gap; levels behind wait for the reducer."""
    driver, rng = await started(dut, "levels_i", ALONG)
    for width, height, levels in ((4, 2, 1), (9, 5, 1), (MAX_WIDTH, 32, 4)):
        frames = [beats(*random_images(rng, height, width)) for _ in range(4)]
        segments = [Segment(width, height, frame, option=levels) for frame in frames]
        seen = await driver.run(segments, 1.0, 1.0)
        assert not seen.errors
        frames = expected(segments)
        assert_frames(seen, frames)
        lost = len(segments) * width * height - (seen.in_clock[-1] - seen.in_clock[0] + 1)
        if levels == 1:
            assert lost == 0, "the input waited"
            assert seen.out_clock[0] - seen.in_clock[0] == LATENCY
        else:
            pixels = sum(len(frame.pixels) for frame in frames)
            clocks = seen.out_clock[-1] - seen.out_clock[0] + 1
            assert clocks <= pixels + len(frames) * LEVEL_LATENCY, f"{pixels} pixels took {clocks} clocks"
