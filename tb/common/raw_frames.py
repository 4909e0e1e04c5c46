"""Raw pairs for the engine with its front end: what is written for them, and the words of every level."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from frames import (
    IMAGE_KINDS,
    Frame,
    beats,
    expected_flags,
    expected_words,
    random_frame,
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
    MAP,
    MAP_POINT,
    MAP_READY,
    MAP_ROWS,
    MAP_SIZE,
    SIZE,
    SOFT_RESET,
)
from registers import FRONT_END as FRONT_END_REGISTER
from rtl_package import package_constant
from verilated import FRONT_END, PACES, Config, Pace, Rtl
from vista_model import Parameters, pyramid, rectify, smooth
from vista_model.rectify import reach

SMALLEST = package_constant("MinHeight"), package_constant("MinWidth")  # level that is sent


LEFT_BY_A_RESET = 2  # words, at most


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
    confidence: bool = False

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
            frames.append(self._as_frame(left, right))
        return frames

    def _as_frame(self, left: np.ndarray, right: np.ndarray) -> Frame:
        return Frame(left, right, self.parameters, self.narrow, self.confidence)

    def words(self) -> np.ndarray:
        return np.concatenate([expected_words(frame) for frame in self.matched()])

    def flags(self) -> np.ndarray:
        return np.concatenate([expected_flags(*frame.shape, self.narrow) for frame in self.matched()])

    def writes(self, load_map: bool = True) -> list[tuple[int, int]]:
        """Registers and values, the commit last: of the set, and of the map if there is a new one."""
        values = register_values(self._as_frame(self.left, self.right))
        del values[COMMIT]
        values[FRONT_END_REGISTER] = self.smooth | (self.grids is not None) << 1 | self.levels << 8
        writes = list(values.items())
        loads = load_map and self.grids is not None
        if loads:
            writes += map_writes(self.grids)
        return [*writes, (COMMIT, COMMIT_SET | COMMIT_MAP * loads)]


def map_writes(grids: Grids) -> list[tuple[int, int]]:
    """Writes that load the maps of the size in SIZE."""
    return [(MAP, BEGIN_LOAD), *((MAP_POINT, word) for word in words_of(grids))]


def random_raw_frame(
    rng: np.random.Generator, least_rows: int = 2, most_rows: int = 44, config: Config = FRONT_END
) -> RawFrame:
    disparities, block = config.num_disparities, config.block_size
    narrowest = disparities + block - 1
    widths = [rng.integers(4, narrowest), narrowest, rng.integers(narrowest, config.max_width + 1)]
    width = int(rng.choice(widths, p=[0.15, 0.1, 0.75]))
    height = int(rng.integers(least_rows, most_rows))
    return RawFrame(
        *random_pair(rng, str(rng.choice(IMAGE_KINDS)), height, width),
        random_parameters(rng, disparities, block),
        smooth=bool(rng.integers(2)),
        levels=int(rng.integers(1, 5)),
        grids=random_grids(rng, config.rows, height, width) if rng.random() < 0.6 else None,
        narrow=bool(rng.random() < 0.3),
        confidence=config.confidence and bool(rng.integers(2)),
    )


def random_one(rng: np.random.Generator, config: Config) -> RawFrame:
    """A frame for either top: without the front end it is matched as it is."""
    if config.rows:
        return random_raw_frame(rng, config=config)
    frame = random_frame(rng, config.num_disparities, config.block_size, config.max_width)
    return RawFrame(frame.left, frame.right, frame.parameters, narrow=bool(rng.integers(2)))


def written(rtl: Rtl, writes: list[tuple[int, int]]) -> None:
    for address, data in writes:
        rtl.write(address, data)


def soft_reset(rtl: Rtl) -> None:
    """Drops what is inside, and takes the words that stay offered."""
    rtl.write(CONTROL, ENABLE | SOFT_RESET)
    assert rtl.read(CONTROL) == ENABLE  # the response to a write comes before what it resets
    rtl.stream(np.zeros(0, np.uint32), LEFT_BY_A_RESET, quiet=10)


def check(
    rtl: Rtl,
    frame: RawFrame,
    paces: tuple[Pace, Pace] = (Pace(), Pace()),
    seed: int = 1,
    quiet: int = 6000,
) -> None:
    """The words of the models come, and after them nothing for so many clocks."""
    expected = frame.words()
    got = rtl.stream(frame.stream, len(expected) + 10, *paces, seed, quiet)
    assert got.taken == frame.left.size, "the input hung"
    assert len(got.words) == len(expected)
    assert (got.words == expected).all()
    assert (got.flags == frame.flags()).all()


def refusals(rng: np.random.Generator, grids: Grids) -> list[tuple[list[tuple[int, int]], int]]:
    """Loads that a FRONT_END does not take, and the bit of each."""
    points = map_writes(grids)
    far = grids.copy()
    far[tuple(rng.integers(0, side) for side in far.shape[:-1])][1] = rng.choice(
        [-32 * reach(FRONT_END.rows) - 1, 32 * (reach(FRONT_END.rows) + 1)]
    )
    # Of 64 x 300 pixels: 5 x 20 control points, and there is memory for 64 of them.
    too_many = [(SIZE, 64 | 300 << 16), *map_writes(random_grids(rng, FRONT_END.rows, 300, 64))]
    return [
        (map_writes(far), MAP_ROWS),
        (points[:-1], MAP_SIZE),
        ([*points, points[-1]], MAP_SIZE),
        (points[1:], MAP_SIZE),
        (too_many, MAP_SIZE),
    ]


def one_after_the_other(rtl: Rtl, seed: int, count: int) -> int:
    """Sizes, switches, levels and maps change from frame to frame; each is through before the next.

    Returns how many level images left."""
    rng = np.random.default_rng(seed)
    levels = 0
    for number in range(count):
        frame = random_raw_frame(rng, config=rtl.config)
        assert rtl.read(MAP) == MAP_READY
        written(rtl, frame.writes())
        check(rtl, frame, (PACES[rng.integers(len(PACES))], PACES[rng.integers(len(PACES))]), number)
        levels += len(frame.matched())
    return levels


def back_to_back(rtl: Rtl, seed: int, count: int) -> None:
    """Set and map of a frame are written while the one before streams, and count from one frame to the next.

    A bank is free once the frame before the one that streams was read: a row more on than the buffer has."""
    rng = np.random.default_rng(100 + seed)
    rows = rtl.config.rows
    frames = [random_raw_frame(rng, rows + 4, rows + 28, rtl.config) for _ in range(count)]
    ends = np.cumsum([frame.left.size for frame in frames])
    written(rtl, frames[0].writes())
    for before, frame, end in zip(frames, frames[1:], ends, strict=False):
        begun = int(end) - before.left.size + (rows + 1) * before.shape[1]
        for address, data in frame.writes():
            rtl.queue_write(begun, int(end), address, data)
    expected = [frame.words() for frame in frames]
    stream = np.concatenate([frame.stream for frame in frames])
    paces = (Pace(), Pace()) if seed % 2 else (Pace(), PACES[rng.integers(len(PACES))])
    got = rtl.stream(stream, sum(map(len, expected)), *paces, seed)
    assert len(got.words) == sum(map(len, expected))
    wrong = np.flatnonzero(got.words != np.concatenate(expected))
    first = np.searchsorted(np.cumsum([len(words) for words in expected]), wrong[:1], "right")
    assert not len(wrong), f"{len(wrong)} words, the first in frame {first[0]}"
    assert (got.flags == np.concatenate([frame.flags() for frame in frames])).all()
