"""What each choice of the segmentation is worth on labelled scenes, with the reference method.

usage: segmentation_variants.py DIR [--only NAME ...] [--readme]

DIR: scenes of `vista scenes`. Per variant, on the half that was tuned on and on the unseen half: IoU of the
things (median, mean), share of them with an IoU above 0.5, recall of their boundaries within 3 px, leak
(under-segmentation), regions; processor time of the host, median. vista_eval.metrics.segmentation defines
them.
--readme: the table replaces the one in sw/README.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from vista import parameters
from vista.engine import Disparity, Engine, EngineParameters, Image
from vista_eval.dataset.scenes import LabelledScene, read_scenes
from vista_eval.dataset.truth import SPLITS
from vista_eval.metrics.scenes import Partition, partition_scenes, score_cells, score_cut, score_scene
from vista_eval.metrics.segmentation import STATISTICS, PartitionScore
from vista_eval.report.scenes_page import number

README = Path(__file__).resolve().parents[1] / "README.md"
BEGIN = "<!-- written by sw/bench/segmentation_variants.py -->"
END = "<!-- end of the table -->"
COLUMNS = {
    "IoU median": "iou_median",
    "mean": "iou_mean",
    "> 0.5": "found",
    "boundary": "boundary_recall",
    "leak": "undersegmentation",
    "regions": "regions",
}


@dataclass(frozen=True)
class Around:
    """An engine with a step before and one after it."""

    engine: Engine
    before: Callable[[Image], Image] = lambda image: image
    after: Callable[[Disparity], Disparity] = lambda words: words

    @property
    def parameters(self) -> EngineParameters:
        return self.engine.parameters

    def compute(self, left: Image, right: Image) -> Disparity:
        return self.after(self.engine.compute(self.before(left), self.before(right)))


def smoothed(engine: Engine) -> Engine:
    return Around(engine, before=lambda image: cv2.GaussianBlur(image, (0, 0), 1.2))


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
    "seeds alone: no cut, no shell": segmentation(reach=1, shell_px=0.0),
    "no shell": segmentation(shell_px=0.0),
    "no bridges": segmentation(bridge_m=0.0),
    "no height above ground": Variant({"surface": {"ground_step_px": 0.0, "ground_step_m": 10.0}}),
    "no shell, bridges, height above ground": Variant(
        {
            "segmentation": {"shell_px": 0.0, "bridge_m": 0.0},
            "surface": {"ground_step_px": 0.0, "ground_step_m": 10.0},
        }
    ),
    "no merging": segmentation(merge_share=1.0, merge_ratio=0.0),
    "no relief": Variant({"affinity": {"mu_depth_m": 0.0}, "segmentation": {"seed_step_m": 0.0}}),
    "horizontal cells free": segmentation(horizontal_link=0.0),
    "horizontal cells barred": segmentation(horizontal_link=2.0),
    "equation 3 as printed: sum of terms": affinity(form="sum"),
    "equation 5 as printed: linear flow": affinity(flow_encoding="linear"),
    "sum and linear": affinity(form="sum", flow_encoding="linear"),
    "companion's sigma 30, mu 2": affinity(form="sum", sigma_intensity=30.0, sigma_disparity_px=30.0),
    "sigma_I 7": affinity(sigma_intensity=7.0),
    "sigma_I 15": affinity(sigma_intensity=15.0),
    "refinement, sigma 6": Variant({"refinement": {"sigma_intensity": 6.0}}),
    "refinement, compactness 2": Variant({"refinement": {"compactness": 2.0}}),
    "96 sectors": sectors(96),
    "160 sectors": sectors(160),
    "192 sectors": sectors(192),
    "block 7": Variant({"stereo": {"block_size": 7}}),
    "uniqueness 25 %": Variant({"stereo": {"uniqueness_ratio": 25}}),
    "images smoothed before matching, sigma 1.2 px": Variant(around_engine=smoothed),
    "disparities eroded, 7x7": Variant(around_engine=eroded),
    "speckles of 30 px removed": Variant(around_engine=without_speckles),
}


def cells(scores: list[PartitionScore]) -> str:
    return " | ".join(number(key, STATISTICS[key](scores)) for key in COLUMNS.values())


def measure(variant: Variant, scenes: list[LabelledScene]) -> tuple[list[PartitionScore], float]:
    values = parameters.defaults()
    for section, content in variant.changes.items():
        values[section] |= content
    scores, host_ms = [], []
    for scene, partition in partition_scenes(scenes, values, variant.around_engine):
        scores.append(variant.score(scene, partition))
        host_ms.append(partition.host_ms)
    return scores, float(np.median(host_ms))


def baselines(halves: dict[str, list[LabelledScene]]) -> list[str]:
    """Rows of the reference methods and of the grid's own limit."""
    rows: dict[str, list[str]] = {}
    for scenes in halves.values():
        scored = [score_scene(*pair).scores for pair in partition_scenes(scenes, parameters.defaults())]
        for name in list(scored[0])[1:]:
            rows.setdefault(name, []).append(cells([scores[name] for scores in scored]))
    return [f"| *{name}* | {' | '.join(halves_cells)} | |" for name, halves_cells in rows.items()]


def make_table(folder: Path, names: list[str]) -> list[str]:
    halves = {split: read_scenes(folder, split) for split in SPLITS}
    count = {
        split: (len(scenes), sum(len(s.view.things) for s in scenes)) for split, scenes in halves.items()
    }
    lines = [
        f"| variant | tuned on: {' | '.join(COLUMNS)} | unseen: {' | '.join(COLUMNS)} | host ms |",
        "|---|" + "---|" * (2 * len(COLUMNS) + 1),
    ]
    for name in names:
        (tuned, ms), (unseen, _) = (measure(VARIANTS[name], scenes) for scenes in halves.values())
        lines.append(f"| {name} | {cells(tuned)} | {cells(unseen)} | {ms:.1f} |")
        print(lines[-1], file=sys.stderr, flush=True)
    sizes = "; ".join(
        f"{split}: {scenes} scenes, {things} things" for split, (scenes, things) in count.items()
    )
    return [*lines, *baselines(halves), "", f"({sizes})"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--only", nargs="+", choices=VARIANTS, default=list(VARIANTS), metavar="NAME")
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    text = "\n".join(make_table(arguments.folder, arguments.only))
    print(text)
    if arguments.readme:
        before, _, rest = README.read_text().partition(BEGIN)
        after = rest.partition(END)[2]
        README.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}")


if __name__ == "__main__":
    main()
