"""Totals of a group of flights, and the table of flights and groups."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vista_eval.dataset.truth import SPLITS
from vista_eval.metrics.consistency import Consistency, consistency
from vista_eval.metrics.flight_score import FlightScore
from vista_eval.metrics.rules import HIT_RANGE, NEAR
from vista_eval.report.table import Table, fixed


@dataclass(frozen=True)
class GroupScore:
    split: str
    flights: int
    frames: int
    band_frames: int
    hits: int
    worst_hit_rate: float | None  # of a flight with a target
    missed_frames: int
    false_alarm_frames: int
    false_alarm_obstacles: int
    ghost_frames: int
    matched_frames: int
    within_2dz: float | None
    median_dz: float | None
    id_switches: int
    consistency: Consistency | None
    blind_frames: int
    blind_reported: int
    degraded_frames: int
    unseeing_frames: int

    @property
    def hit_rate(self) -> float | None:
        return self.hits / self.band_frames if self.band_frames else None


def group_score(split: str, flights: list[FlightScore]) -> GroupScore:
    rates = [flight.hit_rate for flight in flights if flight.hit_rate is not None]
    in_dz = [error for flight in flights for error in flight.errors_dz]
    return GroupScore(
        split=split,
        flights=len(flights),
        frames=sum(len(flight.frames) for flight in flights),
        band_frames=sum(flight.band_frames for flight in flights),
        hits=sum(flight.hits for flight in flights),
        worst_hit_rate=min(rates, default=None),
        missed_frames=sum(len(flight.missed) for flight in flights),
        false_alarm_frames=sum(len(flight.false_alarm_frames) for flight in flights),
        false_alarm_obstacles=sum(flight.false_alarm_obstacles for flight in flights),
        ghost_frames=sum(flight.ghost_frames for flight in flights),
        matched_frames=sum(flight.matched_frames for flight in flights),
        within_2dz=float(np.mean(np.array(in_dz) <= 2.0)) if in_dz else None,
        median_dz=float(np.median(in_dz)) if in_dz else None,
        id_switches=sum(flight.id_switches for flight in flights),
        consistency=consistency([(flight.nees, flight.nees_dimensions) for flight in flights]),
        blind_frames=sum(flight.blind_frames for flight in flights),
        blind_reported=sum(flight.blind_reported for flight in flights),
        degraded_frames=sum(flight.degraded_frames for flight in flights),
        unseeing_frames=sum(flight.unseeing_frames for flight in flights),
    )


# Column head and what stands in it, of a flight.
COLUMNS = (
    ("tracked from, m", lambda s: fixed(s.tracked_from_m, 1)),
    ("warned from, m", lambda s: fixed(s.first_detection_m, 1)),
    ("hits", lambda s: share(s.hits, s.band_frames)),
    ("missed", lambda s: str(len(s.missed)) if any(f.range_m is not None for f in s.frames) else ""),
    ("false", lambda s: counts(len(s.false_alarm_frames), s.false_alarm_obstacles)),
    ("2dz %", lambda s: percent(s.within_2dz)),
    ("med dz", lambda s: fixed(s.median_dz, 2)),
    ("RMS ft", lambda s: beside(s.rms_ft, s.companion_rms_ft)),
    ("50ft ft", lambda s: fixed(s.error_at_50_ft, 1)),
    ("ids", lambda s: str(s.id_switches) if s.matched_frames else ""),
    ("NEES", lambda s: nees(s.consistency)),
    ("blind", lambda s: share(s.blind_reported, s.blind_frames)),
    ("state", lambda s: states(s.degraded_frames, s.unseeing_frames)),
    ("host ms", lambda s: fixed(s.host_ms, 1)),
)
LEGEND = (
    "tracked, warned from: range of the target in the first frame that has it as an obstacle, as a warning, "
    f"and stays; hits: frames at {HIT_RANGE} with a warning for the target; missed: frames {NEAR} "
    "without one; false: frames with a false alarm (obstacles); RMS beside the companion paper's; "
    "NEES: average, its 95 % band; blind: frames nearer than the engine matches that are still warned of; "
    "state: frames in which the detector calls itself degraded + blind"
)


def table(flights: list[FlightScore], title: str = "Scores", legend: str = LEGEND) -> Table:
    """A row for each flight, by group; below each group its totals."""
    rows: list[tuple[str, ...]] = []
    for split in SPLITS:
        members = [flight for flight in flights if flight.split == split]
        rows += [(flight.name, *(cell(flight) for _, cell in COLUMNS)) for flight in members]
        if members:
            rows.append((group_line(group_score(split, members)),))
    return Table("scores", ("flight", *(head for head, _ in COLUMNS)), rows, legend, title)


def group_line(group: GroupScore) -> str:
    return (
        f"= {group.split}: {group.flights} flights, {group.frames} frames; "
        f"hits {share(group.hits, group.band_frames) or 'none asked for'} (worst flight "
        f"{percent(group.worst_hit_rate) or '-'} %), missed {group.missed_frames}, false alarms "
        f"{group.false_alarm_frames} frames of {group.false_alarm_obstacles} obstacles "
        f"({group.ghost_frames} with nothing there), within 2 dz {percent(group.within_2dz) or '-'} %, "
        f"median {fixed(group.median_dz, 2) or '-'} dz, id switches {group.id_switches}, "
        f"NEES {nees(group.consistency) or '-'}, "
        f"blind {share(group.blind_reported, group.blind_frames) or '-'}, "
        f"calls itself degraded + blind in {states(group.degraded_frames, group.unseeing_frames) or 'no'} "
        "frames"
    )


def beside(value: float | None, other: float | None) -> str:
    return fixed(value, 1) + ("" if other is None else f"/{other}")


def percent(value: float | None) -> str:
    return "" if value is None else f"{100.0 * value:.0f}"


def share(part: int, whole: int) -> str:
    return f"{part}/{whole}" if whole else ""


def counts(frames: int, obstacles: int) -> str:
    return f"{frames} ({obstacles})" if frames else "0"


def states(degraded: int, blind: int) -> str:
    return f"{degraded} + {blind}" if degraded or blind else ""


def nees(value: Consistency | None) -> str:
    return "" if value is None else f"{value.average:.1f} [{value.low:.1f} {value.high:.1f}]"
