"""One pixel a clock, rows and frames without a gap, and what the latency is."""

from __future__ import annotations

import numpy as np
import pytest
from frames import Frame, beats, expected_words, random_parameters, set_up
from registers import CONTROL, FRAMES_IN, FRAMES_OUT, STALLS_IN, STALLS_OUT
from verilated import Config, Pace, Rtl

pytestmark = pytest.mark.slow

CONFIGS = [Config(16, 5), Config(16, 21, 256, confidence=True), Config(32, 11), Config(64, 11)]
FRAMES = 5
PIPELINE = {16: 55, 32: 63, 64: 95}  # clocks, as in doc/rtl.md


def name(config: Config) -> str:
    return config.name


@pytest.mark.parametrize("config", CONFIGS, ids=name)
@pytest.mark.parametrize("odd", [0, 1])
def test_frames_back_to_back_take_one_clock_a_pixel(config: Config, odd: int) -> None:
    width, height = config.num_disparities + 2 * config.block_size + 17, 2 * config.block_size + odd
    rng = np.random.default_rng(odd)
    frames = [
        Frame(
            *rng.integers(0, 256, (2, height, width), np.uint8),
            random_parameters(rng, config.num_disparities, config.block_size),
        )
        for _ in range(FRAMES)
    ]
    frames = [Frame(f.left, f.right, frames[0].parameters, confidence=config.confidence) for f in frames]
    pixels = FRAMES * width * height
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        set_up(rtl, frames[0])
        got = rtl.stream(np.concatenate([beats(f.left, f.right) for f in frames]), pixels)
        counters = [rtl.read(a) for a in (FRAMES_IN, FRAMES_OUT, STALLS_IN, STALLS_OUT)]
    assert (got.words == np.concatenate([expected_words(f) for f in frames])).all()
    assert counters == [FRAMES, FRAMES, 0, 0]

    # Not one pixel had to wait, the last frame came out without a further one, and behind the first matched
    # pixel the words come one a clock to the very end.
    assert (np.diff(got.in_clock) == 1).all()
    radius = config.block_size // 2
    first_matched = radius * width + config.num_disparities - 1 + radius
    assert (np.diff(got.out_clock[first_matched:]) == 1).all()

    # The disparity of a pixel leaves r + 1 rows and r columns after it came, and a fixed number of clocks.
    latency = got.out_clock[first_matched:] - got.in_clock[first_matched:]
    pipeline = int(latency[0]) - (radius + 1) * width - radius
    assert (latency == latency[0]).all()
    assert int(got.out_clock[-1] - got.in_clock[0]) + 1 == pixels + (radius + 1) * width + radius + pipeline
    assert pipeline == PIPELINE[config.num_disparities]
    assert got.out_clock[0] - got.in_clock[0] <= (radius + 1) * width + radius + pipeline


def test_a_stall_delays_words_but_loses_no_pace() -> None:
    """Words wait, beyond the clocks in which the reader pauses, no longer than they do without pauses."""
    config = Config(16, 5)
    rng = np.random.default_rng(5)
    frame = Frame(*rng.integers(0, 256, (2, 40, 200), np.uint8), random_parameters(rng, 16, 5))
    waits = []
    for pace_out in (Pace(), Pace(1, 2)):
        with Rtl(config) as rtl:
            rtl.write(CONTROL, 1)
            set_up(rtl, frame)
            got = rtl.stream(beats(frame.left, frame.right), 8000, Pace(), pace_out, seed=11)
            stalls = rtl.read(STALLS_IN), rtl.read(STALLS_OUT)
        assert (got.words == expected_words(frame)).all()
        waits.append(int(got.out_clock[-1] - got.out_clock[0]) - (len(got.words) - 1) - stalls[1])
    assert stalls[0] > 0 and stalls[1] > 0
    assert waits[1] <= waits[0]
