"""Scores a partition of an image against exact labels.

Everything is counted in pixels of the left image within the area that the engine can match. A thing is scored
if it stands, shows at least MIN_PIXELS there and is NEAR_M to FAR_M away (median over its pixels).

iou               largest |R n T| / |R u T| over the regions R
boundary_recall   share of the thing's boundary pixels within BOUNDARY_PX of a boundary between regions
boundary_recall_cell   the same, within BOUNDARY_PX or one cell, whichever is larger: finer no cell can say
undersegmentation sum over things T (ground and sky too) and regions R of min(|R n T|, |R without T|), as a
                  share of the area (Neubert and Protzel 2012): 0 where no region leaks
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

MIN_PIXELS = 100
NEAR_M, FAR_M = 12.0, 90.0
BOUNDARY_PX = 3.0

Labels = NDArray[np.int32]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Thing:
    """An entry of truth.json's objects as one frame shows it."""

    label: int
    name: str
    kind: str
    range_m: float
    pixels: int


@dataclass(frozen=True)
class ThingScore:
    thing: Thing
    iou: float
    boundary_recall: float | None  # None: nothing of its outline is in view
    boundary_recall_cell: float | None


@dataclass(frozen=True)
class PartitionScore:
    things: tuple[ThingScore, ...]
    undersegmentation: float
    regions: int


@dataclass(frozen=True)
class LabelledView:
    """The truth of one frame, cropped to the matched area; the boundaries found once for many partitions."""

    area: tuple[slice, slice]  # rows and columns of the image
    label: Labels  # (rows, columns) of the area, 0: sky
    things: tuple[Thing, ...]
    boundaries: tuple[Mask, ...]  # of each thing


def matched_area(height: int, width: int, num_disparities: int, block_size: int) -> tuple[slice, slice]:
    """Rows and columns in which the engine looks for a disparity (contract, step 2)."""
    margin = (block_size - 1) // 2
    return slice(margin, height - margin), slice(num_disparities - 1 + margin, width - margin)


def labelled_view(
    label: Labels,
    disparity_px: NDArray[np.float64],
    standing: dict[int, tuple[str, str]],
    focal_baseline: float,
    area: tuple[slice, slice],
) -> LabelledView:
    """label, disparity_px: exact, (height, width); standing: label -> name, kind; focal_baseline in px m."""
    label, disparity_px = label[area], disparity_px[area]
    things, boundaries = [], []
    for number, (name, kind) in standing.items():
        mask = label == number
        pixels = int(mask.sum())
        if pixels < MIN_PIXELS:
            continue
        range_m = focal_baseline / float(np.median(disparity_px[mask]))
        if NEAR_M <= range_m <= FAR_M:
            things.append(Thing(number, name, kind, range_m, pixels))
            boundaries.append(inner_boundary(mask))
    return LabelledView(area, label, tuple(things), tuple(boundaries))


def inner_boundary(mask: Mask) -> Mask:
    """Pixels of the mask with one of their four neighbours outside; the image's edge is no boundary."""
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    eroded = cv2.erode(mask.astype(np.uint8), cross, borderType=cv2.BORDER_CONSTANT, borderValue=1)
    return mask & (eroded == 0)


def distance_to_boundary_px(region: Labels) -> NDArray[np.float32]:
    """The distance from every pixel to the next that borders on another region; large where there is but one
    region."""
    inside = np.ones(region.shape, np.uint8)
    across = region[:, 1:] != region[:, :-1]
    along = region[1:] != region[:-1]
    inside[:, 1:][across] = inside[:, :-1][across] = 0
    inside[1:][along] = inside[:-1][along] = 0
    if inside.all():
        return np.full(region.shape, np.hypot(*region.shape), np.float32)
    return np.asarray(cv2.distanceTransform(inside, cv2.DIST_L2, cv2.DIST_MASK_PRECISE), np.float32)


def score_partition(
    view: LabelledView, region_of_pixel: Labels, cell_of_pixel: Labels, cell_size_px: NDArray[np.float32]
) -> PartitionScore:
    """region_of_pixel, cell_of_pixel: (height, width) of the image. Pixels of no region, -1, count as one
    region a cell, but bound nothing."""
    region, cells = region_of_pixel[view.area], cell_of_pixel[view.area]
    regions = int(region_of_pixel.max(initial=-1)) + 1
    numbered = np.where(region < 0, regions + cells, region)
    shared = shared_pixels(view.label, numbered, regions + len(cell_size_px))
    distance = distance_to_boundary_px(region)
    size = cell_size_px[cells]
    scores = tuple(
        ThingScore(
            thing,
            best_iou(shared, thing.label),
            _share(distance[boundary] <= BOUNDARY_PX),
            _share(distance[boundary] <= np.maximum(BOUNDARY_PX, size[boundary])),
        )
        for thing, boundary in zip(view.things, view.boundaries, strict=True)
    )
    return PartitionScore(scores, undersegmentation(shared), regions)


def _share(within: Mask) -> float | None:
    return float(np.mean(within)) if len(within) else None


def shared_pixels(label: Labels, region: Labels, regions: int) -> NDArray[np.int64]:
    """(labels, regions): pixels that each label shares with each region."""
    labels = int(label.max()) + 1
    keys = label.astype(np.int64) * regions + region
    return np.bincount(keys.ravel(), minlength=labels * regions).reshape(labels, regions)


def best_iou(shared: NDArray[np.int64], label: int) -> float:
    union = shared[label].sum() + shared.sum(axis=0) - shared[label]
    return float(np.max(shared[label] / np.maximum(union, 1)))


def undersegmentation(shared: NDArray[np.int64]) -> float:
    return float(np.minimum(shared, shared.sum(axis=0) - shared).sum() / shared.sum())


# ---- over many scenes ----

RESAMPLES = 2000


@dataclass(frozen=True)
class Statistic:
    """Mean or median of the values that all scenes have together, of each thing or of each scene."""

    values: Callable[[PartitionScore], list[float]]  # of one scene
    median: bool = False

    def __call__(self, scores: list[PartitionScore]) -> float:
        return float(self.resampled(scores, np.ones((1, len(scores)), np.int64))[0])

    def resampled(self, scores: list[PartitionScore], draws: NDArray[np.int64]) -> NDArray[np.float64]:
        """draws: (samples, scenes), how often a sample holds a scene. NaN for a sample without values."""
        of_scene = [self.values(score) for score in scores]
        values = np.array([value for some in of_scene for value in some], np.float64)
        weights = np.repeat(draws, [len(some) for some in of_scene], axis=1)
        count = weights.sum(axis=1)
        if self.median and len(values):
            order = np.argsort(values)
            upto = np.cumsum(weights[:, order], axis=1)
            middle = [
                (upto > rank[:, np.newaxis]).argmax(axis=1)
                for rank in (np.maximum(count - 1, 0) // 2, count // 2)
            ]
            total, divisor = values[order][middle].sum(axis=0), np.where(count, 2, 0)
        else:
            total, divisor = weights @ values, count
        return np.where(divisor, total / np.maximum(divisor, 1), np.nan)


STATISTICS: dict[str, Statistic] = {
    "iou_median": Statistic(lambda score: [thing.iou for thing in score.things], median=True),
    "iou_mean": Statistic(lambda score: [thing.iou for thing in score.things]),
    "found": Statistic(lambda score: [thing.iou > 0.5 for thing in score.things]),
    "boundary_recall": Statistic(
        lambda score: [thing.boundary_recall for thing in score.things if thing.boundary_recall is not None]
    ),
    "boundary_recall_cell": Statistic(
        lambda score: [
            thing.boundary_recall_cell for thing in score.things if thing.boundary_recall_cell is not None
        ]
    ),
    "undersegmentation": Statistic(lambda score: [score.undersegmentation]),
    "regions": Statistic(lambda score: [score.regions], median=True),
}


STATED = {  # in tables, with the names that they give them
    "iou_median": "IoU median",
    "iou_mean": "IoU mean",
    "found": "IoU > 0.5",
    "boundary_recall": "boundary recall",
    "undersegmentation": "under-segmentation",
    "regions": "regions",
}


def stated(key: str, value: float) -> str:
    return f"{value:.0f}" if key == "regions" else f"{value:.3f}"


def interval(scores: list[PartitionScore], statistic: Statistic, seed: int = 0) -> tuple[float, float]:
    """95 % interval of statistic(scores): bootstrap that draws whole scenes, or whatever a score is of."""
    values = statistic.resampled(scores, _draws(len(scores), seed))
    low, high = np.nanpercentile(values, [2.5, 97.5])
    return float(low), float(high)


def difference_interval(
    first: list[PartitionScore], second: list[PartitionScore], statistic: Statistic, seed: int = 0
) -> tuple[float, float]:
    """95 % interval of statistic(first) - statistic(second) over the same scenes: bootstrap that draws whole
    scenes, the things of one are not independent."""
    draws = _draws(len(first), seed)
    differences = statistic.resampled(first, draws) - statistic.resampled(second, draws)
    low, high = np.nanpercentile(differences, [2.5, 97.5])
    return float(low), float(high)


def _draws(scenes: int, seed: int) -> NDArray[np.int64]:
    """How often each sample holds each scene."""
    drawn = np.random.default_rng(seed).integers(0, scenes, (RESAMPLES, scenes))
    return np.stack([np.bincount(sample, minlength=scenes) for sample in drawn])
