"""The engine with its front end: raw pairs in, the words of every level out, by registers and streams."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from frames import (
    IMAGE_KINDS,
    Frame,
    beats,
    expected_flags,
    expected_words,
    random_pair,
    random_parameters,
    register_values,
)
from maps import Grids, random_grids, words_of
from registers import (
    BEGIN_LOAD,
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
    MAP,
    MAP_POINT,
    MAP_READY,
    MAP_ROWS,
    MAP_SIZE,
    NO_MAP,
    SIZE,
    SOFT_RESET,
)
from registers import FRONT_END as FRONT_END_REGISTER
from rtl_package import package_constant
from verilated import FRONT_END, PACES, Pace, Rtl
from vista_model import Parameters, pyramid, rectify, smooth
from vista_model.rectify import reach

CONFIG = FRONT_END
ROWS = CONFIG.rows
D, B = CONFIG.num_disparities, CONFIG.block_size
SMALLEST = package_constant("MinHeight"), package_constant("MinWidth")  # level that is sent


@dataclass
class RawFrame:
    """A raw pair, and what the front end and the core are to do with it."""

    left: np.ndarray
    right: np.ndarray
    parameters: Parameters
    smooth: bool = False
    levels: int = 1
    grids: Grids | None = None  # rectified by them
    narrow: bool = False

    @property
    def shape(self) -> tuple[int, int]:
        return self.left.shape  # type: ignore[return-value]

    @property
    def stream(self) -> np.ndarray:
        return beats(self.left, self.right)

    def matched(self) -> list[Frame]:
        """What the core matches, level by level."""
        pair = [self.left, self.right]
        if self.grids is not None:
            pair = [rectify(image, grid) for image, grid in zip(pair, self.grids, strict=True)]
        frames = []
        for level in zip(*(pyramid(image, self.levels) for image in pair), strict=True):
            if (np.array(level[0].shape) < SMALLEST).any():
                break
            sides = map(smooth, level) if self.smooth else level
            left, right = map(np.ascontiguousarray, sides)  # as the C model asks
            frames.append(Frame(left, right, self.parameters, self.narrow))
        return frames

    def words(self) -> np.ndarray:
        return np.concatenate([expected_words(frame) for frame in self.matched()])

    def flags(self) -> np.ndarray:
        return np.concatenate([expected_flags(*frame.shape, self.narrow) for frame in self.matched()])

    def writes(self, load_map: bool = True) -> list[tuple[int, int]]:
        """Registers and values, the commit last: of the set, and of the map if there is a new one."""
        values = register_values(Frame(self.left, self.right, self.parameters, self.narrow))
        del values[COMMIT]
        values[FRONT_END_REGISTER] = self.smooth | (self.grids is not None) << 1 | self.levels << 8
        writes = list(values.items())
        loads = load_map and self.grids is not None
        if loads:
            writes += map_writes(self.grids)
        return [*writes, (COMMIT, COMMIT_SET | COMMIT_MAP * loads)]


def map_writes(grids: Grids) -> list[tuple[int, int]]:
    """Of the size in SIZE."""
    return [(MAP, BEGIN_LOAD), *((MAP_POINT, word) for word in words_of(grids))]


def random_raw_frame(rng: np.random.Generator, least_rows: int = 2, most_rows: int = 44) -> RawFrame:
    narrowest = D + B - 1
    widths = [rng.integers(4, narrowest), narrowest, rng.integers(narrowest, CONFIG.max_width + 1)]
    width = int(rng.choice(widths, p=[0.15, 0.1, 0.75]))
    height = int(rng.integers(least_rows, most_rows))
    return RawFrame(
        *random_pair(rng, str(rng.choice(IMAGE_KINDS)), height, width),
        random_parameters(rng, D, B),
        smooth=bool(rng.integers(2)),
        levels=int(rng.integers(1, 5)),
        grids=random_grids(rng, ROWS, height, width) if rng.random() < 0.6 else None,
        narrow=bool(rng.random() < 0.3),
    )


def written(rtl: Rtl, writes: list[tuple[int, int]]) -> None:
    for address, data in writes:
        rtl.write(address, data)


def check(rtl: Rtl, frame: RawFrame, paces: tuple[Pace, Pace] = (Pace(), Pace()), seed: int = 1) -> None:
    expected = frame.words()
    got = rtl.stream(frame.stream, len(expected) + 10, *paces, seed, quiet=6000)
    assert got.taken == frame.left.size, "the input hung"
    assert len(got.words) == len(expected)
    assert (got.words == expected).all()
    assert (got.flags == frame.flags()).all()


@pytest.mark.parametrize("seed", range(6))
def test_frames_one_after_the_other(seed: int) -> None:
    """Sizes, switches, levels and maps change from frame to frame; each is through before the next."""
    rng = np.random.default_rng(seed)
    with Rtl(CONFIG, seed + 1) as rtl:
        rtl.write(CONTROL, ENABLE)
        levels = 0
        for number in range(25):
            frame = random_raw_frame(rng)
            assert rtl.read(MAP) == MAP_READY
            written(rtl, frame.writes())
            check(rtl, frame, (PACES[rng.integers(len(PACES))], PACES[rng.integers(len(PACES))]), number)
            levels += len(frame.matched())
        assert [rtl.read(a) for a in (ERRORS, FRAMES_IN, FRAMES_OUT)] == [0, 25, levels]


@pytest.mark.parametrize("seed", range(6))
def test_frames_back_to_back(seed: int) -> None:
    """Set and map of a frame are written while the one before streams, and count from one frame to the next.

    A bank is free once the frame before the one that streams was read: 17 rows later in a buffer of 16."""
    rng = np.random.default_rng(100 + seed)
    frames = [random_raw_frame(rng, ROWS + 4) for _ in range(20)]
    ends = np.cumsum([frame.left.size for frame in frames])
    with Rtl(CONFIG, seed + 1) as rtl:
        rtl.write(CONTROL, ENABLE)
        written(rtl, frames[0].writes())
        for before, frame, end in zip(frames, frames[1:], ends, strict=False):
            begun = int(end) - before.left.size + (ROWS + 1) * before.shape[1]
            for address, data in frame.writes():
                rtl.queue_write(begun, int(end), address, data)
        expected = [frame.words() for frame in frames]
        stream = np.concatenate([frame.stream for frame in frames])
        paces = (Pace(), Pace()) if seed % 2 else (Pace(), PACES[rng.integers(len(PACES))])
        got = rtl.stream(stream, sum(map(len, expected)), *paces, seed)
        assert rtl.read(ERRORS) == 0
    assert len(got.words) == sum(map(len, expected))
    wrong = np.flatnonzero(got.words != np.concatenate(expected))
    first = np.searchsorted(np.cumsum([len(words) for words in expected]), wrong[:1], "right")
    assert not len(wrong), f"{len(wrong)} words, the first in frame {first[0]}"
    assert (got.flags == np.concatenate([frame.flags() for frame in frames])).all()


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


def refusals(rng: np.random.Generator, grids: Grids) -> list[tuple[list[tuple[int, int]], int]]:
    """Loads that are not taken, and the bit of each."""
    points = map_writes(grids)
    far = grids.copy()
    far[tuple(rng.integers(0, side) for side in far.shape[:-1])][1] = rng.choice(
        [-32 * reach(ROWS) - 1, 32 * (reach(ROWS) + 1)]
    )
    # Of 64 x 300 pixels: 5 x 20 control points, and there is memory for 64 of them.
    too_many = [(SIZE, 64 | 300 << 16), *map_writes(random_grids(rng, ROWS, 300, 64))]
    return [
        (map_writes(far), MAP_ROWS),
        (points[:-1], MAP_SIZE),
        ([*points, points[-1]], MAP_SIZE),
        (points[1:], MAP_SIZE),
        (too_many, MAP_SIZE),
    ]


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
    """Anywhere in a frame, also with levels in the buffer; a reset of all forgets it."""
    rng = np.random.default_rng(300 + seed)
    frame = random_raw_frame(rng, 20)
    height, width = frame.shape
    frame.grids = random_grids(rng, ROWS, height, width)
    with Rtl(CONFIG, seed + 1) as rtl:
        rtl.write(CONTROL, ENABLE)
        written(rtl, frame.writes())
        part = frame.stream[: int(rng.integers(1, height * width))]
        rtl.stream(part, int(rng.integers(0, 60)), quiet=int(rng.integers(20, 300)))
        rtl.write(CONTROL, ENABLE | SOFT_RESET)
        assert rtl.read(CONTROL) == ENABLE
        check(rtl, frame)
        rtl.reset()
        rtl.write(CONTROL, ENABLE)
        written(rtl, frame.writes(load_map=False))
        assert len(rtl.stream(frame.stream, 10, quiet=2000).words) == 0
        assert rtl.read(ERRORS) == NO_MAP
