"""Figures of families of flights: the totals of each, and a table."""

from __future__ import annotations

from typing import Any

from vista_eval.metrics.flight_score import FlightScore, summary
from vista_eval.metrics.group import GroupScore, group_score, nees, number, percent, share
from vista_eval.report.text_table import aligned

COLUMNS = (
    ("flights", lambda g: str(g.flights)),
    ("frames", lambda g: str(g.frames)),
    ("hits", lambda g: share(g.hits, g.band_frames)),
    ("worst %", lambda g: percent(g.worst_hit_rate)),
    ("missed", lambda g: str(g.missed_frames)),
    ("false", lambda g: str(g.false_alarm_frames)),
    ("2dz %", lambda g: percent(g.within_2dz)),
    ("med dz", lambda g: number(g.median_dz, 2)),
    ("NEES", lambda g: nees(g.consistency)),
    ("degraded", lambda g: str(g.degraded_frames)),
    ("blind", lambda g: str(g.unseeing_frames)),
)


def totals(flights: list[FlightScore]) -> GroupScore:
    return group_score(flights[0].split, flights)


def family_table(by_family: dict[str, list[FlightScore]]) -> str:
    """Text, one line a family, the whole below."""
    groups = {name: totals(flights) for name, flights in by_family.items()}
    groups["all"] = totals([flight for flights in by_family.values() for flight in flights])
    rows = [("family", *(head for head, _ in COLUMNS))]
    rows += [(name, *(cell(group) for _, cell in COLUMNS)) for name, group in groups.items()]
    return aligned(rows, {})


def family_figures(flights: list[FlightScore]) -> dict[str, Any]:
    """What the log of scorings keeps of a family."""
    group = totals(flights)
    return {
        "flights": group.flights,
        "frames": group.frames,
        "band_frames": group.band_frames,
        "hits": group.hits,
        "missed_frames": group.missed_frames,
        "false_alarm_frames": group.false_alarm_frames,
        "within_2dz": group.within_2dz,
        "nees": None if group.consistency is None else group.consistency.average,
        "degraded_frames": group.degraded_frames,
        "unseeing_frames": group.unseeing_frames,
    }


def figures_of_families(by_family: dict[str, list[FlightScore]]) -> dict[str, Any]:
    return {
        name: family_figures(flights) | {"each": [summary(flight) for flight in flights]}
        for name, flights in by_family.items()
    }
