"""The reference method: merging after Felzenszwalb and Huttenlocher (IJCV 2004), no cut.

It works on the host's own graph.

Edges in the order of falling affinity; two components become one if the edge's dissimilarity 1 - w is at most
Int(C) + k / |C| of each, where Int(C) is the largest dissimilarity that joined it and |C| its cells.
Components of fewer than min_cells are then joined along their strongest edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ReferenceParameters:
    k: float = 5.0  # cells: larger gives larger regions
    min_cells: int = 3
    respect_surfaces: bool = False  # no edge between horizontal and standing cells, as the cut's own seeds


def merge_cells(
    edges: NDArray[np.int32],
    affinity: NDArray[np.float32],
    horizontal: NDArray[np.bool_],
    parameters: ReferenceParameters,
) -> NDArray[np.int32]:
    """Region of each cell, 0 .. regions - 1. edges: (edges, 2) cells; affinity: w of each edge."""
    cells = len(horizontal)
    if parameters.respect_surfaces:
        kept = horizontal[edges[:, 0]] == horizontal[edges[:, 1]]
        edges, affinity = edges[kept], affinity[kept]
    order = np.argsort(-affinity, kind="stable")
    pairs = edges[order].tolist()
    dissimilarity = (1.0 - affinity[order].astype(np.float64)).tolist()

    parent = list(range(cells))
    size = [1] * cells
    limit = [parameters.k] * cells  # Int(C) + k / |C| of each root

    def find(cell: int) -> int:
        while parent[cell] != cell:
            parent[cell] = parent[parent[cell]]
            cell = parent[cell]
        return cell

    def join(a: int, b: int) -> int:
        parent[b] = a
        size[a] += size[b]
        return a

    for (i, j), d in zip(pairs, dissimilarity, strict=True):
        a, b = find(i), find(j)
        if a != b and d <= limit[a] and d <= limit[b]:
            root = join(a, b)
            limit[root] = d + parameters.k / size[root]
    for i, j in pairs:
        a, b = find(i), find(j)
        if a != b and min(size[a], size[b]) < parameters.min_cells:
            join(a, b)
    roots = np.array([find(cell) for cell in range(cells)])
    return np.unique(roots, return_inverse=True)[1].astype(np.int32)
