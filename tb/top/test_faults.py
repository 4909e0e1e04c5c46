"""Broken framing: the stated frames are cut as stated, the bits are set, the next frame is clean."""

from __future__ import annotations

import numpy as np
import pytest
from broken_video import FAULTS, Beats, Fault, fault_size, untouched
from faults import EARLY_EOL, EARLY_SOF, LATE_EOL, LATE_SOF, SIZE, expected_after, react
from frames import Frame, beats, expected_flags, expected_words, random_pair, random_parameters, set_up
from raw_frames import soft_reset
from registers import (
    COMMIT,
    CONTROL,
    ENABLE,
    ERROR,
    ERRORS,
    FRAME_DONE,
    FRAMES_IN,
    FRAMES_OUT,
    INTERRUPT,
    INTERRUPT_MASK,
)
from registers import SIZE as SIZE_REGISTER
from verilated import Config, Pace, Rtl

pytestmark = pytest.mark.slow

CONFIGS = [Config(16, 5), Config(32, 11), Config(48, 7, 256, confidence=True), Config(64, 11)]
CONFIG = CONFIGS[0]  # for what does not depend on the build
WIDTH, HEIGHT = fault_size(CONFIG.num_disparities, CONFIG.block_size)
PACES = [Pace(), Pace(300, 300), Pace(60, 30)]


def name(config: Config) -> str:
    return config.name


def stream_and_check(
    rtl: Rtl, stream: Beats, parameters, seed: int, paces: tuple[Pace, Pace], *format_of_words: bool
) -> int:
    width, height = fault_size(rtl.config.num_disparities, rtl.config.block_size)
    reaction = react(stream, width, height)
    expected = [
        expected_after(frame, width, height, parameters, *format_of_words) for frame in reaction.frames
    ]
    count = sum(map(len, expected))
    got = rtl.stream(stream, count + 100, *paces, seed)
    assert got.taken == len(stream), "the input hung"
    assert len(got.words) == count
    assert (got.words == np.concatenate(expected)).all()
    assert (
        got.flags == np.tile(expected_flags(height, width, *format_of_words[:1]), len(reaction.frames))
    ).all()
    assert rtl.read(ERRORS) == reaction.errors
    return reaction.errors


@pytest.mark.parametrize("config", CONFIGS[::2], ids=name)
@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f.__name__)
def test_fault_between_good_frames(fault: Fault, config: Config) -> None:
    width, height = fault_size(config.num_disparities, config.block_size)
    errors = 0
    for seed in range(8):
        rng = np.random.default_rng(seed)
        pairs = [random_pair(rng, kind, height, width) for kind in ("shifted", "noise", "shifted")]
        parameters = random_parameters(rng, config.num_disparities, config.block_size)
        streams = [beats(*pair) for pair in pairs]
        streams[1] = fault(streams[1], width, int(rng.integers(1, width * height - 1)), rng)
        with Rtl(config, seed + 1) as rtl:
            rtl.write(CONTROL, 1)
            set_up(rtl, Frame(*pairs[0], parameters))
            paces = PACES[rng.integers(3)], PACES[rng.integers(3)]
            errors |= stream_and_check(rtl, np.concatenate(streams), parameters, seed, paces)
            rtl.write(ERRORS, 0xFFFFFFFF)
            assert rtl.read(ERRORS) == 0
    assert bool(errors) == (fault is not untouched)


@pytest.mark.parametrize("config", CONFIGS, ids=name)
@pytest.mark.parametrize("seed", range(20))
def test_random_faults(seed: int, config: Config) -> None:
    """Many faults in a row, whole frames among them."""
    width, height = fault_size(config.num_disparities, config.block_size)
    rng = np.random.default_rng(1000 + seed)
    parameters = random_parameters(rng, config.num_disparities, config.block_size)
    streams = []
    for _ in range(8):
        stream = beats(*random_pair(rng, "shifted", height, width))
        fault = FAULTS[rng.integers(len(FAULTS))]
        streams.append(fault(stream, width, int(rng.integers(1, width * height - 1)), rng))
    streams.append(beats(*random_pair(rng, "shifted", height, width)))
    with Rtl(config, seed + 1) as rtl:
        rtl.write(CONTROL, 1)
        narrow, confidence = seed % 3 == 0, config.confidence and seed % 2 == 1
        set_up(rtl, Frame(*random_pair(rng, "noise", height, width), parameters, narrow, confidence))
        paces = PACES[rng.integers(3)], PACES[rng.integers(3)]
        stream_and_check(rtl, np.concatenate(streams), parameters, seed, paces, narrow, confidence)


def test_every_error_bit_is_reached() -> None:
    reached = 0
    for fault in FAULTS:
        for seed in range(4):
            rng = np.random.default_rng(seed)
            streams = [beats(*random_pair(rng, "noise", HEIGHT, WIDTH)) for _ in range(3)]
            streams[1] = fault(streams[1], WIDTH, int(rng.integers(1, WIDTH * HEIGHT - 1)), rng)
            reached |= react(np.concatenate(streams), WIDTH, HEIGHT).errors
    assert reached == EARLY_EOL | LATE_EOL | EARLY_SOF | LATE_SOF


@pytest.mark.parametrize(
    "size", [(3, 14), (1025, 14), (2000, 14), (65535, 14), (WIDTH, 1), (WIDTH, 4096), (0, 0)]
)
def test_frame_of_illegal_size_is_dropped(size: tuple[int, int]) -> None:
    rng = np.random.default_rng(1)
    pair = random_pair(rng, "shifted", HEIGHT, WIDTH)
    frame = Frame(*pair, random_parameters(rng, 16, 5))
    with Rtl(CONFIG) as rtl:
        rtl.write(CONTROL, 1)
        set_up(rtl, frame)
        rtl.write(SIZE_REGISTER, size[0] | size[1] << 16)
        rtl.write(COMMIT, 1)
        assert rtl.stream(beats(*pair), 10, quiet=2000).taken == WIDTH * HEIGHT
        assert (rtl.read(ERRORS), rtl.read(FRAMES_IN)) == (SIZE, 0)
        set_up(rtl, frame)
        assert (rtl.stream(beats(*pair), WIDTH * HEIGHT).words == expected_words(frame)).all()


def test_disabled_engine_drops_frames_but_finishes_the_one_under_way() -> None:
    rng = np.random.default_rng(2)
    pair = random_pair(rng, "shifted", HEIGHT, WIDTH)
    frame = Frame(*pair, random_parameters(rng, 16, 5))
    stream = beats(*pair)
    with Rtl(CONFIG) as rtl:
        set_up(rtl, frame)
        assert len(rtl.stream(stream, 10, quiet=2000).words) == 0
        rtl.write(CONTROL, 1)
        first = rtl.stream(stream[:400], WIDTH * HEIGHT, quiet=200)
        rtl.write(CONTROL, 0)
        rest = rtl.stream(np.concatenate([stream[400:], stream]), 2 * WIDTH * HEIGHT, quiet=2000)
        assert (np.concatenate([first.words, rest.words]) == expected_words(frame)).all()
        assert [rtl.read(a) for a in (ERRORS, FRAMES_IN, FRAMES_OUT)] == [0, 1, 1]


@pytest.mark.parametrize("at", [1, WIDTH - 1, WIDTH, 300, WIDTH * HEIGHT - 1])
def test_reset_inside_a_frame_leaves_nothing_behind(at: int) -> None:
    rng = np.random.default_rng(at)
    pair = random_pair(rng, "noise", HEIGHT, WIDTH)
    frame = Frame(*random_pair(rng, "shifted", HEIGHT, WIDTH), random_parameters(rng, 16, 5))
    with Rtl(CONFIG) as rtl:
        rtl.write(CONTROL, 1)
        set_up(rtl, frame)
        rtl.stream(beats(*pair)[:at], WIDTH * HEIGHT, quiet=100)
        rtl.reset(1)
        assert rtl.read(CONTROL) == 0
        rtl.write(CONTROL, 1)
        set_up(rtl, frame)
        got = rtl.stream(beats(frame.left, frame.right), WIDTH * HEIGHT + 50, quiet=2000)
        assert (got.words == expected_words(frame)).all()


@pytest.mark.parametrize("config", CONFIGS, ids=name)
@pytest.mark.parametrize("seed", range(8))
def test_soft_reset_leaves_registers_but_no_frame(config: Config, seed: int) -> None:
    """Anywhere in a frame, with words waiting: the next frame is right, with the parameters as they were."""
    width, height = fault_size(config.num_disparities, config.block_size)
    rng = np.random.default_rng(seed)
    pair = random_pair(rng, "noise", height, width)
    parameters = random_parameters(rng, config.num_disparities, config.block_size)
    frame = Frame(*random_pair(rng, "shifted", height, width), parameters, narrow=bool(seed % 2))
    expected = expected_words(frame)
    with Rtl(config) as rtl:
        rtl.write(CONTROL, ENABLE)
        set_up(rtl, frame)
        rtl.stream(beats(*pair)[: int(rng.integers(1, width * height))], int(rng.integers(50)), quiet=200)
        soft_reset(rtl)
        got = rtl.stream(beats(frame.left, frame.right), len(expected) + 50, quiet=2000)
        assert len(got.words) == len(expected) and (got.words == expected).all()
        assert [rtl.read(a) for a in (ERRORS, FRAMES_IN, FRAMES_OUT)] == [0, 2, 1]


def test_interrupt_and_its_mask() -> None:
    rng = np.random.default_rng(4)
    frame = Frame(*random_pair(rng, "shifted", HEIGHT, WIDTH), random_parameters(rng, 16, 5))
    stream, pixels = beats(frame.left, frame.right), WIDTH * HEIGHT
    with Rtl(CONFIG) as rtl:
        rtl.write(CONTROL, ENABLE)
        set_up(rtl, frame)
        rtl.stream(stream, pixels)
        assert (rtl.read(INTERRUPT), rtl.interrupt()) == (FRAME_DONE, False)  # masked, but kept
        rtl.write(INTERRUPT_MASK, FRAME_DONE)
        assert rtl.interrupt()
        rtl.write(INTERRUPT, FRAME_DONE)
        assert (rtl.read(INTERRUPT), rtl.interrupt()) == (0, False)
        rtl.stream(stream[:300], 10, quiet=500)
        assert not rtl.interrupt()
        rtl.stream(stream, 2 * pixels - 10)  # cuts the frame that was begun
        assert rtl.read(INTERRUPT) == FRAME_DONE | ERROR
        for mask in range(4):
            rtl.write(INTERRUPT_MASK, mask)
            assert rtl.interrupt() == bool(mask)
        rtl.write(INTERRUPT, FRAME_DONE)
        for mask in range(4):
            rtl.write(INTERRUPT_MASK, mask)
            assert rtl.interrupt() == bool(mask & ERROR)
        rtl.write(INTERRUPT, ERROR)
        assert (rtl.read(INTERRUPT), rtl.interrupt()) == (0, False)
        assert rtl.read(ERRORS) == EARLY_SOF
