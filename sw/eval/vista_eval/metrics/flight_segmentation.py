"""Scores the segmentation of a flight's frames against its labels, beside the reference methods and the
forest.

Scores of one frame are those of vista_eval.metrics.segmentation; frames of a flight are not independent, so
intervals are over flights.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from vista import parameters

from vista_eval.cache import code_digest, digest_of, kept
from vista_eval.dataset.scenes import read_scene
from vista_eval.dataset.truth import SPLITS, TRUTH, read_truth
from vista_eval.fly import flight_digest
from vista_eval.metrics.intervals import MIN_FLIGHTS
from vista_eval.metrics.scenes import CUT, REFERENCES, partition_scenes, score_cut, score_scene
from vista_eval.metrics.segmentation import (
    BOUNDARY_PX,
    FAR_M,
    NEAR_M,
    STATISTICS,
    PartitionScore,
    Thing,
    ThingScore,
    difference_interval,
)
from vista_eval.report.table import Table
from vista_eval.rivals import FOREST, with_forest

STRIDE = 8  # frames
COMPARED = (*REFERENCES, FOREST)  # with the cut
SHOWN = {"iou_median": "IoU median", "boundary_recall_cell": "boundary recall"}


@dataclass(frozen=True)
class FlightSegmentation:
    name: str
    split: str
    frames: int
    scores: dict[str, PartitionScore]  # by partition: the things of all frames together


def segment_cached(folder: Path, values: parameters.Values, cache: Path) -> FlightSegmentation:
    digest = digest_of(
        flight_digest(folder, values),
        code_digest(__name__),
        folder / TRUTH,
    )
    return kept(cache, digest, lambda: segment_flight(folder, values), _segmentation)


def segment_flight(folder: Path, values: parameters.Values) -> FlightSegmentation:
    """Every STRIDE-th frame, each by itself."""
    truth = read_truth(folder)
    scenes = [read_scene(folder, k) for k in range(0, len(truth.times_ns), STRIDE)]
    scored = [score_scene(scene, partition) for scene, partition in partition_scenes(scenes, values)]
    pooled = {name: pool([one[name] for one in scored]) for name in (CUT, *REFERENCES)}
    grown = partition_scenes(scenes, with_forest(values))
    pooled[FOREST] = pool([score_cut(scene, partition) for scene, partition in grown])
    return FlightSegmentation(truth.name, truth.split, len(scenes), pooled)


def pool(scores: list[PartitionScore]) -> PartitionScore:
    return PartitionScore(
        tuple(thing for score in scores for thing in score.things),
        float(np.mean([score.undersegmentation for score in scores])),
        int(np.median([score.regions for score in scores])),
    )


def _segmentation(content: dict[str, Any]) -> FlightSegmentation:
    scores = {
        name: PartitionScore(
            tuple(ThingScore(**thing | {"thing": Thing(**thing["thing"])}) for thing in score["things"]),
            score["undersegmentation"],
            score["regions"],
        )
        for name, score in content["scores"].items()
    }
    return FlightSegmentation(**content | {"scores": scores})


@dataclass(frozen=True)
class SegmentationRow:
    name: str
    things: int
    values: tuple[tuple[float, ...], ...]  # of each statistic of SHOWN: cut, reference methods
    intervals: tuple[tuple[tuple[float, float], ...], ...] = ()  # of a group: 95 % of cut - reference


def rows(flights: list[FlightSegmentation]) -> list[SegmentationRow]:
    """A flight each, and after those of a group the group."""
    found = []
    for split in SPLITS:
        members = [flight for flight in flights if flight.split == split]
        found += [_row(flight.name, [flight]) for flight in members]
        if members:
            found.append(_row(f"= {split}", members, group=True))
    return found


def _row(name: str, flights: list[FlightSegmentation], group: bool = False) -> SegmentationRow:
    by_partition = {
        partition: [flight.scores[partition] for flight in flights] for partition in (CUT, *COMPARED)
    }
    things = sum(len(score.things) for score in by_partition[CUT])
    values = tuple(tuple(STATISTICS[key](scores) for scores in by_partition.values()) for key in SHOWN)
    if not group or len(flights) < MIN_FLIGHTS:
        return SegmentationRow(name, things, values)
    intervals = tuple(
        tuple(
            difference_interval(by_partition[CUT], by_partition[reference], STATISTICS[key])
            for reference in COMPARED
        )
        for key in SHOWN
    )
    return SegmentationRow(name, things, values, intervals)


def heads() -> list[str]:
    return [
        "things",
        *(f"{statistic}, {partition}" for statistic in SHOWN.values() for partition in (CUT, *COMPARED)),
    ]


def cells(row: SegmentationRow) -> list[str]:
    if not row.things:
        return ["0", *[""] * (len(heads()) - 1)]
    return [str(row.things), *(f"{value:.2f}" for values in row.values for value in values)]


def interval_text(row: SegmentationRow) -> str:
    return "; ".join(
        f"{statistic}, cut - {reference}: {low:+.2f} to {high:+.2f}"
        for statistic, pairs in zip(SHOWN.values(), row.intervals, strict=True)
        for reference, (low, high) in zip(COMPARED, pairs, strict=True)
    )


def table(flights: list[FlightSegmentation]) -> Table:
    lines: list[tuple[str, ...]] = []
    for row in rows(flights):
        lines.append((row.name, *cells(row)))
        if row.intervals:
            lines.append((f"  95 % over flights: {interval_text(row)}",))
    legend = (
        f"Frames {STRIDE} apart, each by itself; standing things at {NEAR_M:g} to {FAR_M:g} m. "
        f"Boundary recall within {BOUNDARY_PX:g} px or one cell."
    )
    title = "Segmentation: the cut beside merging without a cut"
    return Table("segmentation", ("segmentation", *heads()), lines, legend, title)
