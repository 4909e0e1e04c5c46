"""The scores of labelled scenes as a table, as scenes.json, and as a page with the worst and the best."""

from __future__ import annotations

import base64
from dataclasses import asdict, dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.report.overlay import draw_disparity
from vista.report.page import fill_template
from vista.report.palette import WHITE, distinct_colours

from vista_eval.dataset.truth import SPLITS
from vista_eval.metrics.scenes import CUT, REFERENCES, ScoredScene, reference_regions
from vista_eval.metrics.segmentation import STATED, STATISTICS, LabelledView, difference_interval
from vista_eval.report.table import Table, span

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


def statistics(scored: list[ScoredScene]) -> dict[str, Row]:
    """Partition -> statistic -> value."""
    return {
        name: {key: value([s.scores[name] for s in scored]) for key, value in STATISTICS.items()}
        for name in scored[0].scores
    }


def intervals(scored: list[ScoredScene]) -> dict[str, dict[str, tuple[float, float]]]:
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


def halves(scored: list[ScoredScene]) -> dict[str, Half]:
    """Split -> its scenes together, of each split that has any."""
    found = {}
    for split in SPLITS:
        if half := [s for s in scored if s.scene.split == split]:
            things = sum(len(s.scores[CUT].things) for s in half)
            found[split] = Half(len(half), things, statistics(half), intervals(half))
    return found


def table(summary: dict[str, Half]) -> list[str]:
    """Markdown."""
    lines = ["| | " + " | ".join(HEADINGS.values()) + " |", "|---|" + "---|" * len(HEADINGS)]
    for split, half in summary.items():
        lines.append(f"| *{split}*: {half.scenes} scenes, {half.things} things |" + " |" * len(HEADINGS))
        for name, row in half.statistics.items():
            lines.append(f"| {name} | " + " | ".join(number(key, row[key]) for key in HEADINGS) + " |")
        for name, ends in half.intervals.items():
            cells = (f"{number(key, ends[key][0])} .. {number(key, ends[key][1])}" for key in HEADINGS)
            lines.append(f"| cut - {name}, 95 % | " + " | ".join(cells) + " |")
    return lines


def number(key: str, value: float) -> str:
    return f"{value:.0f}" if key == "regions" else f"{value:.3f}"


def stated(half: Half) -> Table:
    """What the documentation has of the half that nothing was chosen on."""
    rows = [
        (name, *(span([round(end, 2) + 0.0 for end in ends[key]]) for key in STATED))
        for name, ends in half.intervals.items()
    ]
    return Table("scenes", ("cut minus", *STATED.values()), rows)


def as_json(
    scored: list[ScoredScene], summary: dict[str, Half], values: dict[str, Any], host_ms: float
) -> dict[str, Any]:
    return {
        "version": 1,
        "host_ms_median": round(host_ms, 2),
        "halves": {
            split: {"statistics": half.statistics, "cut_minus_reference_95": half.intervals}
            for split, half in summary.items()
        },
        "scenes": [
            {
                "name": s.scene.name,
                "split": s.scene.split,
                "partitions": {
                    name: {
                        "regions": score.regions,
                        "undersegmentation": score.undersegmentation,
                        "things": [asdict(thing) for thing in score.things],
                    }
                    for name, score in s.scores.items()
                },
            }
            for s in scored
        ],
        "references": {name: asdict(reference) for name, reference in REFERENCES.items()},
        "parameters": values,
    }


# ---- pictures ----

Picture = NDArray[np.uint8]


def draw_scene(scored: ScoredScene) -> Picture:
    """Truth, disparity, cut and reference method; the outlines of the things that are scored in white."""
    scene, result = scored.scene, scored.partition.result
    truth = np.zeros(scene.left.shape, np.int32)
    truth[scene.view.area] = scene.view.label
    reference = reference_regions(scored.partition, REFERENCES["reference method"])
    tiles = [
        draw_labels(scene.left, truth - 1, scene.view),
        draw_disparity(scored.partition.result.words, 64),
        draw_labels(scene.left, result.region_of_pixel, scene.view),
        draw_labels(scene.left, reference, scene.view),
    ]
    return np.vstack([np.hstack(tiles[:2]), np.hstack(tiles[2:])])


def draw_labels(left: NDArray[np.uint8], label: NDArray[np.int32], view: LabelledView) -> Picture:
    colours = distinct_colours()
    tint = np.where(label[..., np.newaxis] >= 0, colours[label % len(colours)], 0)
    picture = (cv2.cvtColor(left, cv2.COLOR_GRAY2BGR) // 2 + tint // 2).astype(np.uint8)
    for boundary in view.boundaries:
        picture[view.area][boundary] = WHITE
    return picture


def render_page(scored: list[ScoredScene], lines: list[str]) -> str:
    ordered = sorted((s for s in scored if np.isfinite(s.mean_iou())), key=ScoredScene.mean_iou)
    chosen = ordered[:SHOWN] + ordered[max(len(ordered) - SHOWN, SHOWN) :]
    pictures = []
    for s in chosen:
        ok, jpeg = cv2.imencode(".jpg", draw_scene(s), [cv2.IMWRITE_JPEG_QUALITY, 75])
        assert ok
        things = ", ".join(
            f"{t.thing.name} at {t.thing.range_m:.0f} m {t.iou:.2f}" for t in s.scores[CUT].things
        )
        pictures.append(
            {
                "title": f"{s.scene.name} ({s.scene.split}): mean IoU {s.mean_iou():.2f}",
                "things": things,
                "uri": "data:image/jpeg;base64," + base64.b64encode(jpeg.tobytes()).decode(),
            }
        )
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return fill_template(
        "scenes.html.j2",
        package="vista_eval.report",
        heading=rows[0],
        rows=rows[2:],
        pictures=pictures,
        scenes=len(scored),
    )
