"""Ways in which the video of a frame can break, each a function of its beats and its width.

`at` is where: a pixel behind the first one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from verilated import LAST, USER

Beats = npt.NDArray[np.uint32]
Fault = Callable[[Beats, int, int, np.random.Generator], Beats]


def early_end_of_line(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    stream[at] |= LAST
    return stream


def missing_end_of_line(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    stream[at - at % width + width - 1] &= ~np.uint32(LAST)
    return stream


def early_start_of_frame(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    stream[at] |= USER
    return stream


def missing_start_of_frame(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    stream[0] &= ~np.uint32(USER)
    return stream


def short_line(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    end = at - at % width + width - 1
    return np.delete(stream, slice(end - int(rng.integers(1, width - 1)), end))


def long_line(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    return np.insert(stream, at - at % width + 1, rng.integers(0, 65536, int(rng.integers(1, 40)), np.uint32))


def truncated_frame(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    return stream[:at]


def frame_short_of_rows(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    return stream[: max(at - at % width, width)]


def frame_with_more_rows(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    return np.concatenate([stream, stream[width : width * int(rng.integers(2, 5))]])


def lost_pixel(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    return np.delete(stream, at)


def untouched(stream: Beats, width: int, at: int, rng: np.random.Generator) -> Beats:
    return stream


def fault_size(num_disparities: int, block_size: int) -> tuple[int, int]:
    """Width and height of frames that are small and have matched pixels in plenty."""
    return num_disparities + 3 * block_size + 25, 2 * block_size + 4


FAULTS: list[Fault] = [
    early_end_of_line, missing_end_of_line, early_start_of_frame, missing_start_of_frame,
    short_line, long_line,
    truncated_frame, frame_short_of_rows, frame_with_more_rows, lost_pixel, untouched,
]  # fmt: skip
