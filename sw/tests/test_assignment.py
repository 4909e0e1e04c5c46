"""The assignment against scipy's: as many pairs as possible first, then the smallest cost."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from scipy.optimize import linear_sum_assignment
from stage_library import Arena, ffi, lib, status_name

CASES = 1000


class Solver:
    def __init__(self, rows: int, columns: int) -> None:
        out = ffi.new("vista_assignment **")
        self._arena = Arena(lambda arena: lib.vista_assignment_layout(rows, columns, arena, out))
        assert self._arena.status == lib.VISTA_OK
        self.handle = out[0]

    def __call__(self, cost: np.ndarray) -> tuple[str, np.ndarray]:
        cost = np.ascontiguousarray(cost, np.float64)
        columns = np.full(max(1, len(cost)), -7, np.int32)
        status = lib.vista_assignment_solve(
            self.handle,
            ffi.cast("double *", cost.ctypes.data),
            *cost.shape,
            ffi.cast("int32_t *", columns.ctypes.data),
        )
        return status_name(status), columns[: len(cost)]


def random_cost(random: np.random.Generator, rows: int, columns: int) -> np.ndarray:
    kind = random.integers(3)
    if kind == 0:
        cost = random.uniform(0, 100, (rows, columns))
    elif kind == 1:
        cost = random.integers(-3, 4, (rows, columns)).astype(float)  # many ties, negative costs too
    else:
        cost = random.exponential(1.0, (rows, columns)) * 10.0 ** random.integers(-6, 7)
    cost[random.random(cost.shape) < random.choice([0.0, 0.3, 0.8, 0.97])] = np.inf
    return cost


def reference(cost: np.ndarray) -> tuple[int, float]:
    """Number of pairs and their cost; a forbidden pair costs more than all others together."""
    allowed = np.isfinite(cost)
    large = 2 * np.abs(cost[allowed]).sum() + 1 if allowed.any() else 1.0
    rows, columns = linear_sum_assignment(np.where(allowed, cost, large))
    kept = allowed[rows, columns]
    return int(kept.sum()), float(cost[rows, columns][kept].sum())


def check(cost: np.ndarray, columns: np.ndarray) -> None:
    rows = np.flatnonzero(columns >= 0)
    assert np.unique(columns[rows]).size == rows.size
    assert np.isfinite(cost[rows, columns[rows]]).all()
    count, total = reference(cost)
    assert rows.size == count
    scale = np.abs(cost[np.isfinite(cost)]).max(initial=0.0)
    assert cost[rows, columns[rows]].sum() == pytest.approx(total, rel=1e-9, abs=1e-9 * scale)


def test_random_cases_cost_what_scipy_says() -> None:
    random, solve = seeded(1), Solver(40, 40)
    for _ in range(CASES):
        cost = random_cost(random, *random.integers(1, 25, 2))
        status, columns = solve(cost)
        assert status == "VISTA_OK"
        check(cost, columns)


def test_full_capacity() -> None:
    random, solve = seeded(2), Solver(128, 256)
    cost = random.uniform(0, 1, (128, 256))
    cost[random.random(cost.shape) < 0.9] = np.inf
    check(cost, solve(cost)[1])
    check(cost[:, :60], solve(cost[:, :60])[1])


def test_one_more_pair_beats_any_cost() -> None:
    cost = np.array([[0.0, 1e9], [1e-9, np.inf]])
    assert Solver(2, 2)(cost)[1].tolist() == [1, 0]


def test_empty_sides_and_all_forbidden() -> None:
    solve = Solver(3, 3)
    assert solve(np.empty((0, 2)))[0] == "VISTA_OK"
    assert solve(np.empty((3, 0)))[1].tolist() == [-1, -1, -1]
    assert solve(np.full((2, 3), np.inf))[1].tolist() == [-1, -1]


def test_bad_input_is_refused_and_nothing_written() -> None:
    solve = Solver(2, 3)
    for cost, status in [
        (np.array([[1.0, np.nan]]), "VISTA_ERROR_NUMBER"),
        (np.array([[1.0, -np.inf]]), "VISTA_ERROR_NUMBER"),
        (np.zeros((3, 3)), "VISTA_ERROR_CAPACITY"),
        (np.zeros((2, 4)), "VISTA_ERROR_CAPACITY"),
    ]:
        found, columns = solve(cost)
        assert found == status
        assert (columns == -7).all()
    out = ffi.new("vista_assignment **")
    for size in (0, -1, lib.VISTA_ASSIGNMENT_MAX + 1):
        assert (
            Arena(lambda arena, n=size: lib.vista_assignment_layout(n, 4, arena, out)).status
            == lib.VISTA_ERROR_RANGE
        )
    short = Arena(lambda arena: lib.vista_assignment_layout(4, 4, arena, out), missing_bytes=1)
    assert short.status == lib.VISTA_ERROR_MEMORY
