"""Latencies of a flight of any length in memory of one size."""

from __future__ import annotations

import numpy as np

LEAST_MS, MOST_MS = 0.1, 100_000.0
PER_BIN = 1.02  # bins are so much wider than the one below: a percentile is good to 1 %
BINS = int(np.ceil(np.log(MOST_MS / LEAST_MS) / np.log(PER_BIN))) + 1


class Latencies:
    """A histogram with logarithmic bins from 0.1 ms to 100 s."""

    def __init__(self) -> None:
        self.last_ms = 0.0
        self.most_ms = 0.0
        self._counts = np.zeros(BINS, np.int64)

    def add(self, latency_ms: float) -> None:
        self.last_ms = latency_ms
        self.most_ms = max(self.most_ms, latency_ms)
        clipped_ms = min(max(latency_ms, LEAST_MS), MOST_MS)
        self._counts[int(np.log(clipped_ms / LEAST_MS) / np.log(PER_BIN))] += 1

    def percentile_ms(self, percent: float) -> float:
        """0 before the first."""
        total = int(self._counts.sum())
        if total == 0:
            return 0.0
        rank = max(1, int(np.ceil(0.01 * percent * total)))
        index = int(np.searchsorted(np.cumsum(self._counts), rank))
        return float(min(LEAST_MS * PER_BIN ** (index + 0.5), self.most_ms))

    def summary(self) -> str:
        median_ms, late_ms = self.percentile_ms(50.0), self.percentile_ms(99.0)
        return f"{median_ms:.1f} ms (p99 {late_ms:.1f}, most {self.most_ms:.1f})"
