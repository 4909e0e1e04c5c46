"""Logistic regression with a ridge, by Newton's method, and its cross-validation by leaving groups out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from vista.geometry import Array

RIDGE = 1.0  # on every weight but the first, where all entries together weigh as many as they are
STEPS, CLOSE = 60, 1e-9
HALVINGS = 30
LEAST = 1e-12  # of a probability, so that its logarithm is finite


def with_ones(x: Array) -> Array:
    return np.column_stack([np.ones(len(x)), x])


def probability(weights: Array, x: Array) -> Array:
    """x: (n, pieces); weights: the prior, then one a piece."""
    return 1.0 / (1.0 + np.exp(-np.clip(with_ones(x) @ weights, -500.0, 500.0)))


def losses(p: Array, y: NDArray[np.int64]) -> Array:
    """Log loss of each entry, nats."""
    return -np.log(np.maximum(np.where(y == 1, p, 1.0 - p), LEAST))


def fit(x: Array, y: NDArray[np.int64], entry_weight: Array) -> Array:
    """The prior and the weights that a Newton iteration ends at, each step halved until it gains."""
    scaled = entry_weight * (len(y) / entry_weight.sum())
    a = with_ones(x)
    ridge = np.full(a.shape[1], RIDGE)
    ridge[0] = 0.0

    def cost(weights: Array) -> float:
        return float(scaled @ losses(probability(weights, x), y) + 0.5 * ridge @ weights**2)

    weights = np.zeros(a.shape[1])
    before = cost(weights)
    for _ in range(STEPS):
        p = probability(weights, x)
        slope = a.T @ (scaled * (p - y)) + ridge * weights
        curve = (a * (scaled * p * (1.0 - p))[:, np.newaxis]).T @ a + np.diag(ridge + LEAST)
        step = np.linalg.solve(curve, slope)
        for _ in range(HALVINGS):
            after = cost(weights - step)
            if after <= before:
                break
            step = 0.5 * step
        weights = weights - step
        if before - after <= CLOSE * before:
            break
        before = after
    return weights


@dataclass(frozen=True)
class Held:
    """What each entry is given by a fit that its group had no part in."""

    probability: Array
    loss: dict[str, float]  # mean of each group


def same_for_each(group: NDArray[np.str_]) -> Array:
    """The weight of each entry with which every group weighs the same."""
    _, which, counts = np.unique(group, return_inverse=True, return_counts=True)
    return np.asarray(1.0 / counts[which])


def cross_validate(
    x: Array, y: NDArray[np.int64], group: NDArray[np.str_], told_only: Sequence[str] = ()
) -> Held:
    """told_only: groups that no fit takes part of. y: -1 where it is not known; such an entry is given a
    probability, too."""
    held = np.zeros(len(y))
    known = y >= 0
    learnt = known & ~np.isin(group, told_only)
    for one in np.unique(group).tolist():
        others, own = learnt & (group != one), group == one
        weights = fit(x[others], y[others], same_for_each(group[others]))
        held[own] = probability(weights, x[own])
    loss = {
        one: float(losses(held, y)[known & (group == one)].mean()) for one in np.unique(group[known]).tolist()
    }
    return Held(held, loss)
