"""Pyramid, smoothing and core in a row: the words of every level against the C model, frame upon frame."""

from __future__ import annotations

import cocotb
import numpy as np
from bench_pyramid import levels_of
from bench_smooth import smooth
from cocotb_helpers import parameter
from faults import Received, expected_after
from frames import IMAGE_KINDS, PARAMS_BITS, params_bits, random_pair, random_parameters
from video import begun, filtered, random_segment, started
from vista_model.engine import Parameters

D, B, MAX_WIDTH = (parameter(name) for name in ("NumDisparities", "BlockSize", "MaxWidth"))


def side_bits(smoothed: bool, p: Parameters) -> int:
    """What goes along with a frame: the switch of the smoothing above the packed struct params_t."""
    return int(smoothed) << PARAMS_BITS | params_bits(p)


def expected_words(segment, received, smoothed, parameters):
    """Words of all levels of a frame; a cut one is cut in each level where its smoothed pixels end."""
    words = []
    for level in levels_of(segment, received):
        frame = filtered(level, smooth if smoothed else (lambda image: image), 1)
        pixels = Received([max(pixel, 0) for pixel in frame.pixels], frame.whole)
        words.append(expected_after(pixels, frame.width, frame.height, parameters))
    return words


def random_images(rng, height, width):
    return random_pair(rng, str(rng.choice(IMAGE_KINDS)), height, width)


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.5], taken=[1.0, 0.5])
async def words_of_every_level(dut, offered, taken):
    driver, rng = await started(dut, "levels_i")
    segments, settings = [], {}
    for _ in range(14):
        kind = str(rng.choice(["good", "faulty"], p=[0.6, 0.4]))
        segment = random_segment(rng, kind, MAX_WIDTH, 5, random_images)
        smoothed, parameters = bool(rng.integers(2)), random_parameters(rng, D, B)
        segment.side = side_bits(smoothed, parameters)
        segments.append(segment)
        settings[id(segment)] = smoothed, parameters
    seen = await driver.run(segments, offered, taken)
    expected = [
        words
        for s, frame in begun(segments, MAX_WIDTH)
        for words in expected_words(s, frame, *settings[id(s)])
    ]
    got = np.array([beat[0] for beat in seen.beats], np.uint32)
    assert len(got) == sum(map(len, expected))
    for i, (words, part) in enumerate(
        zip(expected, np.split(got, np.cumsum([len(w) for w in expected])[:-1]), strict=True)
    ):
        differing = np.flatnonzero(words != part)
        assert not len(differing), f"level image {i}: {len(differing)} of {len(words)} words differ"
    assert (got >> 16 != 0xFFFF).any(), "nothing was matched"
