"""Front end and core in a row: the words of every level against the models; maps change between frames."""

from __future__ import annotations

from dataclasses import replace

import cocotb
import numpy as np
from bench_pyramid import levels_of
from bench_rectify import (
    IDLE,
    LARGEST,
    WATCHED,
    Loader,
    random_segments,
    run,
    sent,
)
from cocotb_helpers import parameter
from faults import Received, expected_after
from frames import IMAGE_KINDS, params_bits, random_pair, random_parameters
from video import begun, errors_of, filtered, hit, reset, started
from vista_model import smooth

D, B, MAX_WIDTH = (parameter(name) for name in ("NumDisparities", "BlockSize", "MaxWidth"))
NARROWEST = D + B - 1  # of a frame that has matched pixels
RECTIFY, SMOOTH = 1 << 4, 1  # of front_end_i; the levels lie between


def received(frame):
    """A frame that leaves a block, as the next one takes it."""
    return Received([max(pixel, 0) for pixel in frame.pixels], frame.whole)


def expected_words(segment, frame, parameters):
    """Words of all levels of a frame; one that is cut is cut in each block where what came ends."""
    option = segment.option
    straight = sent(replace(segment, option=option & RECTIFY), frame)
    words = []
    for level in levels_of(replace(segment, option=option >> 1 & 7), received(straight)):
        hit([f"level {level.level} {'whole' if level.whole else 'cut'}"])
        pixels = filtered(level, smooth if option & SMOOTH else (lambda image: image), 1)
        words.append(expected_after(received(pixels), pixels.width, pixels.height, parameters))
    return words


def random_video(rng, kinds):
    """Segments with maps, as for the rectification alone, and switches and parameters of their own."""
    segments = random_segments(
        rng,
        kinds,
        lambda r, h, w: random_pair(r, str(r.choice(IMAGE_KINDS)), h, w),
        (4, NARROWEST - 1, NARROWEST, 2 * NARROWEST),
    )
    settings = {}
    for segment in segments:
        parameters = random_parameters(rng, D, B)
        rectified, levels, smoothed = segment.option, int(rng.integers(5)), int(rng.integers(2))
        segment.option = rectified * RECTIFY | levels << 1 | smoothed
        segment.setting = f"rectify{rectified} pyramid{int(levels > 1)} smooth{smoothed}"
        segment.side = params_bits(parameters)
        settings[id(segment)] = parameters
    return segments, settings


def assert_words(seen, expected):
    got = np.array([beat[0] for beat in seen.beats], np.uint32)
    assert len(got) == sum(map(len, expected))
    parts = np.split(got, np.cumsum([len(words) for words in expected])[:-1])
    for i, (words, part) in enumerate(zip(expected, parts, strict=True)):
        differing = np.flatnonzero(words != part)
        assert not len(differing), f"level image {i}: {len(differing)} of {len(words)} words differ"


def words_of(segments, settings):
    """What leaves of the video; settings belong to the segments of the same place."""
    return [
        words
        for segment, frame in begun(segments, MAX_WIDTH)
        for words in expected_words(segment, frame, settings[id(segment)])
    ]


async def started_front_end(dut):
    driver, rng = await started(dut, "front_end_i", (), IDLE)
    driver.wakes += WATCHED
    # A frame that was cut at once is filled in every block in turn, and nothing leaves.
    driver.patience = 4 * MAX_WIDTH * (LARGEST + 20)
    return driver, rng


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.5], taken=[1.0, 0.5])
async def words_of_every_level(dut, offered, taken):
    """Sound and faulty video of changing size, with switches, levels, parameters and maps of its own each."""
    driver, rng = await started_front_end(dut)
    # The same seed begins all four; each has a video of its own.
    rng = np.random.default_rng([rng.integers(1 << 30), round(10 * offered), round(10 * taken)])
    kinds = [*["good"] * 9, *["faulty"] * 5, "unfit", "disabled", "illegal"]
    expected = []
    while not any((words >> 16 != 0xFFFF).any() for words in expected):  # frames may all be too low to match
        rng.shuffle(kinds)
        segments, settings = random_video(rng, kinds)
        expected = words_of(segments, settings)
    seen, loader = await run(driver, segments, offered, taken, float(rng.choice([1.0, 0.7])))
    assert_words(seen, expected)
    starts = len(list(begun(segments, MAX_WIDTH)))
    assert (seen.starts, seen.errors) == (starts, errors_of(segments, MAX_WIDTH))
    unfit = [s for s in segments if not s.fits and s.enable]
    assert loader.unfit == sum(int((s.stream >> 16 & 1).sum()) for s in unfit)
    hit(["map unfit"] * bool(loader.unfit))


@cocotb.test()
async def soft_reset_keeps_the_map(dut):
    """Anywhere in a frame, with levels in the buffer; the map in force counts for the next frame."""
    driver, rng = await started_front_end(dut)
    for _ in range(4):
        segments, settings = random_video(rng, ["good"])
        (segment,) = segments
        stop = int(rng.integers(1, len(segment.stream)))
        loader = Loader(driver, segment.loads, 1.0)
        task = cocotb.start_soon(loader.run())
        driver.may_begin = lambda segment, loader=loader: loader.done >= segment.loads_before
        await driver.run(segments, 1.0, float(rng.choice([1.0, 0.3])), stop)
        task.cancel()
        dut.keep_map_i.value = 1
        await reset(dut, driver)
        dut.keep_map_i.value = 0
        segment.loads, segment.loads_before = [], 0
        seen, _ = await run(driver, segments, 0.7, 0.7)
        assert_words(seen, words_of(segments, settings))
