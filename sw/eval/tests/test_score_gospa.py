"""GOSPA against brute force over all assignments, and its assignment against scipy's."""

from __future__ import annotations

from itertools import combinations, permutations

import numpy as np
import pytest
from random_seed import seeded
from scipy.optimize import linear_sum_assignment
from vista_eval.metrics.gospa import assign, gospa


def brute_force(distances: np.ndarray, cutoff: float, order: float) -> float:
    """The definition: the cheapest of all partial assignments; what is left out costs c^p / 2 each."""
    truths, estimates = distances.shape
    best = np.inf
    for count in range(min(truths, estimates) + 1):
        for rows in combinations(range(truths), count):
            for columns in permutations(range(estimates), count):
                pairs = sum(min(distances[i, j], cutoff) ** order for i, j in zip(rows, columns, strict=True))
                best = min(best, pairs + 0.5 * cutoff**order * (truths + estimates - 2 * count))
    return best ** (1.0 / order)


def test_against_brute_force() -> None:
    random = seeded(1)
    for _ in range(200):
        truths, estimates = random.integers(0, 5, 2)
        points = [random.uniform(0.0, 12.0, (count, 2)) for count in (truths, estimates)]
        distances = np.linalg.norm(points[0][:, np.newaxis] - points[1], axis=-1)
        cutoff, order = float(random.uniform(1.0, 8.0)), float(random.choice([1.0, 2.0]))
        result = gospa(distances, cutoff, order)
        assert result.distance == pytest.approx(brute_force(distances, cutoff, order), abs=1e-9)


def test_the_assignment_against_scipy() -> None:
    random = seeded(2)
    for _ in range(300):
        cost = random.uniform(-5.0, 10.0, random.integers(1, 12, 2)).round(random.integers(0, 4))
        pairs = assign(cost)
        rows, columns = linear_sum_assignment(cost)
        assert len(pairs) == len(rows) == len({i for i, _ in pairs}) == len({j for _, j in pairs})
        assert sum(cost[i, j] for i, j in pairs) == pytest.approx(cost[rows, columns].sum(), abs=1e-9)


def test_by_hand() -> None:
    """One pair 3 apart, one truth and one estimate alone: sqrt(9 + 25/2 + 25/2)."""
    result = gospa(np.array([[3.0, 40.0], [60.0, 50.0]]), cutoff=5.0, order=2.0)
    assert result.distance == pytest.approx(np.sqrt(34.0))
    assert (result.localisation, result.missed, result.false) == (9.0, 1, 1)


def test_empty_sets() -> None:
    assert gospa(np.zeros((0, 0))).distance == 0.0
    assert gospa(np.zeros((0, 2)), cutoff=4.0, order=2.0).distance == pytest.approx(4.0)
    assert gospa(np.zeros((3, 0)), cutoff=4.0, order=1.0).distance == pytest.approx(6.0)
