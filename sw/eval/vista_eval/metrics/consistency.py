"""Tests covariances: the average NEES, e^T P^-1 e over frames, against its chi-square band.

Of N independent errors the sum of the NEES is chi-square with as many degrees of freedom as the errors have
dimensions together: three of a position, one of a distance along the line of sight. A
filter's errors are not independent from frame to frame: the band is made with the effective number of samples
N_eff = N / (1 + 2 sum rho_k), rho the autocorrelation of a flight's NEES up to its first value below 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike
from vista.geometry import Array

DIMENSIONS = 3  # of a position
BAND = 0.95


@dataclass(frozen=True)
class Consistency:
    average: float  # NEES; if the covariance is honest, the mean of the errors' dimensions
    low: float  # of the band
    high: float
    samples: int
    effective: float

    @property
    def within(self) -> bool:
        return self.low <= self.average <= self.high


def consistency(series: Sequence[tuple[ArrayLike, ArrayLike]]) -> Consistency | None:
    """series: of each flight the NEES over its matched frames, in time, and the dimensions of each, or of all
    of them; flights are independent."""
    flights = [np.broadcast_arrays(np.asarray(values, float), dimensions) for values, dimensions in series]
    filled = [(values, dimensions) for values, dimensions in flights if len(values)]
    if not filled:
        return None
    effective = sum(effective_samples(values / dimensions) for values, dimensions in filled)
    everything, dimensions = (np.concatenate(each) for each in zip(*filled, strict=True))
    degrees, tail = float(dimensions.mean()) * effective, (1.0 - BAND) / 2.0
    low, high = (chi_square_quantile(p, degrees) / effective for p in (tail, 1.0 - tail))
    return Consistency(float(everything.mean()), low, high, len(everything), effective)


def effective_samples(series: Array) -> float:
    """The number of independent samples that the series is worth, at least 1."""
    count = len(series)
    deviation = series - series.mean()
    variance = float(deviation @ deviation)
    if count < 2 or variance == 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, count):
        correlation = float(deviation[lag:] @ deviation[:-lag]) / variance
        if correlation < 0.0:
            break
        total += 2.0 * correlation
    return max(count / total, 1.0)


def chi_square_quantile(probability: float, degrees: float) -> float:
    """Wilson and Hilferty 1931: (X / k)^(1/3) is nearly normal; within 0.4 % from k = 30, 17 % at k = 3."""
    spread = 2.0 / (9.0 * degrees)
    z = NormalDist().inv_cdf(probability)
    return degrees * max(1.0 - spread + z * math.sqrt(spread), 0.0) ** 3
