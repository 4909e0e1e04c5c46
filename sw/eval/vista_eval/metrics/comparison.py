"""VISTA compared with stereo alone, by missed frames and frames with a false alarm."""

from __future__ import annotations

from dataclasses import dataclass

from vista_eval.baselines.stereo_alone import Outcome, Threshold, sweep
from vista_eval.metrics.flight_score import FlightScore
from vista_eval.report.table import Table


@dataclass(frozen=True)
class Point:
    threshold: Threshold | None  # None: ours
    missed: int
    alarms: int

    def beats(self, other: Point) -> bool:
        """Fewer misses and fewer false alarms."""
        return self.missed < other.missed and self.alarms < other.alarms

    def equals(self, other: Point) -> bool:
        """No more of either."""
        return self.missed <= other.missed and self.alarms <= other.alarms


@dataclass(frozen=True)
class Comparison:
    flights: int
    near_frames: int  # with a target nearer than 45 m: those that can be missed
    frames: int
    ours: Point
    alone: tuple[Point, ...]

    @property
    def beating(self) -> list[Point]:
        return [point for point in self.alone if point.beats(self.ours)]

    @property
    def equalling(self) -> list[Point]:
        return [point for point in self.alone if point.equals(self.ours)]


def compare(scores: list[FlightScore], alone: list[list[Outcome]]) -> Comparison:
    """alone: of the same flights, in their order."""
    points = sweep(alone)
    return Comparison(
        len(scores),
        sum(len(outcomes[0].seen_px) for outcomes in alone),
        sum(len(score.frames) for score in scores),
        Point(
            None,
            sum(len(score.missed) for score in scores),
            sum(len(score.false_alarm_frames) for score in scores),
        ),
        tuple(Point(threshold, *counts) for threshold, counts in points.items()),
    )


def table(comparison: Comparison) -> Table:
    alone, ours = comparison.alone, comparison.ours
    chosen = {
        "ours": ours,
        "fewest misses": min(alone, key=lambda p: (p.missed, p.alarms)),
        "fewest false alarms": min(alone, key=lambda p: (p.alarms, p.missed)),
        "smallest sum": min(alone, key=lambda p: p.missed + p.alarms),
    }
    rows = [(name, f"{p.missed}", f"{p.alarms}", describe(p.threshold)) for name, p in chosen.items()]
    heads = (
        f"stereo alone, {len(alone)} thresholds over {comparison.flights} flights",
        f"missed, of {comparison.near_frames} frames",
        f"false alarm, of {comparison.frames}",
        "threshold",
    )
    legend = (
        f"{len(comparison.beating) or 'none'} of the thresholds with fewer misses and fewer false alarms "
        "than "
        f"ours, {len(comparison.equalling) or 'none'} with no more of either"
    )
    return Table("stereo-alone", heads, rows, legend, "Beside stereo alone")


def describe(threshold: Threshold | None) -> str:
    if threshold is None:
        return ""
    return (
        f"texture {threshold.texture}, uniqueness {threshold.uniqueness} %, SAD {threshold.sad:g}, "
        f"{threshold.pixels} px"
    )
