"""The tables of sampled flights by family, as text, and as cells for the report and the documentation."""

from __future__ import annotations

from vista_eval.metrics.comparison import describe
from vista_eval.metrics.flight_score import FIRST_DETECTION_M
from vista_eval.metrics.flight_segmentation import SHOWN
from vista_eval.metrics.free_directions import table as directions_table
from vista_eval.metrics.free_path import CLEAR_M, SEEN_M
from vista_eval.metrics.free_path import table as free_table
from vista_eval.metrics.group import nees, states
from vista_eval.metrics.intervals import Share
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.scenes import CUT, REFERENCES
from vista_eval.metrics.world_score import ControlScore, FamilyScore
from vista_eval.report.table import Table, fixed
from vista_eval.rivals import ALONE, ALONE_THRESHOLD, FOREST, OURS

REFERENCE = next(iter(REFERENCES))
FOREST_SIGN = "cut - forest"


def tables(families: list[FamilyScore]) -> list[Table]:
    made = [
        scores_table(families),
        free_table("family", [(family.name, family.controls[OURS].free) for family in families]),
        directions_table("family", [(family.name, family.controls[OURS].directions) for family in families]),
    ]
    if len(families[0].controls) > 1:
        made += [controls_table(families), controls_free_table(families)]
    if families[0].noisy:
        made.append(noise_table(families))
    if any(family.segmentation for family in families):
        made.append(segmentation_table(families))
    if any(family.stereo and family.stereo.thresholds > 1 for family in families):
        made.append(stereo_table(families))
    return made


def scores_table(families: list[FamilyScore]) -> Table:
    heads = (
        "family",
        "flights",
        "frames",
        "hits",
        "missed",
        "false",
        "flights with false",
        "within 2 dz",
        "med dz",
        "NEES",
        f"from {FIRST_DETECTION_M:.0f} m",
        "state",
    )
    rows = []
    for family in families:
        ours = family.controls[OURS]
        rows.append(
            (
                family.name,
                str(family.flights),
                str(ours.frames),
                share_text(ours.hits),
                str(ours.missed_frames),
                str(ours.alarm_frames),
                share_text(ours.alarm_flights),
                share_text(ours.within_2dz),
                fixed(ours.median_dz, 2),
                nees(ours.consistency),
                share_text(ours.first_far),
                states(ours.degraded_frames, ours.blind_frames),
            )
        )
    return Table(
        "scores",
        heads,
        rows,
        "In the columns are: hits: frames with a warning that is right, of those in which one is asked for; "
        "missed: frames without one, nearer ones included; false: frames with a false alarm; within 2 dz: "
        f"errors of at most 2 dz or {STRICT.least_tolerance_m:g} m; NEES: average, and the band of an honest "
        "covariance around 1 (what is judged by the point where it is met) or 3 (what has a centre); "
        f"from {FIRST_DETECTION_M:.0f} m: flights that warn from there or farther on, of those that begin "
        "there; state: frames that call themselves degraded + blind. In brackets what holds 95 %: over "
        "flights, by bootstrap; * the exact interval for the count of flights; fewer than three flights have "
        "none by bootstrap.",
        "By family",
    )


def controls_table(families: list[FamilyScore]) -> Table:
    controls = tuple(families[0].controls)
    rows = []
    for family in families:
        cells = [family.name]
        for control in controls:
            score = family.controls[control]
            cells.append(f"{hits_text(score)}, {score.missed_frames}, {score.alarm_frames}")
        if family.stereo is not None:
            hits, asked, missed, alarmed = family.stereo.alone
            cells.append(f"{f'{hits}/{asked}' if asked else '-'}, {missed}, {alarmed}")
        rows.append(tuple(cells))
    alone = () if families[0].stereo is None else (ALONE,)
    return Table(
        "controls",
        ("family", *controls, *alone),
        rows,
        "In the columns are: hits of the frames in which one is asked for, frames missed, frames with a "
        "false alarm. Stereo alone, with the host's tracker, is at one threshold "
        f"({describe(ALONE_THRESHOLD)}).",
        "Beside it, in the same host",
    )


def controls_free_table(families: list[FamilyScore]) -> Table:
    def cell(score: ControlScore) -> str:
        free = score.free
        return f"{free.clear_seen}/{free.clear}, {free.through}/{free.asked}"

    return Table(
        "controls-free",
        ("family", *families[0].controls),
        [(family.name, *map(cell, family.controls.values())) for family in families],
        f"In the columns are: frames that call {SEEN_M:g} m of the path seen, of those with nothing on it "
        f"for {CLEAR_M:g} m; frames that call it seen through something, of those that meet something.",
        "How far the path is free, beside it",
    )


def noise_table(families: list[FamilyScore]) -> Table:
    rows = [(family.name, *(noise_cell(score) for score in family.noisy.values())) for family in families]
    return Table(
        "noise",
        ("family", *(f"{grey:g} grey levels" for grey in families[0].noisy)),
        rows,
        "In the columns are: hits of the frames in which one is asked for, frames with a false alarm, frames "
        "that call themselves degraded + blind.",
        "With sensor noise added",
    )


def noise_cell(score: ControlScore) -> str:
    state = states(score.degraded_frames, score.blind_frames) or "0"
    return f"{hits_text(score)}, {score.alarm_frames}, {state}"


def hits_text(score: ControlScore) -> str:
    return f"{score.hits.part}/{score.hits.whole}" if score.hits else "-"


def segmentation_table(families: list[FamilyScore]) -> Table:
    heads = ["family", "things"]
    for statistic in SHOWN.values():
        heads += [f"{statistic}, cut", "forest", "reference", FOREST_SIGN]
    rows = []
    for family in families:
        scored = family.segmentation
        if scored is None:
            continue
        cells = [family.name, str(scored.things)]
        for key in SHOWN:
            value = scored.values[key]
            cells += [
                f"{value[CUT]:.2f}{between(scored.interval.get(key))}",
                f"{value[FOREST]:.2f}",
                f"{value[REFERENCE]:.2f}",
                between(scored.against_forest.get(key), sign="+").strip() or "-",
            ]
        rows.append(tuple(cells))
    return Table(
        "segmentation",
        tuple(heads),
        rows,
        "In the columns are: every eighth frame, each by itself; in brackets what holds 95 % over flights, "
        "and of the difference over the same flights (bootstrap).",
        "Segmentation: the cut beside a forest grown from its own seeds",
    )


def stereo_table(families: list[FamilyScore]) -> Table:
    rows = []
    for family in families:
        stereo = family.stereo
        if stereo is None:
            continue
        best = "-"
        if stereo.best is not None:
            threshold, missed, alarmed = stereo.best
            best = f"{missed}, {alarmed} ({describe(threshold)})"
        rows.append(
            (
                family.name,
                f"{stereo.missed}, {stereo.alarmed}",
                f"{stereo.better} of {stereo.thresholds}",
                best,
            )
        )
    return Table(
        "stereo",
        (
            "family",
            "ours: missed, false",
            "thresholds with fewer misses",
            "fewest misses at no more false alarms",
        ),
        rows,
        "In the columns are: frames missed, frames with a false alarm; of the thresholds only those with no "
        "more false alarms.",
        "Stereo alone with the same M of N and static-world test",
    )


def share_text(share: Share | None) -> str:
    if share is None:
        return "-"
    counts = f"{share.part}/{share.whole}"
    if share.low is None or share.high is None:
        return counts
    return f"{counts} ({100.0 * share.low:.0f} to {100.0 * share.high:.0f} %{'*' if share.exact else ''})"


def between(interval: tuple[float, float] | None, sign: str = "") -> str:
    return "" if interval is None else f" ({interval[0]:{sign}.2f} to {interval[1]:{sign}.2f})"
