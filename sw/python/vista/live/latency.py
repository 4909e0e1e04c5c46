"""Latencies of a flight of any length in memory of one size (vista/latency.h)."""

from __future__ import annotations

from vista import native


class Latencies:
    """A histogram with logarithmic bins from 0.1 ms to 100 s."""

    def __init__(self) -> None:
        ffi, self._lib = native.load("vista")
        self._counted = ffi.new("vista_latency *")

    @property
    def last_ms(self) -> float:
        return float(self._counted.last_ms)

    @property
    def most_ms(self) -> float:
        return float(self._counted.most_ms)

    def add(self, latency_ms: float) -> None:
        self._lib.vista_latency_add(self._counted, latency_ms)

    def percentile_ms(self, percent: float) -> float:
        """0 before the first."""
        return float(self._lib.vista_latency_percentile_ms(self._counted, percent))

    def summary(self) -> str:
        median_ms, late_ms = self.percentile_ms(50.0), self.percentile_ms(99.0)
        return f"{median_ms:.1f} ms (p99 {late_ms:.1f}, most {self.most_ms:.1f})"
