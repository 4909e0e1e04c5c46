"""Disparities against measured ones: how many pixels have one, and how many of these are wrong.

Density is the share of the measured pixels that have a disparity to judge, bad-3 the share of these that are
off by more than 3 px at the scale of the full image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray
from vista.engine import Disparity

from vista_eval.metrics.standing_points import Share, shares

Pixels = NDArray[np.float64]  # disparity in px of the full image, not a number where there is none

BAD_PX = 3.0
WORDS_PER_PX = 16


def at_full_size(words: Disparity, level: int, shape: tuple[int, int]) -> Pixels:
    """The disparities of a level at every pixel of level 0: those of the nearest pixel of the level.

    Pixel i of level k lies at pixel 2**k i of level 0; half way between two, the latter is taken.
    """
    half = (1 << level) // 2
    rows, columns = (
        np.minimum((np.arange(full) + half) >> level, size - 1)
        for full, size in zip(shape, words.shape, strict=True)
    )
    near = words[np.ix_(rows, columns)]
    return np.where(near < 0, np.nan, near * (2.0**level / WORDS_PER_PX))


def finest(levels: Sequence[Pixels]) -> Pixels:
    """The disparity of the first level that has one, for each pixel."""
    chosen = levels[0]
    for level in levels[1:]:
        chosen = np.where(np.isnan(chosen), level, chosen)
    return chosen


@dataclass(frozen=True)
class Counts:
    """Pixels of one pair: with a measured disparity, of these with one to judge, of these wrong."""

    measured: int
    valid: int
    bad: int


def count(disparity: Pixels, truth: Pixels, within: NDArray[np.bool_] | bool = True) -> Counts:
    measured = ~np.isnan(truth) & within
    valid = measured & ~np.isnan(disparity)
    bad = np.abs(disparity[valid] - truth[valid]) > BAD_PX
    return Counts(int(measured.sum()), int(valid.sum()), int(bad.sum()))


@dataclass(frozen=True)
class Quality:
    density: Share
    bad: Share
    pairs: int


def quality(counts: Sequence[Counts]) -> Quality:
    """The quality of many pairs, every pixel counting the same; intervals over whole pairs."""
    wanted = {"density": ("valid", "measured"), "bad": ("bad", "valid")}
    return Quality(**shares([asdict(one) for one in counts], wanted), pairs=len(counts))
