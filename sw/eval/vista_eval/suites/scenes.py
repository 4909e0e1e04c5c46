"""Labelled single scenes: the cut beside the reference methods without one."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.report.overlay import draw_disparity
from vista.report.palette import WHITE, distinct_colours

from vista_eval.dataset.scenes import LabelledScene, read_scene, scene_folders
from vista_eval.dataset.truth import SPLITS
from vista_eval.jobs import Job, jobs_of
from vista_eval.metrics.scenes import (
    CUT,
    REFERENCES,
    Partition,
    partition_scenes,
    reference_regions,
    score_scene,
)
from vista_eval.metrics.segmentation import (
    STATED,
    STATISTICS,
    LabelledView,
    PartitionScore,
    difference_interval,
    stated,
)
from vista_eval.report.page import Page, Picture, Section, as_jpeg
from vista_eval.report.table import Table, span
from vista_eval.score import Scoring

SHOWN = 6  # scenes at either end
HEADINGS = {
    "iou_median": "IoU median",
    "iou_mean": "IoU mean",
    "found": "IoU > 0.5",
    "boundary_recall": "boundary 3 px",
    "boundary_recall_cell": "boundary 1 cell",
    "undersegmentation": "leak",
    "regions": "regions",
}
Row = dict[str, float]


@dataclass(frozen=True)
class SceneScore:
    folder: Path
    split: str
    host_ms: float
    scores: dict[str, PartitionScore]  # by partition: cut, reference methods, grid limit

    @property
    def name(self) -> str:
        return self.folder.name

    @property
    def mean_iou(self) -> float:
        """Mean over the things of the cut; a scene without a thing to find comes last."""
        ious = [thing.iou for thing in self.scores[CUT].things]
        return float(np.mean(ious)) if ious else float("inf")


def score_folder(values: parameters.Values, folder: Path) -> SceneScore:
    scene = read_scene(folder)
    ((_, partition),) = partition_scenes([scene], values)
    return SceneScore(folder, scene.split, partition.host_ms, score_scene(scene, partition))


@dataclass(frozen=True)
class Scenes:
    folder: Path
    name: str = "scenes"
    page_name: str = "scenes.html"

    def jobs(self, values: parameters.Values) -> list[Job]:
        return jobs_of(partial(score_folder, values), scene_folders(self.folder), lambda path: path.name)

    def scoring(self, results: list[SceneScore], values: parameters.Values) -> Scoring:
        halves = by_half(results)
        found = {
            split: {"statistics": half.statistics, "cut_minus_reference_95": half.intervals}
            for split, half in halves.items()
        }
        host_ms = float(np.median([one.host_ms for one in results]))
        shown = table(halves)
        page = Page(
            f"{len(results)} labelled scenes: cut against reference method",
            "Even seeds are the group dev, on which parameters may be chosen; odd seeds are the group test.",
            [Section("Scores", [shown]), worst_and_best(results, values)],
            parameters=values,
            wide=True,
        )
        content = {
            "version": 1,
            "host_ms_median": round(host_ms, 2),
            "halves": found,
            "scenes": [as_json(one) for one in results],
            "references": {name: asdict(reference) for name, reference in REFERENCES.items()},
            "parameters": values,
        }
        kept = [documented(halves["test"])] if "test" in halves else []
        return Scoring([shown], page, content, kept, found, remark=f"host {host_ms:.1f} ms; ")


def statistics(scored: list[SceneScore]) -> dict[str, Row]:
    """Partition -> statistic -> value."""
    return {
        name: {key: value([s.scores[name] for s in scored]) for key, value in STATISTICS.items()}
        for name in scored[0].scores
    }


def intervals(scored: list[SceneScore]) -> dict[str, dict[str, tuple[float, float]]]:
    """Reference method -> statistic -> 95 % interval of cut - reference."""
    cut = [s.scores[CUT] for s in scored]
    return {
        name: {
            key: difference_interval(cut, [s.scores[name] for s in scored], value)
            for key, value in STATISTICS.items()
        }
        for name in REFERENCES
    }


@dataclass(frozen=True)
class Half:
    """What one split's scenes say together."""

    scenes: int
    things: int
    statistics: dict[str, Row]
    intervals: dict[str, dict[str, tuple[float, float]]]


def by_half(scored: list[SceneScore]) -> dict[str, Half]:
    """Split -> its scenes together, of each split that has any."""
    found = {}
    for split in SPLITS:
        if half := [s for s in scored if s.split == split]:
            things = sum(len(s.scores[CUT].things) for s in half)
            found[split] = Half(len(half), things, statistics(half), intervals(half))
    return found


def table(summary: dict[str, Half]) -> Table:
    rows: list[tuple[str, ...]] = []
    for split, half in summary.items():
        rows.append((f"{split}: {half.scenes} scenes, {half.things} things",))
        rows += [
            (name, *(stated(key, row[key]) for key in HEADINGS)) for name, row in half.statistics.items()
        ]
        for name, ends in half.intervals.items():
            cells = (" .. ".join(stated(key, end) for end in ends[key]) for key in HEADINGS)
            rows.append((f"cut - {name}, 95 %", *cells))
    return Table("scores", ("", *HEADINGS.values()), rows)


def documented(half: Half) -> Table:
    """What the documentation has of the half that nothing was chosen on."""
    rows = [
        (name, *(span([round(end, 2) + 0.0 for end in ends[key]]) for key in STATED))
        for name, ends in half.intervals.items()
    ]
    return Table("scenes", ("cut minus", *STATED.values()), rows)


def as_json(scored: SceneScore) -> dict[str, Any]:
    partitions = {
        name: {
            "regions": score.regions,
            "undersegmentation": score.undersegmentation,
            "things": [asdict(thing) for thing in score.things],
        }
        for name, score in scored.scores.items()
    }
    return {"name": scored.name, "split": scored.split, "partitions": partitions}


# ---- pictures ----

Pixels = NDArray[np.uint8]


def draw_scene(scene: LabelledScene, partition: Partition) -> Pixels:
    """Truth, disparity, cut and reference method; the outlines of the things that are scored in white."""
    result = partition.result
    truth = np.zeros(scene.left.shape, np.int32)
    truth[scene.view.area] = scene.view.label
    reference = reference_regions(partition, REFERENCES["reference method"])
    tiles = [
        draw_labels(scene.left, truth - 1, scene.view),
        draw_disparity(partition.result.words, 64),
        draw_labels(scene.left, result.region_of_pixel, scene.view),
        draw_labels(scene.left, reference, scene.view),
    ]
    return np.vstack([np.hstack(tiles[:2]), np.hstack(tiles[2:])])


def draw_labels(left: NDArray[np.uint8], label: NDArray[np.int32], view: LabelledView) -> Pixels:
    colours = distinct_colours()
    tint = np.where(label[..., np.newaxis] >= 0, colours[label % len(colours)], 0)
    picture = (cv2.cvtColor(left, cv2.COLOR_GRAY2BGR) // 2 + tint // 2).astype(np.uint8)
    for boundary in view.boundaries:
        picture[view.area][boundary] = WHITE
    return picture


def worst_and_best(scored: list[SceneScore], values: parameters.Values) -> Section:
    ordered = sorted((s for s in scored if np.isfinite(s.mean_iou)), key=lambda s: s.mean_iou)
    pictures = []
    for one in ordered[:SHOWN] + ordered[max(len(ordered) - SHOWN, SHOWN) :]:
        scene = read_scene(one.folder)
        ((_, partition),) = partition_scenes([scene], values)
        things = (f"{t.thing.name} at {t.thing.range_m:.0f} m {t.iou:.2f}" for t in one.scores[CUT].things)
        caption = f"{one.name} ({one.split}): mean IoU {one.mean_iou:.2f}; {', '.join(things)}"
        pictures.append(Picture(caption, as_jpeg(draw_scene(scene, partition))))
    text = "Top: exact labels, disparity; bottom: cut, reference method. White: things that are scored."
    return Section("Worst first, then the best", text=text, pictures=pictures)
