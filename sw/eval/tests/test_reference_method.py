"""The reference method against its definition, worked out anew at every step on tiny graphs."""

from __future__ import annotations

import numpy as np
from random_seed import seeded
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import minimum_spanning_tree
from vista_eval.baselines.reference_method import ReferenceParameters, merge_cells


def internal_difference(component: set[int], edges: list[tuple[int, int, float]]) -> float:
    """Largest edge of the component's minimum spanning tree (the paper's equation 1); weights are not 0."""
    inside = [(i, j, d) for i, j, d in edges if i in component and j in component]
    if len(component) == 1:
        return 0.0
    count = max(component) + 1
    i, j, d = zip(*inside, strict=True)
    return float(minimum_spanning_tree(csr_matrix((d, (i, j)), (count, count))).data.max())


def merge_by_definition(edges: list[tuple[int, int, float]], cells: int, k: float, min_cells: int) -> set:
    components = [{cell} for cell in range(cells)]

    def of(cell: int) -> set[int]:
        return next(c for c in components if cell in c)

    def join(a: set[int], b: set[int]) -> None:
        components.remove(b)
        a |= b

    ordered = sorted(edges, key=lambda edge: edge[2])
    for i, j, d in ordered:
        a, b = of(i), of(j)
        if a is not b and d <= min(internal_difference(c, edges) + k / len(c) for c in (a, b)):
            join(a, b)
    for i, j, _ in ordered:
        a, b = of(i), of(j)
        if a is not b and min(len(a), len(b)) < min_cells:
            join(a, b)
    return {frozenset(c) for c in components}


def random_graph(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A grid of 3 x 4 cells; affinities that a float holds exactly, all different."""
    grid = np.arange(12).reshape(3, 4)
    pairs = [grid[:, :-1].ravel(), grid[:, 1:].ravel()], [grid[:-1].ravel(), grid[1:].ravel()]
    edges = np.concatenate([np.stack(pair, axis=1) for pair in pairs]).astype(np.int32)
    affinity = random.choice(np.arange(1, 256), len(edges), replace=False) / 256.0
    return edges, affinity.astype(np.float32)


def as_sets(region: np.ndarray) -> set:
    return {frozenset(np.flatnonzero(region == r).tolist()) for r in np.unique(region)}


def test_merging_follows_the_definition() -> None:
    random = seeded(0)
    counts = set()
    for _ in range(60):
        edges, affinity = random_graph(random)
        k, min_cells = random.uniform(0.05, 2.0), int(random.integers(1, 5))
        region = merge_cells(edges, affinity, np.zeros(12, bool), ReferenceParameters(k, min_cells))
        weighted = [(int(i), int(j), 1.0 - float(w)) for (i, j), w in zip(edges, affinity, strict=True)]
        assert as_sets(region) == merge_by_definition(weighted, 12, k, min_cells)
        counts.add(region.max() + 1)
    assert len(counts) > 3  # neither all merged nor none


def test_surfaces_part_what_affinity_joins() -> None:
    edges = np.array([[0, 1], [1, 2], [2, 3]], np.int32)
    affinity = np.ones(3, np.float32)
    horizontal = np.array([True, True, False, False])
    merged = merge_cells(edges, affinity, horizontal, ReferenceParameters())
    parted = merge_cells(edges, affinity, horizontal, ReferenceParameters(respect_surfaces=True))
    assert merged.tolist() == [0, 0, 0, 0]
    assert parted.tolist() == [0, 0, 1, 1]
