"""Half-size frames of any size, good and bad, at any pace, against the C model."""

from __future__ import annotations

import cocotb
import numpy as np
from cocotb_helpers import parameter, seeded, start
from frames import beats
from video import (
    Driver,
    Frame,
    Segment,
    assert_frames,
    begun,
    errors_of,
    filtered,
    random_images,
    random_segment,
    reset,
)
from vista_model.c_engine import prepare_reduce, reduced_shape

MAX_WIDTH = parameter("MaxWidth")
LATENCY = 12


def reduce(image):
    out = np.empty(reduced_shape(image.shape), np.uint8)
    prepare_reduce(np.ascontiguousarray(image), out)()
    return out


def expected(segments):
    return [
        filtered(Frame(s.width, s.height, frame.pixels, frame.whole), reduce, 2)
        for s, frame in begun(segments, MAX_WIDTH)
    ]


async def started(dut):
    random = seeded(dut)
    await start(dut, s_axis_tvalid=0, m_axis_tready=0, enable_i=0, width_i=0, height_i=0)
    return Driver(dut, random, "", ()), np.random.default_rng(random.randrange(1 << 30))


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.2])
async def frames_of_any_kind(dut, offered, taken):
    driver, rng = await started(dut)
    kinds = [*["good"] * 6, *["faulty"] * 10, "illegal", "disabled"]
    rng.shuffle(kinds)
    segments = [random_segment(rng, str(kind), MAX_WIDTH, 1) for kind in kinds]
    seen = await driver.run(segments, offered, taken)
    frames = expected(segments)
    assert_frames(seen, frames, ())
    assert (seen.starts, seen.errors) == (len(frames), errors_of(segments, MAX_WIDTH))


@cocotb.test()
async def reset_inside_a_frame(dut):
    driver, rng = await started(dut)
    for _ in range(12):
        before, after = (random_segment(rng, "good", MAX_WIDTH, 1) for _ in range(2))
        stop = int(rng.integers(1, len(before.stream)))
        await driver.run([before], 1.0, float(rng.choice([1.0, 0.3])), stop)
        await reset(dut, driver)
        assert not dut.m_axis_tvalid.value
        seen = await driver.run([after], 0.7, 0.7)
        assert not seen.errors
        assert_frames(seen, expected([after]), ())


@cocotb.test()
async def one_pixel_per_clock(dut):
    driver, rng = await started(dut)
    for width, height in ((4, 2), (7, 5), (8, 6), (MAX_WIDTH, 4)):
        segments = [Segment(width, height, beats(*random_images(rng, height, width))) for _ in range(6)]
        seen = await driver.run(segments, 1.0, 1.0)
        assert not seen.errors
        assert_frames(seen, expected(segments), ())
        assert set(np.diff(seen.in_clock)) == {1}, "the input waited"
        if height > 2:  # pixel (0, 0) needs (2, 2), and waits for the one that follows it, which needs (4, 2)
            behind = seen.out_clock[0] - seen.in_clock[2 * width + min(4, width - 1)]
            assert behind == LATENCY, behind
