"""Tests covariances: the average NEES, e^T P^-1 e over frames, against its chi-square band.

Of N independent errors of n dimensions the sum of the NEES is chi-square with n N degrees of freedom. A
filter's errors are not independent from frame to frame: the band is made with the effective number of samples
N_eff = N / (1 + 2 sum rho_k), rho the autocorrelation of a flight's NEES up to its first value below 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from vista.geometry import Array

DIMENSIONS = 3
BAND = 0.95


@dataclass(frozen=True)
class Consistency:
    average: float  # NEES; DIMENSIONS if the covariance is honest
    low: float  # of the band
    high: float
    samples: int
    effective: float

    @property
    def within(self) -> bool:
        return self.low <= self.average <= self.high


def consistency(series: list[Array]) -> Consistency | None:
    """series: the NEES of each flight over its matched frames, in time; flights are independent."""
    filled = [np.asarray(one, float) for one in series if len(one)]
    if not filled:
        return None
    effective = sum(effective_samples(one) for one in filled)
    everything = np.concatenate(filled)
    tail = (1.0 - BAND) / 2.0
    low, high = (chi_square_quantile(p, DIMENSIONS * effective) / effective for p in (tail, 1.0 - tail))
    return Consistency(float(everything.mean()), low, high, len(everything), effective)


def effective_samples(series: Array) -> float:
    """At least 1."""
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
