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
    check,
    expected_flags,
    expected_words,
    random_frame,
    random_pair,
    random_parameters,
    register_values,
    run_seed,
    set_up,
)
from registers import COMMIT, CONTROL, ERRORS
from verilated import CONFIGS, PACES, Config, Pace, Rtl
from vista_model.engine import Parameters

pytestmark = pytest.mark.slow

FRAMES = 200
EUROC = (
    Path(os.environ.get("VISTA_SHARED_DATA", Path(__file__).resolve().parents[3] / "shared" / "data"))
    / "euroc_v101"
)


def name(config: Config) -> str:
    return config.name


@pytest.mark.parametrize("config", CONFIGS, ids=name)
def test_random_frames(config: Config) -> None:
    seeds = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(FRAMES)
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        for seed in seeds:
            run_seed(rtl, seed)
        assert rtl.read(ERRORS) == 0


@pytest.mark.parametrize("config", [Config(32, 11), Config(64, 11), Config(16, 5)], ids=name)
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


def test_frame_as_wide_as_the_memories() -> None:
    config = Config(32, 9, 96)
    rng = np.random.default_rng(7)
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        for seed in range(4):
            images = rng.integers(0, 256, (2, 13, config.max_width), np.uint8)
            parameters = random_parameters(rng, config.num_disparities, config.block_size)
            check(rtl, Frame(*images, parameters), Pace(), PACES[seed], seed)


def frames_of_any_size(rng: np.random.Generator, config: Config, count: int) -> list[Frame]:
    """Draws frames from 4x2 pixels on, each with parameters of its own."""
    narrowest = config.num_disparities + 2 * (config.block_size // 2)
    frames = []
    for _ in range(count):
        widths = [rng.integers(4, 9), rng.integers(4, narrowest), narrowest, narrowest + rng.integers(0, 60)]
        heights = [rng.integers(2, config.block_size), config.block_size + rng.integers(0, config.block_size)]
        width = int(rng.choice(widths, p=[0.2, 0.2, 0.1, 0.5]))
        height = int(rng.choice(heights, p=[0.15, 0.85]))
        parameters = random_parameters(rng, config.num_disparities, config.block_size)
        narrow = bool(rng.random() < 0.3)
        confidence = config.confidence and bool(rng.integers(2))
        frames.append(Frame(*random_pair(rng, "shifted", height, width), parameters, narrow, confidence))
    return frames


@pytest.mark.parametrize(
    "config", [Config(16, 5), Config(32, 11), Config(48, 7, 256, confidence=True), Config(64, 11)], ids=name
)
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
        expected = [expected_words(frame) for frame in frames]
        got = rtl.stream(np.concatenate(streams), sum(map(len, expected)))
        assert rtl.read(ERRORS) == 0
    assert len(got.words) == sum(map(len, expected))
    wrong = np.flatnonzero(got.words != np.concatenate(expected))
    first = np.searchsorted(np.cumsum([len(words) for words in expected]), wrong[:1], "right")
    assert not len(wrong), f"{len(wrong)} words, the first in frame {first[0]}"
    flags = [expected_flags(*frame.shape, frame.narrow) for frame in frames]
    assert (got.flags == np.concatenate(flags)).all()
    # At once.
    rows = np.array([frame.shape[0] for frame in frames])
    gaps = np.diff(got.in_clock)[ends[:-1] - 1]
    assert (gaps[np.diff(ends, prepend=0)[:-1] > 40] == 1).sum() > rows.size // 4


@pytest.mark.parametrize("config", [Config(16, 5), Config(32, 11)], ids=name)
@pytest.mark.parametrize("seed", range(10))
def test_parameters_take_effect_together(config: Config, seed: int) -> None:
    """Frames follow each other at once while sets of parameters are written one register after the other, at
    any time: each frame has all of a set that was committed, and none an older one than the frame before."""
    rng = np.random.default_rng(seed)
    height, width = config.block_size + 2, config.num_disparities + 2 * config.block_size
    pairs = [random_pair(rng, "shifted", height, width) for _ in range(12)]
    sets = [random_parameters(rng, config.num_disparities, config.block_size) for _ in range(8)]
    with Rtl(config, seed + 1) as rtl:
        rtl.write(CONTROL, 1)
        set_up(rtl, Frame(*pairs[0], sets[0]))
        written = np.sort(rng.integers(0, (len(pairs) - 2) * height * width, len(sets) - 1))
        for parameters, beat in zip(sets[1:], written, strict=True):
            values = register_values(Frame(*pairs[0], parameters))
            gap = int(rng.integers(0, 40))  # beats from one register to the next
            for i, (address, data) in enumerate(values.items()):
                rtl.queue_write(int(beat) + i * gap, 1 << 40, address, data)
        got = rtl.stream(np.concatenate([beats(*pair) for pair in pairs]), len(pairs) * height * width)
    current = 0
    for pair, words in zip(pairs, got.words.reshape(len(pairs), -1), strict=True):
        fitting = [i for i, p in enumerate(sets) if (expected_words(Frame(*pair, p)) == words).all()]
        assert [i for i in fitting if i >= current], f"no set from {current} on fits, {fitting} do"
        current = min(i for i in fitting if i >= current)


def test_registers_alone_change_nothing() -> None:
    """What was not committed takes no effect, however many frames come."""
    config = Config(16, 5)
    rng = np.random.default_rng(3)
    first, second = (random_frame(rng, 16, 5, 128) for _ in range(2))
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        set_up(rtl, first)
        values = register_values(second)
        del values[COMMIT]
        for address, data in values.items():
            rtl.write(address, data)
        expected = expected_words(first)
        for _ in range(2):
            assert (rtl.stream(beats(first.left, first.right), len(expected)).words == expected).all()
        rtl.write(COMMIT, 1)
        expected = expected_words(second)
        assert (rtl.stream(beats(second.left, second.right), len(expected)).words == expected).all()
