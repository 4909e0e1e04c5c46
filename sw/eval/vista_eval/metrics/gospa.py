"""The GOSPA metric of two sets (Rahmathullah, Garcia-Fernandez, Svensson 2017), alpha = 2, and its parts.

    d = (min over assignments of  sum over pairs min(d_ij, c)^p  +  c^p / 2 (missed + false))^(1/p)

A pair farther apart than c counts as one missed and one false.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from vista.geometry import Array

ORDER = 2.0  # p
CUTOFF_M = 5.0  # c: about the depth of one disparity at 45 m, beyond which a pair means nothing


@dataclass(frozen=True)
class Gospa:
    distance: float
    localisation: float  # sum of d^p over pairs
    missed: int
    false: int


def gospa(distances: Array, cutoff: float = CUTOFF_M, order: float = ORDER) -> Gospa:
    """distances: (truths, estimates), not negative."""
    truths, estimates = distances.shape
    cost = np.minimum(distances, cutoff) ** order
    pairs = [(i, j) for i, j in assign(cost) if distances[i, j] < cutoff]
    localisation = float(sum(cost[i, j] for i, j in pairs))
    missed, false = truths - len(pairs), estimates - len(pairs)
    total = localisation + 0.5 * cutoff**order * (missed + false)
    return Gospa(total ** (1.0 / order), localisation, missed, false)


def assign(cost: Array) -> list[tuple[int, int]]:
    """Pairs (row, column) of the cheapest assignment of min(rows, columns) pairs; costs finite.

    Shortest augmenting paths with potentials (Hungarian method), rows one by one."""
    if cost.shape[0] > cost.shape[1]:
        return [(row, column) for column, row in assign(cost.T)]
    rows, columns = cost.shape
    row_potential, column_potential = np.zeros(rows + 1), np.zeros(columns + 1)
    row_of_column = np.zeros(columns + 1, int)  # from 1, 0 = free; column 0: the row to be placed
    padded = np.zeros((rows + 1, columns + 1))
    padded[1:, 1:] = cost
    for row in range(1, rows + 1):
        row_of_column[0] = row
        least, previous = np.full(columns + 1, np.inf), np.zeros(columns + 1, int)
        done = np.zeros(columns + 1, bool)
        column = 0
        while row_of_column[column] != 0:
            done[column] = True
            here = row_of_column[column]
            reduced = padded[here] - row_potential[here] - column_potential
            better = ~done & (reduced < least)
            least[better], previous[better] = reduced[better], column
            following = int(np.argmin(np.where(done, np.inf, least)))
            step = least[following]
            row_potential[row_of_column[done]] += step
            column_potential[done] -= step
            least[~done] -= step
            column = following
        while column != 0:
            row_of_column[column] = row_of_column[previous[column]]
            column = previous[column]
    return [(int(row_of_column[c]) - 1, c - 1) for c in range(1, columns + 1) if row_of_column[c] != 0]
