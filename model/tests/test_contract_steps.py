"""Each step of the numpy reference against its definition, spelled out pixel by pixel on small images."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import trunc

import numpy as np
import pytest
from vista_model import INVALID, NO_CONFIDENCE, NO_COST, Parameters, compute, compute_all, engine

_D, _BLOCK = 16, 5
_R = _BLOCK // 2


@pytest.fixture
def pair(rng):
    return rng.integers(0, 256, (2, 9, 34), dtype=np.uint8)


@pytest.fixture
def costs(rng):
    return rng.integers(0, 12, (_D, 5, 40)).astype(np.int32)  # few values: ties are common


@pytest.mark.parametrize("height", [2, 3, 8, 9])
@pytest.mark.parametrize("cap", [1, 31, 63])
def test_xsobel(rng, height, cap):
    image = rng.integers(0, 256, (height, 11), dtype=np.uint8)
    wanted = np.full(image.shape, cap)
    for y in range(height - height % 2):
        for x in range(1, 10):
            above, below = abs(y - 1), y + 1 if y + 1 < height else height - 2
            weights = ((1, above), (2, y), (1, below))
            g = sum(k * (int(image[v, x + 1]) - int(image[v, x - 1])) for k, v in weights)
            wanted[y, x] = min(max(g, -cap), cap) + cap
    np.testing.assert_array_equal(engine.xsobel(image, cap), wanted)


def test_costs(pair):
    left, right = pair
    S = engine.costs(left, right, Parameters(_D, _BLOCK))
    height, width = left.shape
    assert S.shape == (_D, height - 2 * _R, width - (_D - 1) - 2 * _R)
    for d, y, x in np.ndindex(S.shape):
        u, v = x + _D - 1 + _R, y + _R
        block = np.s_[v - _R : v + _R + 1]
        difference = left[block, u - _R : u + _R + 1].astype(int) - right[block, u - d - _R : u - d + _R + 1]
        assert S[d, y, x] == np.abs(difference).sum()


def test_winner_takes_the_larger_of_equals(costs):
    dL, smin = engine.winner(costs)
    for y, x in np.ndindex(dL.shape):
        assert (smin[y, x], -dL[y, x]) == min((costs[d, y, x], -d) for d in range(_D))


def test_texture(pair):
    left = pair[0]
    p = engine.xsobel(left, 31).astype(int)
    parameters = Parameters(_D, _BLOCK, texture_threshold=600)
    texture = engine.texture(left, parameters)
    for y, x in np.ndindex(texture.shape):
        block = p[y : y + _BLOCK, x + _D - 1 : x + _D - 1 + _BLOCK]
        assert texture[y, x] == np.abs(block - 31).sum()
    without = compute(*pair, replace(parameters, texture_threshold=0))[_R:-_R, _D - 1 + _R : -_R]
    words = compute(*pair, parameters)[_R:-_R, _D - 1 + _R : -_R]
    assert (texture < 600).any() and (words != INVALID).any()
    np.testing.assert_array_equal(words, np.where(texture < 600, INVALID, without))


@pytest.mark.parametrize("ratio", [0, 1, 35, 100])
def test_uniqueness(costs, ratio):
    dL, smin = engine.winner(costs)
    unique = engine.unique(costs, dL, smin, ratio)
    for y, x in np.ndindex(dL.shape):
        limit = smin[y, x] + trunc(Fraction(int(smin[y, x]) * ratio, 100))
        rivals = [d for d in range(_D) if abs(d - dL[y, x]) > 1 and costs[d, y, x] <= limit]
        assert unique[y, x] == (ratio == 0 or not rivals)


@pytest.mark.parametrize("lr_max_diff", [0, 2, None])
def test_left_right_check(costs, lr_max_diff):
    dL, _ = engine.winner(costs)
    consistent = engine.consistent(dL, engine.right_winner(costs), _D, lr_max_diff)
    columns = costs.shape[2]
    for y, x in np.ndindex(dL.shape):
        right = x - dL[y, x]  # both counted from the first matched left pixel
        candidates = [d for d in range(_D) if 0 <= right + d < columns]
        dR = max(candidates, key=lambda d: (-costs[d, y, right + d], d))
        assert consistent[y, x] == (lr_max_diff is None or abs(dL[y, x] - dR) <= lr_max_diff)


def test_subpixel(costs):
    costs = costs * 977
    dL, smin = engine.winner(costs)
    words = engine.subpixel(costs, dL, smin)
    for y, x in np.ndindex(dL.shape):
        d = dL[y, x]
        S = [int(s) for s in costs[:, y, x]]
        p, n = S[1 if d == 0 else d - 1], S[_D - 2 if d == _D - 1 else d + 1]
        q = p + n - 2 * S[d] + abs(p - n)
        fraction = trunc(Fraction(256 * (p - n), q)) if q else 0
        assert words[y, x] == (256 * d + fraction + 15) >> 4


@pytest.mark.parametrize("scale", [0, 1, 977])
def test_confidence(rng, costs, scale):
    costs = costs * scale  # all of them 0, some 0, or none that a margin is a whole number of
    costs[:, 0] = costs[:, 0] % 2  # nothing but 0 and 1: no margin, or all there is
    dL, smin = engine.winner(costs)
    texture = rng.integers(0, 2 ** rng.integers(0, 15, dL.shape)).astype(np.int32)
    confidence = engine.confidence(costs, dL, smin, texture)
    for y, x in np.ndindex(dL.shape):
        S, least = costs[:, y, x], int(smin[y, x])
        cost, nearer = min((int(S[d]), -d) for d in range(_D) if abs(d - dL[y, x]) > 1)
        margin = max(k for k in range(16) if k == 0 or cost > least + Fraction(least * k, 32))
        distance = (-nearer - int(dL[y, x])) % 256
        assert confidence[y, x] == distance << 8 | margin << 4 | int(texture[y, x]).bit_length()


def test_distances_that_eight_bits_do_not_hold_are_the_nearest_that_they_do():
    costs = np.full((256, 1, 3), 9, np.int32)
    for x, (d, rival) in enumerate([(0, 255), (255, 0), (127, 255)]):
        costs[[d, rival], 0, x] = 1, 2
    distances = engine.confidence(costs, *engine.winner(costs), np.zeros((1, 3), np.int32)) >> 8
    assert distances.tolist() == [[127, 128, 127]]


@pytest.mark.parametrize("ratio", [25, 50, 75, 100])
def test_the_margin_tells_which_ratios_of_uniqueness_a_pixel_passes(costs, ratio):
    """Ratios are whole percents; these are also multiples of 1/32. The margin 15 stands for more, too."""
    costs = 5 * costs + 16
    costs[3:, :, 20:] += 60  # rivals that are far above, unless the winner is 0 or 2
    dL, smin = engine.winner(costs)
    margin = engine.confidence(costs, dL, smin, np.zeros_like(dL)) >> 4 & 15
    unique = engine.unique(costs, dL, smin, ratio)
    steps = ratio * 32 // 100
    if steps <= 15:
        np.testing.assert_array_equal(margin >= steps, unique)
    else:
        assert (margin[unique] == 15).all()
    assert unique.any() and not unique.all()


def test_shifted_image_has_its_shift(rng):
    scene = rng.integers(0, 256, (30, 100), dtype=np.uint8)
    words = compute(scene[:, :80], scene[:, 7:87], Parameters(_D, _BLOCK, lr_max_diff=1))
    # the last column is not filtered: blocks that hold it differ; the sub-pixel step moves up to half a pixel
    inner = words[_R:-_R, _D - 1 + _R : -_R - 1]
    np.testing.assert_allclose(inner, 16 * 7, atol=8)


def test_only_matched_pixels_carry_anything(pair):
    parameters = Parameters(_D, _BLOCK, texture_threshold=0, uniqueness_ratio=0, lr_max_diff=None)
    words, smin, confidence = compute_all(*pair, parameters)
    matched = np.zeros(words.shape, bool)
    matched[_R:-_R, _D - 1 + _R : -_R] = True
    np.testing.assert_array_equal(words != INVALID, matched)
    np.testing.assert_array_equal(smin != NO_COST, matched)
    np.testing.assert_array_equal(confidence != NO_CONFIDENCE, matched)
