"""What the documentation has of the paper's flights: a table a group, and one of sensor noise."""

from __future__ import annotations

from vista_eval.dataset.truth import SPLITS
from vista_eval.metrics.consistency import Consistency
from vista_eval.metrics.flight_score import FlightScore
from vista_eval.metrics.group import group_score
from vista_eval.metrics.rules import HIT_RANGE
from vista_eval.report.table import Table, fixed

HEADS = (
    "flight",
    "tracked from, m",
    "warned from, m",
    f"hits, {HIT_RANGE}",
    "frames with a false alarm",
    "median error, dz",
    "RMS, ft (companion paper)",
    "error at 50 ft, ft",
    "NEES (95 % band)",
)


def stated(scores: list[FlightScore], sensed: dict[float, list[FlightScore]]) -> list[Table]:
    """sensed: the same flights under sensor noise, by its grey levels."""
    tables = []
    for split in SPLITS:
        members = [score for score in scores if score.split == split]
        if members:
            tables.append(flights_table(split, members))
    return [*tables, noise_table({0.0: scores} | sensed)] if sensed else tables


def flights_table(split: str, flights: list[FlightScore]) -> Table:
    group = group_score(split, flights)
    totals = [""] * len(HEADS)
    totals[0] = f"**{group.flights} flights, {group.frames} frames**"
    totals[3:6] = [
        f"**{group.hits}/{group.band_frames}**",
        f"**{group.false_alarm_frames}**",
        f"**{fixed(group.median_dz, 2)}**",
    ]
    totals[8] = nees(group.consistency)
    within = f"{100 * (group.within_2dz or 0.0):.0f} % of the {group.matched_frames} frames"
    return Table(
        f"flights-{split}",
        HEADS,
        [*map(row, flights), tuple(totals)],
        f"The position is within 2 dz in {within} with a warning of the target.",
    )


def row(score: FlightScore) -> tuple[str, ...]:
    companion = "" if score.companion_rms_ft is None else f" ({score.companion_rms_ft})"
    return (
        score.title,
        fixed(score.tracked_from_m, 1),
        fixed(score.first_detection_m, 1),
        f"{score.hits}/{score.band_frames}" if score.band_frames else "",
        str(len(score.false_alarm_frames)),
        fixed(score.median_dz, 2),
        fixed(score.rms_ft, 1) + companion,
        fixed(score.error_at_50_ft, 1),
        nees(score.consistency),
    )


def noise_table(sensed: dict[float, list[FlightScore]]) -> Table:
    rows = []
    for grey, scores in sensed.items():
        cells = [f"{grey:.0f}"]
        for split in reversed(SPLITS):
            group = group_score(split, [score for score in scores if score.split == split])
            state = f"{group.degraded_frames} + {group.unseeing_frames} of {group.frames}"
            cells += [f"{group.hits}/{group.band_frames}", str(group.false_alarm_frames), state]
        rows.append(tuple(cells))
    columns = (
        f"{split}: {what}" for split in reversed(SPLITS) for what in ("hits", "false", "degraded + blind")
    )
    return Table("flights-noise", ("grey levels", *columns), rows)


def nees(found: Consistency | None) -> str:
    return "" if found is None else f"{found.average:.1f} ({found.low:.1f} to {found.high:.1f})"
