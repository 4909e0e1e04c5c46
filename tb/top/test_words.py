"""The engine sends the words of the C model: all of them, in order, well framed, whatever stalls."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from frames import (
    Frame,
    beats,
    expected_flags,
    expected_words,
    random_frame,
    random_pair,
    random_parameters,
    register_values,
    set_up,
)
from registers import CONTROL, ERRORS
from verilated import CONFIGS, PACES, Config, Pace, Rtl
from vista_model.engine import Parameters

MAIN = Config(32, 11)
FRAMES = 200
EUROC = (
    Path(os.environ.get("VISTA_SHARED_DATA", Path(__file__).resolve().parents[3] / "shared" / "data"))
    / "euroc_v101"
)


def name(config: Config) -> str:
    return config.name


def check(rtl: Rtl, frame: Frame, pace_in: Pace, pace_out: Pace, seed: int) -> None:
    height, width = frame.shape
    set_up(rtl, frame)
    got = rtl.stream(beats(frame.left, frame.right), height * width, pace_in, pace_out, seed)
    expected = expected_words(frame)
    rerun = f"VISTA_WAVES=1 VISTA_SEED={seed} pytest tb/top/test_words.py -k 'random and {rtl.config.name}'"
    assert len(got.words) == len(expected), (
        f"{len(got.words)} of {len(expected)} words, {frame.parameters}; {rerun}"
    )
    wrong = np.flatnonzero(got.words != expected)
    if len(wrong):
        y, x = divmod(int(wrong[0]), width)
        pytest.fail(f"{len(wrong)} words differ, the first at x {x}, y {y} of {width}x{height}: "
                    f"{got.words[wrong[0]]:08x} for {expected[wrong[0]]:08x}, {frame.parameters}; "
                    f"{rerun}")  # fmt: skip
    assert (got.flags == expected_flags(height, width)).all(), rerun


def run_seed(rtl: Rtl, seed: int) -> None:
    rng = np.random.default_rng(seed)
    c = rtl.config
    frame = random_frame(rng, c.num_disparities, c.block_size, c.max_width)
    check(rtl, frame, PACES[rng.integers(len(PACES))], PACES[rng.integers(len(PACES))], seed)


@pytest.mark.parametrize("config", CONFIGS, ids=name)
def test_random_frames(config: Config) -> None:
    seeds = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(FRAMES)
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        for seed in seeds:
            run_seed(rtl, seed)
        assert rtl.read(ERRORS) == 0


@pytest.mark.parametrize("config", [Config(32, 11), Config(64, 11), Config(16, 15)], ids=name)
@pytest.mark.parametrize("prefilter", ["xsobel", "none"])
def test_whole_real_frame(config: Config, prefilter: str) -> None:
    sides = [sorted((EUROC / f"mav0/cam{i}/data").glob("*.png")) for i in (0, 1)]
    if not all(sides):
        pytest.skip(f"no EuRoC frames under {EUROC}")
    left, right = (
        np.ascontiguousarray(cv2.imread(str(s[0]), cv2.IMREAD_GRAYSCALE)[:480, :640]) for s in sides
    )
    parameters = Parameters(config.num_disparities, config.block_size, prefilter=prefilter)
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        check(rtl, Frame(left, right, parameters), Pace(), Pace(), 1)


@pytest.mark.parametrize("max_width", [64, 100])
def test_frame_as_wide_as_the_memories(max_width: int) -> None:
    config = Config(16, 5, max_width)
    rng = np.random.default_rng(7)
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        for seed in range(4):
            images = rng.integers(0, 256, (2, 9, max_width), np.uint8)
            check(rtl, Frame(*images, random_parameters(rng, 16, 5)), Pace(), PACES[seed], seed)


def frames_of_any_size(rng: np.random.Generator, config: Config, count: int) -> list[Frame]:
    """From 4x2 pixels on, each with parameters of its own."""
    narrowest = config.num_disparities + 2 * (config.block_size // 2)
    frames = []
    for _ in range(count):
        widths = [rng.integers(4, 9), rng.integers(4, narrowest), narrowest, narrowest + rng.integers(0, 60)]
        heights = [rng.integers(2, config.block_size), config.block_size + rng.integers(0, config.block_size)]
        width = int(rng.choice(widths, p=[0.2, 0.2, 0.1, 0.5]))
        height = int(rng.choice(heights, p=[0.15, 0.85]))
        parameters = random_parameters(rng, config.num_disparities, config.block_size)
        frames.append(Frame(*random_pair(rng, "shifted", height, width), parameters))
    return frames


@pytest.mark.parametrize("config", [Config(16, 5), Config(32, 11), Config(64, 5)], ids=name)
@pytest.mark.parametrize("seed", range(20))
def test_frames_back_to_back_keep_their_own_size_and_parameters(config: Config, seed: int) -> None:
    """The registers of a frame are written while the one before streams, so that it follows at once: without
    a clock between them unless the one before is shorter than the writes take."""
    rng = np.random.default_rng(seed)
    frames = frames_of_any_size(rng, config, 40)
    streams = [beats(frame.left, frame.right) for frame in frames]
    ends = np.cumsum([len(stream) for stream in streams])
    with Rtl(config, seed + 1) as rtl:
        rtl.write(CONTROL, 1)
        set_up(rtl, frames[0])
        for before, frame, end in zip(streams, frames[1:], ends, strict=False):
            for address, data in register_values(frame).items():
                rtl.queue_write(int(end) - len(before) + 3, int(end), address, data)  # two wait in the buffer
        got = rtl.stream(np.concatenate(streams), int(ends[-1]))
        assert rtl.read(ERRORS) == 0
    expected = np.concatenate([expected_words(f) for f in frames])
    assert len(got.words) == len(expected)
    wrong = np.flatnonzero(got.words != expected)
    assert not len(wrong), (
        f"{len(wrong)} words, the first in frame {np.searchsorted(ends, wrong[0], 'right')}"
    )
    # At once.
    rows = np.array([frame.shape[0] for frame in frames])
    gaps = np.diff(got.in_clock)[ends[:-1] - 1]
    assert (gaps[np.diff(ends, prepend=0)[:-1] > 40] == 1).sum() > rows.size // 4
