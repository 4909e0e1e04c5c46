"""The matcher of four paths, to the word against its definition in numpy; borders, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_seed import seeded
from vista.engine import INVALID, EngineParameters
from vista_eval.baselines.four_paths import CHOSEN, FourPathsEngine, PathCosts

RADIUS = {"census": 2, "sad": 1}
CAP, TEXTURE_RADIUS, FAR_AWAY = 31, 5, 10**6


def responses(image: np.ndarray) -> np.ndarray:
    """The engine's prefilter, about zero."""
    rows = np.pad(image, ((1, 1), (0, 0)), mode="reflect")
    rows = rows[:-2] + 2 * rows[1:-1] + rows[2:]
    out = np.zeros_like(image)
    out[:, 1:-1] = np.clip(rows[:, 2:] - rows[:, :-2], -CAP, CAP)
    out[len(out) - len(out) % 2 :] = 0
    return out


def costs_at(
    left: np.ndarray, right: np.ndarray, costs: PathCosts, y: int, x: int, candidates: int
) -> np.ndarray:
    """What the windows differ by, of each candidate."""
    r = RADIUS[costs.cost]
    rows = slice(y - r, y + r + 1)
    found = []
    for there in range(x, x - candidates, -1):
        ours, theirs = left[rows, x - r : x + r + 1], right[rows, there - r : there + r + 1]
        if costs.cost == "census":
            found.append(((ours < left[y, x]) != (theirs < right[y, there])).sum())
        else:
            found.append(abs(ours - theirs).sum() // 4)
    return np.array(found)


def reference(
    left: np.ndarray, right: np.ndarray, costs: PathCosts, candidates: int, most: int | None
) -> np.ndarray:
    left, right = left.astype(int), right.astype(int)
    texture = abs(responses(left))
    matched = (responses(left), responses(right)) if costs.cost == "sad" else (left, right)
    (height, width), r = left.shape, RADIUS[costs.cost]
    words = np.full(left.shape, INVALID, np.int16)
    columns = range(candidates - 1 + r, width - r)
    above: dict[tuple[str, int], np.ndarray] = {}
    for y in range(r, height - r):
        here: dict[tuple[str, int], np.ndarray] = {}
        sums = {}
        for x in columns:
            cost = costs_at(*matched, costs, y, x, candidates)
            before = {
                "left": here.get(("left", x - 1)),
                "upper left": above.get(("upper left", x - 1)),
                "up": above.get(("up", x)),
                "upper right": above.get(("upper right", x + 1)),
            }
            for path, value in before.items():
                here[path, x] = cost if value is None else cost + arriving(value, costs)
            sums[x] = np.sum([here[path, x] for path in before], axis=0)
        above = here
        best = {x: int(candidates - 1 - np.argmin(s[::-1])) for x, s in sums.items()}
        for x in columns:
            block = texture[max(0, y - TEXTURE_RADIUS) : y + TEXTURE_RADIUS + 1]
            block = block[:, max(0, x - TEXTURE_RADIUS) : x + TEXTURE_RADIUS + 1]
            d, cost = best[x], sums[x]
            others = abs(np.arange(candidates) - d) > 1
            limit = cost[d] + cost[d] * costs.uniqueness_ratio // 100
            rivals = costs.uniqueness_ratio > 0 and (cost[others] <= limit).any()
            theirs = min((sums[x - d + e][e], -e) for e in range(candidates) if x - d + e in sums)
            consistent = most is None or abs(d + theirs[1]) <= most
            if block.sum() >= costs.texture_threshold and not rivals and consistent:
                words[y, x] = word(cost, d)
    return words


def arriving(value: np.ndarray, costs: PathCosts) -> np.ndarray:
    padded = np.pad(value, 1, constant_values=FAR_AWAY)
    moved = np.minimum(padded[:-2], padded[2:]) + costs.near
    return np.minimum(np.minimum(value, moved), value.min() + costs.far) - value.min()


def word(cost: np.ndarray, d: int) -> int:
    below, above = (cost[e if 0 <= e < len(cost) else 2 * d - e] for e in (d - 1, d + 1))
    q = below + above - 2 * cost[d] + abs(below - above)
    part = np.sign(below - above) * (256 * abs(below - above) // q) if q else 0
    return int(256 * d + part + 15) >> 4


@pytest.mark.parametrize("candidates", [32, 64])
@pytest.mark.parametrize("cost", RADIUS)
def test_words_are_those_of_the_definition(cost: str, candidates: int) -> None:
    """Shifted textures, from strong to hardly any, in sizes that are odd and even."""
    radius = RADIUS[cost]
    random = seeded(radius)
    found = 0
    for most, asked in ((None, (0, 0)), (0, (0, 15)), (1, (700, 5))):
        height = 2 * radius + random.integers(3, 12)
        width = candidates + 2 * radius + random.integers(8, 24)
        texture = random.integers(0, random.choice([6, 40, 256]), (height, width + candidates), np.uint8)
        shift = random.integers(0, candidates)
        left, right = texture[:, :width], texture[:, shift : shift + width]
        near, far = random.integers(0, 20), random.integers(20, 90)
        costs = PathCosts(cost, near, far, *asked)
        engine = FourPathsEngine(EngineParameters(candidates, lr_max_diff=most), costs)
        words = engine.compute(left, right)
        assert np.array_equal(words, reference(left, right, costs, candidates, most))
        found += (words != INVALID).sum()
    assert found > 20  # without a check every pixel has a word


@pytest.mark.parametrize("cost", RADIUS)
def test_nothing_where_nothing_can_be_told(cost: str) -> None:
    """Images narrower than the candidates, lower than a window, of one pixel, and without any texture."""
    costs, radius = PathCosts(cost, 8, 32), RADIUS[cost]
    engine = FourPathsEngine(EngineParameters(32), costs)
    random = seeded(3)
    for shape in ((1, 1), (20, 31), (20, 32 + 2 * radius - 1), (2 * radius, 80)):
        image = random.integers(0, 256, shape, np.uint8)
        assert (engine.compute(image, image) == INVALID).all()
    flat = np.full((20, 80), 128, np.uint8)
    for unasked in (costs, replace(costs, texture_threshold=0)):
        assert (FourPathsEngine(EngineParameters(32), unasked).compute(flat, flat) == INVALID).all()


def test_levels_are_those_of_the_pyramid() -> None:
    image = seeded(4).integers(0, 256, (33, 150), np.uint8)
    engine = FourPathsEngine(EngineParameters(32, levels=3))
    assert [words.shape for words in engine.levels(image, image)] == [(33, 150), (17, 75), (9, 38)]


@pytest.mark.parametrize(
    ("wrong", "culprit"),
    [
        ({"near": -1}, "penalties"),
        ({"near": 40, "far": 39}, "penalties"),
        ({"far": 250}, "penalties"),
        ({"texture_threshold": -1}, "texture_threshold"),
        ({"uniqueness_ratio": 101}, "uniqueness_ratio"),
    ],
)
def test_costs_out_of_range_are_refused(wrong: dict, culprit: str) -> None:
    with pytest.raises(ValueError, match=culprit):
        FourPathsEngine(EngineParameters(32), replace(CHOSEN, **wrong))


def test_other_bad_input_is_refused() -> None:
    with pytest.raises(ValueError, match="num_disparities"):
        FourPathsEngine(EngineParameters(48))
    with pytest.raises(ValueError, match="lr_max_diff"):
        FourPathsEngine(EngineParameters(32, lr_max_diff=256))
    engine, image = FourPathsEngine(EngineParameters(32)), np.zeros((2, 8193), np.uint8)
    with pytest.raises(ValueError, match="8192 px"):
        engine.compute(image, image)
    with pytest.raises(ValueError, match="right image is"):
        engine.compute(image, image[:, 1:])
