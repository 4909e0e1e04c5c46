"""Scores of partitions against label images drawn by hand, with the scores worked out on paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from vista_eval.metrics import segmentation
from vista_eval.metrics.segmentation import LabelledView, PartitionScore, Thing, ThingScore

FOCAL_BASELINE = 457.2  # px m
WHOLE = (slice(None), slice(None))


def block(shape: tuple[int, int], rows: slice, columns: slice) -> np.ndarray:
    label = np.zeros(shape, np.int32)
    label[rows, columns] = 1
    return label


def view_of(label: np.ndarray, range_m: float = 30.0, area=WHOLE) -> LabelledView:
    disparity = np.full(label.shape, FOCAL_BASELINE / range_m)
    return segmentation.labelled_view(label, disparity, {1: ("post", "pole")}, FOCAL_BASELINE, area)


def score(view: LabelledView, region: np.ndarray, size_px: float = 1.0) -> PartitionScore:
    """A partition given pixel by pixel: every pixel is a cell."""
    cells = np.arange(region.size).reshape(region.shape)
    return segmentation.score_partition(
        view, region.astype(np.int32), cells, np.full(region.size, size_px, np.float32)
    )


def test_the_truth_itself_scores_full() -> None:
    label = block((40, 60), slice(10, 30), slice(20, 40))
    result = score(view_of(label), label)
    (post,) = result.things
    assert (post.iou, post.boundary_recall, post.boundary_recall_cell) == (1.0, 1.0, 1.0)
    assert (result.undersegmentation, result.regions) == (0.0, 2)
    assert (post.thing.pixels, post.thing.kind) == (400, "pole")
    assert post.thing.range_m == pytest.approx(30.0)


def test_a_shifted_region_shares_three_fifths() -> None:
    label = block((40, 60), slice(10, 30), slice(20, 40))
    shifted = block((40, 60), slice(10, 30), slice(25, 45))
    result = score(view_of(label), shifted)
    (post,) = result.things
    assert post.iou == pytest.approx(300 / 500)
    # Of 76 boundary pixels the 20 of the left column lie 4 px from the region's first, and those of the right
    # column 5 px from its last, but for the four at either end: these are near its upper and its lower side.
    assert post.boundary_recall == pytest.approx(1 - (20 + 12) / 76)
    assert result.undersegmentation == pytest.approx((100 + 100 + 100 + 100) / 2400)


def test_one_region_for_everything_leaks_and_bounds_nothing() -> None:
    label = block((40, 60), slice(10, 30), slice(20, 40))
    result = score(view_of(label), np.zeros_like(label))
    (post,) = result.things
    assert post.iou == pytest.approx(400 / 2400)
    assert post.boundary_recall == 0.0
    assert result.undersegmentation == pytest.approx(2 * 400 / 2400)


def test_fragments_cost_iou_but_no_leak() -> None:
    label = block((40, 60), slice(10, 30), slice(20, 40))
    region = label.copy()
    region[20:30, 20:40] = 2
    result = score(view_of(label), region)
    assert result.things[0].iou == pytest.approx(0.5)
    assert result.undersegmentation == 0.0


def test_cells_without_a_region_stand_alone() -> None:
    label = block((40, 60), slice(10, 30), slice(20, 40))
    result = score(view_of(label), np.where(label == 1, 0, -1))
    assert (result.things[0].iou, result.undersegmentation, result.regions) == (1.0, 0.0, 1)


def test_recall_is_granted_a_cell_where_cells_are_coarse() -> None:
    label = block((40, 60), slice(0, 40), slice(20, 60))
    region = block((40, 60), slice(0, 40), slice(26, 60))
    fine, coarse = (score(view_of(label), region, size).things[0] for size in (1.0, 6.0))
    assert (fine.boundary_recall, fine.boundary_recall_cell) == (0.0, 0.0)
    assert (coarse.boundary_recall, coarse.boundary_recall_cell) == (0.0, 1.0)


def test_a_thing_that_fills_the_view_has_no_outline_to_recall() -> None:
    """Such frames, before a plain wall, once made the boundary recall of a whole flight not a number."""
    label = np.ones((40, 60), np.int32)
    filled = score(view_of(label), np.zeros_like(label))
    assert filled.things[0].iou == 1.0
    assert (filled.things[0].boundary_recall, filled.things[0].boundary_recall_cell) == (None, None)
    label = block((40, 60), slice(10, 30), slice(20, 40))
    bounded = score(view_of(label), label)
    for key in ("boundary_recall", "boundary_recall_cell"):
        assert segmentation.STATISTICS[key]([filled, bounded]) == 1.0
        assert np.isnan(segmentation.STATISTICS[key]([filled]))


@pytest.mark.parametrize(
    ("rows", "range_m", "scored"),
    [(5, 30.0, True), (4, 30.0, False), (5, 11.9, False), (5, 12.1, True), (5, 89.0, True), (5, 91.0, False)],
)
def test_small_near_and_far_things_are_left_out(rows: int, range_m: float, scored: bool) -> None:
    label = block((40, 60), slice(10, 10 + rows), slice(20, 40))  # 20 px wide, 100 px are needed
    assert bool(view_of(label, range_m).things) is scored


def test_only_the_matched_area_counts() -> None:
    area = segmentation.matched_area(480, 640, num_disparities=64, block_size=11)
    assert area == (slice(5, 475), slice(68, 635))
    label = block((480, 640), slice(100, 200), slice(0, 78))  # 10 columns of it are matched
    view = view_of(label, area=area)
    assert [thing.pixels for thing in view.things] == [1000]
    assert score(view, label).things[0].iou == 1.0


def scores_of(*ious: float) -> PartitionScore:
    thing = Thing(1, "post", "pole", 30.0, 400)
    return PartitionScore(tuple(ThingScore(thing, iou, iou, iou) for iou in ious), 0.1, 10)


def test_statistics_pool_the_things_of_all_scenes() -> None:
    scores = [scores_of(0.2, 0.4), scores_of(), scores_of(0.9)]
    values = {name: statistic(scores) for name, statistic in segmentation.STATISTICS.items()}
    assert values["iou_mean"] == pytest.approx(0.5)
    assert values["iou_median"] == pytest.approx(0.4)
    assert values["found"] == pytest.approx(1 / 3)
    assert values["regions"] == 10


def test_the_interval_holds_a_constant_difference_and_a_doubtful_one_spans_zero() -> None:
    random = np.random.default_rng(5)
    ious = random.uniform(0.2, 0.7, 40)
    reference = [scores_of(iou) for iou in ious]
    mean = segmentation.STATISTICS["iou_mean"]
    better = segmentation.difference_interval([scores_of(iou + 0.1) for iou in ious], reference, mean)
    assert better == pytest.approx((0.1, 0.1))
    noise = random.permutation(np.repeat([-0.1, 0.1], 20))
    low, high = segmentation.difference_interval(
        [scores_of(iou + step) for iou, step in zip(ious, noise, strict=True)], reference, mean
    )
    # Mean of 40 draws of +-0.1: standard error 0.1 / sqrt(40) = 0.0158.
    assert (low, high) == pytest.approx((-0.031, 0.031), abs=0.004)


@pytest.mark.parametrize("name", segmentation.STATISTICS)
def test_the_bootstrap_equals_one_draw_after_the_other(name: str) -> None:
    random = np.random.default_rng(9)
    first, second = (
        [
            replace(scores_of(*random.uniform(0, 1, count)), regions=int(random.integers(5, 60)))
            for count in (3, 0, 1, 4, 2, 6)
        ]
        for _ in range(2)
    )
    statistic = segmentation.STATISTICS[name]
    drawn = np.random.default_rng(0).integers(0, 6, (segmentation.RESAMPLES, 6))
    average = np.median if statistic.median else np.mean

    def of_sample(scores: list[PartitionScore], sample: np.ndarray) -> float:
        return float(average([value for i in sample for value in statistic.values(scores[i])]))

    differences = [of_sample(first, sample) - of_sample(second, sample) for sample in drawn]
    expected = np.percentile(differences, [2.5, 97.5])
    assert segmentation.difference_interval(first, second, statistic) == pytest.approx(tuple(expected))
