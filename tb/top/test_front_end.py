"""The engine with its front end: raw pairs in, the words of every level out, by registers and streams."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest
from frames import random_pair, random_parameters
from maps import random_grids
from raw_frames import (
    RawFrame,
    back_to_back,
    check,
    one_after_the_other,
    random_raw_frame,
    refusals,
    soft_reset,
    written,
)
from registers import (
    COMMIT,
    COMMIT_MAP,
    COMMIT_SET,
    CONTROL,
    ENABLE,
    ERROR,
    ERRORS,
    FRAMES_IN,
    FRAMES_OUT,
    INTERRUPT,
    NO_MAP,
    SIZE,
)
from verilated import FRONT_END, Rtl

pytestmark = pytest.mark.slow

CONFIG = replace(FRONT_END, confidence=True)
ROWS = CONFIG.rows
D, B = CONFIG.num_disparities, CONFIG.block_size


SEEDS = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(6)


@pytest.mark.parametrize("seed", SEEDS)
def test_frames_one_after_the_other(seed: int) -> None:
    with Rtl(CONFIG, seed + 1) as rtl:
        rtl.write(CONTROL, ENABLE)
        levels = one_after_the_other(rtl, seed, 25)
        assert [rtl.read(a) for a in (ERRORS, FRAMES_IN, FRAMES_OUT)] == [0, 25, levels]


@pytest.mark.parametrize("seed", SEEDS)
def test_frames_back_to_back(seed: int) -> None:
    with Rtl(CONFIG, seed + 1) as rtl:
        rtl.write(CONTROL, ENABLE)
        back_to_back(rtl, seed, 20)
        assert rtl.read(ERRORS) == 0


def test_one_pixel_per_clock() -> None:
    """Rectified and smoothed frames of one level follow each other without a gap."""
    rng = np.random.default_rng(5)
    frames = [
        RawFrame(*random_pair(rng, "shifted", 30, 60), random_parameters(rng, D, B), True) for _ in range(4)
    ]
    grids = random_grids(rng, ROWS, 30, 60)
    with Rtl(CONFIG) as rtl:
        rtl.write(CONTROL, ENABLE)
        for frame in frames:
            frame.grids, frame.parameters = grids, frames[0].parameters
        written(rtl, frames[0].writes())
        expected = np.concatenate([frame.words() for frame in frames])
        got = rtl.stream(np.concatenate([frame.stream for frame in frames]), len(expected))
    assert (got.words == expected).all()
    assert (np.diff(got.in_clock) == 1).all()
    first_matched = B // 2 * 60 + D - 1 + B // 2
    assert (np.diff(got.out_clock[first_matched:]) == 1).all()


@pytest.mark.parametrize("seed", range(4))
def test_a_refused_map_leaves_the_one_before(seed: int) -> None:
    rng = np.random.default_rng(200 + seed)
    height, width = 24, int(rng.integers(D + B - 1, CONFIG.max_width + 1))
    frame = RawFrame(
        *random_pair(rng, "shifted", height, width), random_parameters(rng, D, B),
        grids=random_grids(rng, ROWS, height, width),
    )  # fmt: skip
    with Rtl(CONFIG, seed + 1) as rtl:
        rtl.write(CONTROL, ENABLE)
        written(rtl, frame.writes())
        check(rtl, frame)
        for load, bit in refusals(rng, random_grids(rng, ROWS, height, width)):
            written(rtl, load)
            rtl.write(COMMIT, COMMIT_MAP)
            assert rtl.read(ERRORS) == bit
            assert rtl.read(INTERRUPT) & ERROR
            rtl.write(ERRORS, bit)
            rtl.write(INTERRUPT, ERROR)
            written(rtl, frame.writes(load_map=False))
            check(rtl, frame)


def test_a_frame_without_a_map_for_its_size_is_dropped() -> None:
    rng = np.random.default_rng(6)
    frame = RawFrame(*random_pair(rng, "shifted", 20, 40), random_parameters(rng, D, B))
    frame.grids = random_grids(rng, ROWS, 20, 40)
    with Rtl(CONFIG) as rtl:
        rtl.write(CONTROL, ENABLE)
        written(rtl, frame.writes(load_map=False))
        assert rtl.stream(frame.stream, 10, quiet=2000).taken == frame.left.size
        assert (rtl.read(ERRORS), rtl.read(FRAMES_IN)) == (NO_MAP, 0)
        written(rtl, frame.writes())
        check(rtl, frame)
        rtl.write(SIZE, 40 | 21 << 16)  # the map in force is one for 20 rows
        rtl.write(COMMIT, COMMIT_SET)
        assert len(rtl.stream(frame.stream, 10, quiet=2000).words) == 0
        assert rtl.read(ERRORS) == NO_MAP


@pytest.mark.parametrize("seed", range(8))
def test_soft_reset_keeps_the_map(seed: int) -> None:
    """Anywhere in a frame, also with levels in the buffer; a reset of all, while pixels wait, forgets it."""
    rng = np.random.default_rng(300 + seed)
    frame = random_raw_frame(rng, 20)
    height, width = frame.shape
    frame.grids = random_grids(rng, ROWS, height, width)
    with Rtl(CONFIG, seed + 1) as rtl:
        rtl.write(CONTROL, ENABLE)
        written(rtl, frame.writes())
        part = frame.stream[: int(rng.integers(1, height * width))]
        rtl.stream(part, int(rng.integers(0, 60)), quiet=int(rng.integers(20, 300)))
        soft_reset(rtl)
        check(rtl, frame)
        rtl.stream(frame.stream, int(rng.integers(0, 60)), quiet=300)
        rtl.reset()
        rtl.write(CONTROL, ENABLE)
        written(rtl, frame.writes(load_map=False))
        assert len(rtl.stream(frame.stream, 10, quiet=2000).words) == 0
        assert rtl.read(ERRORS) == NO_MAP
