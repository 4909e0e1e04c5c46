"""Measure what each choice of the segmentation is worth on labelled scenes, beside a reference method.

usage: segmentation_variants.py DIR [--only NAME ...] [--out FILE.json]

DIR holds scenes of `vista scenes`. For each variant, on the development and on the test scenes, the table has
the IoU of the things (median, mean), the share of them with an IoU above 0.5, the recall of their boundaries
within 3 px, the under-segmentation and the number of regions, and the median processor time of the host.
vista_eval.metrics.segmentation defines them. --out also writes the figures, for
`scripts/make_tables.py --save segmentation=FILE.json`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from vista import parameters
from vista.engine import Disparity, Engine, EngineParameters, Image
from vista_eval.dataset.scenes import LabelledScene, read_scenes
from vista_eval.dataset.truth import SPLITS
from vista_eval.jobs import Job, add_place, chosen_place, exit_on_failure, jobs_of, run
from vista_eval.metrics.scenes import Partition, partition_scenes, score_cells, score_cut, score_scene
from vista_eval.metrics.segmentation import STATED, STATISTICS, PartitionScore, stated
from vista_eval.report.table import Table, fixed, write_measurement


@dataclass(frozen=True)
class Around:
    """An engine with a step before and one after it."""

    engine: Engine
    before: Callable[[Image], Image] = lambda image: image
    after: Callable[[Disparity], Disparity] = lambda words: words

    @property
    def parameters(self) -> EngineParameters:
        return self.engine.parameters

    def check_size(self, width_px: int, height_px: int) -> None:
        self.engine.check_size(width_px, height_px)

    def compute(self, left: Image, right: Image) -> Disparity:
        return next(self.levels(left, right))

    def levels(self, left: Image, right: Image) -> Iterator[Disparity]:
        return map(self.after, self.engine.levels(self.before(left), self.before(right)))


def smoothed(engine: Engine) -> Engine:
    def before(image: Image) -> Image:
        return cv2.GaussianBlur(image, (0, 0), 1.2).astype(np.uint8, copy=False)

    return Around(engine, before=before)


def eroded(engine: Engine) -> Engine:
    """The smallest valid word in 7x7 pixels: as unsigned numbers, invalid words exceed all others."""

    def after(words: Disparity) -> Disparity:
        smallest = cv2.erode(words.view(np.uint16), np.ones((7, 7), np.uint8))
        return np.where(words < 0, words, smallest.view(np.int16))

    return Around(engine, after=after)


def without_speckles(engine: Engine) -> Engine:
    def after(words: Disparity) -> Disparity:
        words = words.copy()
        cv2.filterSpeckles(words, -16, 30, 16)
        return words

    return Around(engine, after=after)


@dataclass(frozen=True)
class Variant:
    changes: dict[str, dict[str, object]] = field(default_factory=dict)
    around_engine: Callable[[Engine], Engine] = lambda engine: engine
    score: Callable[[LabelledScene, Partition], PartitionScore] = score_cut


def segmentation(**changes: object) -> Variant:
    return Variant({"segmentation": changes})


def affinity(**changes: object) -> Variant:
    return Variant({"affinity": changes})


def sectors(count: int) -> Variant:
    return Variant({"foveation": {"sector_count": count}})


VARIANTS = {
    "as shipped": Variant(),
    "regions as cells draw them: no refinement": Variant(score=score_cells),
    "seeds alone: no cut": segmentation(reach=1),
    "no relief in affinities": affinity(mu_depth_m=0.0),
    "horizontal cells free": segmentation(horizontal_link=0.0),
    "horizontal cells barred": segmentation(horizontal_link=2.0),
    "equation 3 as printed: sum of terms": affinity(form="sum"),
    "equation 5 as printed: linear flow": affinity(flow_encoding="linear"),
    "sum and linear": affinity(form="sum", flow_encoding="linear"),
    "companion's sigma 30, mu 2": affinity(form="sum", sigma_intensity=30.0, sigma_disparity_px=30.0),
    "sigma_I 7": affinity(sigma_intensity=7.0),
    "sigma_I 15": affinity(sigma_intensity=15.0),
    "96 sectors": sectors(96),
    "160 sectors": sectors(160),
    "192 sectors": sectors(192),
    "block 7": Variant({"stereo": {"block_size": 7}}),
    "uniqueness 25 %": Variant({"stereo": {"uniqueness_ratio": 25}}),
    "images smoothed before matching, sigma 1.2 px": Variant(around_engine=smoothed),
    "disparities eroded, 7x7": Variant(around_engine=eroded),
    "speckles of 30 px removed": Variant(around_engine=without_speckles),
}


def figures(scores: list[PartitionScore]) -> dict[str, float]:
    return {key: round(float(STATISTICS[key](scores)), 3) for key in STATED}


def measure(variant: Variant, scenes: list[LabelledScene]) -> tuple[list[PartitionScore], float]:
    values = parameters.defaults()
    for section, content in variant.changes.items():
        values[section] |= content
    scores, host_ms = [], []
    for scene, partition in partition_scenes(scenes, values, variant.around_engine):
        scores.append(variant.score(scene, partition))
        host_ms.append(partition.host_ms)
    return scores, float(np.median(host_ms))


def measured_row(folder: Path, name: str) -> dict[str, Any]:
    measured = {split: measure(VARIANTS[name], read_scenes(folder, split)) for split in SPLITS}
    row = {split: figures(scores) for split, (scores, _) in measured.items()}
    return {"variant": name, **row, "host_ms": round(measured[SPLITS[0]][1], 1)}


def baseline_rows(folder: Path) -> list[dict[str, Any]]:
    """Rows of the reference methods and of the grid's own limit."""
    found: dict[str, dict[str, Any]] = {}
    for split in SPLITS:
        scenes = read_scenes(folder, split)
        scored = [score_scene(*pair) for pair in partition_scenes(scenes, parameters.defaults())]
        for name in list(scored[0])[1:]:
            found.setdefault(name, {})[split] = figures([scores[name] for scores in scored])
    return [{"variant": name, **row, "host_ms": None} for name, row in found.items()]


def table_of(rows: list[dict[str, Any]], split: str) -> Table:
    cells = [
        (row["variant"], *(stated(key, row[split][key]) for key in STATED), fixed(row["host_ms"], 1))
        for row in rows
    ]
    return Table(f"segmentation-{split}", ("variant", *STATED.values(), "host ms"), cells)


def counts_of(folder: Path) -> dict[str, dict[str, int]]:
    halves = {split: read_scenes(folder, split) for split in SPLITS}
    return {
        split: {"scenes": len(scenes), "things": sum(len(scene.view.things) for scene in scenes)}
        for split, scenes in halves.items()
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder that `vista scenes` has filled")
    parser.add_argument("--only", nargs="+", choices=VARIANTS, default=list(VARIANTS), metavar="NAME")
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="also write the figures")
    add_place(parser)
    arguments = parser.parse_args()
    jobs = [
        *jobs_of(partial(measured_row, arguments.folder), arguments.only),
        Job("baselines", partial(baseline_rows, arguments.folder)),
    ]
    with exit_on_failure():
        *rows, baselines = run(jobs, chosen_place(arguments), "measure", "variant")
    rows += baselines
    tables = [table_of(rows, split) for split in SPLITS]
    for split, table in zip(SPLITS, tables, strict=True):
        print(f"{split}:\n{table.as_text()}\n")
    if arguments.out is not None:
        write_measurement(arguments.out, tables, {"scenes": counts_of(arguments.folder), "variants": rows})


if __name__ == "__main__":
    main()
