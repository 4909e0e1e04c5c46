"""Intervals that hold 95 %, over flights: the frames of one flight are not independent of each other.

Of a share of frames: a bootstrap that draws whole flights. Where all flights say the same, all or nothing, it
would find no spread at all; then the interval is the exact one of Clopper and Pearson for the count of
flights. That is also used for what a flight as a whole has or has not. Fewer flights than MIN_FLIGHTS have no
bootstrap: one alone, drawn again and again, would pass for certain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, lgamma, log, log1p

import numpy as np

LEVEL = 0.95
MIN_FLIGHTS = 3  # of a bootstrap
RESAMPLES = 2000
BISECTIONS = 50


@dataclass(frozen=True)
class Share:
    part: int
    whole: int
    low: float | None  # None, as high: too few flights
    high: float | None
    exact: bool  # for the count of flights; else from the bootstrap over flights

    @property
    def value(self) -> float:
        return self.part / self.whole


def share_of_flights(had: list[bool]) -> Share | None:
    """had: of each flight."""
    return None if not had else Share(sum(had), len(had), *clopper_pearson(sum(had), len(had)), exact=True)


def share_of_frames(counts: list[tuple[int, int]], seed: int = 0) -> Share | None:
    """counts: of each flight, the frames that have it and those that might."""
    counts = [(part, whole) for part, whole in counts if whole]
    if not counts:
        return None
    part, whole = (int(sum(column)) for column in zip(*counts, strict=True))
    if part in (0, whole):
        return Share(part, whole, *clopper_pearson(len(counts) if part else 0, len(counts)), exact=True)
    if len(counts) < MIN_FLIGHTS:
        return Share(part, whole, None, None, exact=False)
    drawn = np.random.default_rng(seed).integers(0, len(counts), (RESAMPLES, len(counts)))
    parts, wholes = np.array(counts).T
    shares = parts[drawn].sum(axis=1) / wholes[drawn].sum(axis=1)
    tail = 50.0 * (1.0 - LEVEL)
    low, high = np.percentile(shares, [tail, 100.0 - tail])
    return Share(part, whole, float(low), float(high), exact=False)


def clopper_pearson(part: int, whole: int) -> tuple[float, float]:
    """The interval of a probability of which `part` of `whole` independent trials are known."""
    tail = (1.0 - LEVEL) / 2.0
    low = 0.0 if part == 0 else _bisect(lambda p: 1.0 - _at_most(part - 1, whole, p) - tail)
    high = 1.0 if part == whole else _bisect(lambda p: tail - _at_most(part, whole, p))
    return low, high


def poisson(count: int) -> tuple[float, float]:
    """The exact interval of how many events are expected where `count` independent ones were seen."""
    tail, most = (1.0 - LEVEL) / 2.0, count + 10.0 * (count**0.5 + 1.0)

    def at_most(events: int, share: float) -> float:
        return sum(exp(k * log(share * most) - share * most - lgamma(k + 1)) for k in range(events + 1))

    low = 0.0 if count == 0 else most * _bisect(lambda share: 1.0 - at_most(count - 1, share) - tail)
    return low, most * _bisect(lambda share: tail - at_most(count, share))


def _at_most(count: int, trials: int, probability: float) -> float:
    """The probability of at most so many, by logarithms: of a thousand trials the binomial coefficients alone
    are beyond what a float holds."""
    whole, hit, miss = lgamma(trials + 1), log(probability), log1p(-probability)
    return sum(
        exp(whole - lgamma(k + 1) - lgamma(trials - k + 1) + k * hit + (trials - k) * miss)
        for k in range(count + 1)
    )


def _bisect(rising: Callable[[float], float]) -> float:
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rising(middle) > 0.0 else (middle, high)
    return 0.5 * (low + high)
