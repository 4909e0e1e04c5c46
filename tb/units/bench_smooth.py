"""Smoothed and plain frames of any size, good and bad, at any pace, against the C model."""

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
from vista_model.c_engine import prepare_smooth

MAX_WIDTH = parameter("MaxWidth")
ALONG, NAMES = ("width_o", "height_o", "side_o"), ("width", "height", "side")
LATENCY = 9


def smooth(image):
    out = np.empty_like(image)
    prepare_smooth(np.ascontiguousarray(image), out)()
    return out


def expected(segments):
    """With smoothing off a frame passes as it is, but is cut where smoothed pixels would end."""
    return [
        filtered(
            Frame(s.width, s.height, frame.pixels, frame.whole, side=s.side),
            smooth if s.option else (lambda image: image),
            1,
        )
        for s, frame in begun(segments, MAX_WIDTH)
    ]


async def started(dut):
    random = seeded(dut)
    await start(
        dut, s_axis_tvalid=0, m_axis_tready=0, enable_i=0, width_i=0, height_i=0, smooth_i=0, side_i=0
    )
    return Driver(dut, random, "smooth_i", ALONG), np.random.default_rng(random.randrange(1 << 30))


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.4])
async def frames_of_any_kind(dut, offered, taken):
    driver, rng = await started(dut)
    kinds = [*["good"] * 6, *["faulty"] * 10, "illegal", "disabled"]
    rng.shuffle(kinds)
    segments = [random_segment(rng, str(kind), MAX_WIDTH, 2) for kind in kinds]
    seen = await driver.run(segments, offered, taken)
    frames = expected(segments)
    assert_frames(seen, frames, NAMES)
    assert (seen.starts, seen.errors) == (len(frames), errors_of(segments, MAX_WIDTH))


@cocotb.test()
async def reset_inside_a_frame(dut):
    driver, rng = await started(dut)
    for _ in range(12):
        before, after = (random_segment(rng, "good", MAX_WIDTH, 2) for _ in range(2))
        stop = int(rng.integers(1, len(before.stream)))
        await driver.run([before], 1.0, float(rng.choice([1.0, 0.3])), stop)
        await reset(dut, driver)
        assert not dut.m_axis_tvalid.value
        # What is left of the frame comes too, and is dropped.
        rest = before.stream[stop : stop + stop % before.width]
        rest = rest[: int(np.argmax(rest >> 16 & 1))] if (rest >> 16 & 1).any() else rest
        after.stream = np.concatenate([rest, after.stream])
        seen = await driver.run([after], 0.7, 0.7)
        assert not seen.errors
        assert_frames(seen, expected([after]), NAMES)


@cocotb.test()
async def one_pixel_per_clock(dut):
    driver, rng = await started(dut)
    for width, height in ((4, 2), (7, 5), (MAX_WIDTH, 4)):
        frames = [beats(*random_images(rng, height, width)) for _ in range(6)]
        segments = [Segment(width, height, frame, option=i % 2, side=i) for i, frame in enumerate(frames)]
        seen = await driver.run(segments, 1.0, 1.0)
        assert not seen.errors
        assert_frames(seen, expected(segments), NAMES)
        assert set(np.diff(seen.in_clock)) == {1}, "the input waited"
        latency = np.subtract(seen.out_clock, seen.in_clock)
        # A pixel leaves behind the one two columns and a row further on; those of the last row run on.
        assert latency.max() <= width + 2 + LATENCY and latency[0] == width + 2 + LATENCY, latency
