"""Density and bad-3 on images drawn by hand, with the figures worked out on paper."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from vista.engine import INVALID, StereoEngine
from vista_eval.metrics.disparity_quality import Counts, at_full_size, count, finest, quality

NONE = np.nan


def test_a_level_lies_on_every_second_pixel_and_its_words_count_double():
    words = np.array([[16, INVALID, 48]], np.int16)
    wanted = [[2.0, NONE, NONE, 6.0, 6.0], [2.0, NONE, NONE, 6.0, 6.0]]
    np.testing.assert_array_equal(at_full_size(words, 1, (2, 5)), wanted)
    np.testing.assert_array_equal(at_full_size(words, 0, (1, 3)), [[1.0, NONE, 3.0]])
    column = np.array([[8], [24]], np.int16)
    np.testing.assert_array_equal(at_full_size(column, 2, (7, 1))[:, 0], [2.0, 2.0, 6.0, 6.0, 6.0, 6.0, 6.0])


def test_the_finest_level_that_has_a_disparity():
    levels = [np.array([[1.0, NONE, NONE]]), np.array([[2.0, 2.0, NONE]]), np.array([[4.0, 4.0, NONE]])]
    np.testing.assert_array_equal(finest(levels), [[1.0, 2.0, NONE]])


def test_only_measured_pixels_count_and_three_pixels_are_not_yet_bad():
    truth = np.array([[10.0, 10.0, 10.0, 10.0, NONE, 70.0]])
    disparity = np.array([[10.0, 13.0, 13.1, NONE, 3.0, 60.0]])
    assert count(disparity, truth) == Counts(measured=5, valid=4, bad=2)
    assert count(disparity, truth, truth > 64) == Counts(measured=1, valid=1, bad=1)


def test_pixels_of_all_pairs_count_the_same():
    many = quality([Counts(100, 50, 5), Counts(300, 300, 30)])
    assert many.density.value == pytest.approx(350 / 400)
    assert many.bad.value == pytest.approx(35 / 350)
    assert (many.density.low, many.density.high) == (0.5, 1.0)  # one pair alone, drawn twice
    assert many.bad.low == many.bad.high == pytest.approx(0.1)
    assert many.pairs == 2


def test_nothing_measured_has_no_share():
    assert np.isnan(quality([Counts(0, 0, 0)]).density.value)


def test_levels_of_a_near_plane():
    """A plane 40 px near is beyond 32 candidates: level 0 is wrong or has nothing, level 1 has it right."""
    scene = seeded(7).integers(0, 256, (120, 400), dtype=np.uint8)
    left, right = scene[:, :340], scene[:, 40:380]
    levels = [
        at_full_size(words, k, left.shape)
        for k, words in enumerate(StereoEngine(32, 11, levels=2).compute_levels(left, right))
    ]
    truth = np.full(left.shape, 40.0)
    inside = np.s_[20:-20, 120:-20]
    near, far = (count(level[inside], truth[inside]) for level in (levels[1], levels[0]))
    assert near.valid > 0.9 * near.measured and near.bad == 0
    assert far.bad == far.valid < 0.5 * far.measured
