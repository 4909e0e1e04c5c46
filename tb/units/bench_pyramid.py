"""All levels of frames of any size, good and bad, at any pace, against the C model; a memory beside them."""

from __future__ import annotations

import cocotb
import numpy as np
from bench_reduce import reduce
from cocotb_helpers import parameter, seeded, start
from frames import beats
from video import (
    MIN_HEIGHT,
    MIN_WIDTH,
    Driver,
    Memory,
    Segment,
    assert_frames,
    begun,
    errors_of,
    filtered,
    guarded,
    random_images,
    random_segment,
    reset,
)

MAX_WIDTH = parameter("MaxWidth")
MAX_LEVELS = 4
LEVEL_LATENCY = 16  # clocks until the last pixels of a level have passed the reducer and a prompt memory
ALONG = ("level_o", "width_o", "height_o", "side_o")
NAMES = tuple(name.removesuffix("_o") for name in ALONG)


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


async def started(dut):
    random = seeded(dut)
    await start(
        dut, s_axis_tvalid=0, m_axis_tready=0, store_axis_tready=0, fetch_axis_tvalid=0, enable_i=0,
        width_i=0, height_i=0, levels_i=0, side_i=0,
    )  # fmt: skip
    return Driver(dut, random, "levels_i", ALONG), np.random.default_rng(random.randrange(1 << 30))


def memory_for(segments):
    """As large as the largest level 1 and no larger."""
    return Memory(max((s.width + 1) // 2 * ((s.height + 1) // 2) for s in segments))


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.3])
async def frames_of_any_kind(dut, offered, taken):
    driver, rng = await started(dut)
    kinds = [*["good"] * 6, *["faulty"] * 10, "illegal", "disabled"]
    rng.shuffle(kinds)
    # Also 0 and more than four, which act as one and as four.
    segments = [random_segment(rng, str(kind), MAX_WIDTH, MAX_LEVELS + 2) for kind in kinds]
    driver.memory = memory_for(segments)
    seen = await driver.run(segments, offered, taken)
    frames = expected(segments)
    assert_frames(seen, frames, NAMES)
    starts = sum(frame.level == 0 for frame in frames)
    assert (seen.starts, seen.errors) == (starts, errors_of(segments, MAX_WIDTH))
    assert not driver.memory.beats, "a frame left something behind"


@cocotb.test()
async def reset_inside_a_frame(dut):
    driver, rng = await started(dut)
    for _ in range(12):
        before, after = (random_segment(rng, "good", MAX_WIDTH, MAX_LEVELS + 1) for _ in range(2))
        driver.memory = memory_for([before, after])
        stop = int(rng.integers(1, len(before.stream)))
        await driver.run([before], 1.0, float(rng.choice([1.0, 0.3])), stop)
        await reset(dut, driver)
        assert not dut.m_axis_tvalid.value
        seen = await driver.run([after], 0.7, 0.7)
        assert not seen.errors
        assert_frames(seen, expected([after]), NAMES)


@cocotb.test()
async def one_pixel_per_clock(dut):
    """Frames of one level follow each other without a gap; levels behind wait for the reducer."""
    driver, rng = await started(dut)
    for width, height, levels in ((4, 2, 1), (9, 5, 1), (MAX_WIDTH, 32, 4)):
        frames = [beats(*random_images(rng, height, width)) for _ in range(4)]
        segments = [Segment(width, height, frame, option=levels) for frame in frames]
        driver.memory = memory_for(segments)
        seen = await driver.run(segments, 1.0, 1.0)
        assert not seen.errors
        frames = expected(segments)
        assert_frames(seen, frames, NAMES)
        lost = len(segments) * width * height - (seen.in_clock[-1] - seen.in_clock[0] + 1)
        if levels == 1:
            assert lost == 0, "the input waited"
        else:
            pixels = sum(len(frame.pixels) for frame in frames)
            clocks = seen.out_clock[-1] - seen.out_clock[0] + 1
            assert clocks <= pixels + len(frames) * LEVEL_LATENCY, f"{pixels} pixels took {clocks} clocks"
