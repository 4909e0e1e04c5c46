"""Each step of the numpy reference against its definition, spelled out pixel by pixel on small images."""

from __future__ import annotations

from fractions import Fraction
from math import trunc

import numpy as np
import pytest
from vista_model import INVALID, NO_COST, Parameters, compute, compute_with_smin, engine

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
    textured = engine.textured(left, parameters)
    assert textured.any() and not textured.all()
    for y, x in np.ndindex(textured.shape):
        block = p[y : y + _BLOCK, x + _D - 1 : x + _D - 1 + _BLOCK]
        assert textured[y, x] == (np.abs(block - 31).sum() >= 600)


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


def test_shifted_image_has_its_shift(rng):
    scene = rng.integers(0, 256, (30, 100), dtype=np.uint8)
    words = compute(scene[:, :80], scene[:, 7:87], Parameters(_D, _BLOCK, lr_max_diff=1))
    np.testing.assert_allclose(words[_R:-_R, _D - 1 + _R : -_R], 16 * 7, atol=4)


def test_only_matched_pixels_carry_anything(pair):
    parameters = Parameters(_D, _BLOCK, texture_threshold=0, uniqueness_ratio=0, lr_max_diff=None)
    words, smin = compute_with_smin(*pair, parameters)
    matched = np.zeros(words.shape, bool)
    matched[_R:-_R, _D - 1 + _R : -_R] = True
    np.testing.assert_array_equal(words != INVALID, matched)
    np.testing.assert_array_equal(smin != NO_COST, matched)
