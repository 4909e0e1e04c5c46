"""The maximum spanning forest against Kruskal's algorithm on random graphs, and the partition that it
makes."""

from __future__ import annotations

import numpy as np
import pytest
from cut_graph import CutGraph
from random_seed import seeded
from stage_library import Arena, ffi, lib, pointer


def grow(
    graph: CutGraph, links: np.ndarray, source: np.ndarray, sink: np.ndarray, subset: np.ndarray
) -> np.ndarray:
    forest, problem = ffi.new("vista_spanning_forest *"), ffi.new("vista_forest_problem *")
    arena = Arena(lambda a: lib.vista_spanning_forest_layout(graph.graph, a, forest))
    assert arena.status == lib.VISTA_OK
    side = np.full(graph.node_count, 255, np.uint8)
    arc_link = np.zeros(2 * len(links), np.int32)
    for edge, link in enumerate(links):
        arc = graph.edge_arc[edge]
        arc_link[arc] = arc_link[graph.reverse[arc]] = link
    problem.arc_link, problem.subset = pointer(arc_link), pointer(subset)
    problem.source_link, problem.sink_link = pointer(source), pointer(sink)
    problem.subset_count = len(subset)
    for _ in range(2):  # the second time in used memory
        lib.vista_spanning_forest_grow(forest, graph.graph, problem, ffi.cast("uint8_t *", side.ctypes.data))
    return side


def kruskal(
    count: int, edges: np.ndarray, links: np.ndarray, source: np.ndarray, sink: np.ndarray
) -> np.ndarray:
    """1 where a node's tree holds S, of links that all differ; the two terminals never join."""
    s, t = count, count + 1
    parent = list(range(count + 2))

    def find(node: int) -> int:
        while parent[node] != node:
            node = parent[node]
        return node

    every = [(int(w), int(a), int(b)) for w, (a, b) in zip(links, edges, strict=True)]
    every += [(int(w), s, v) for v, w in enumerate(source)] + [(int(w), t, v) for v, w in enumerate(sink)]
    for link, a, b in sorted(every, reverse=True):
        a, b = find(a), find(b)
        if link > 0 and a != b and {a, b} != {find(s), find(t)}:
            parent[a] = b
    return np.array([find(node) == find(s) for node in range(count)], np.uint8)


def test_against_kruskal() -> None:
    random = seeded(1)
    seen = set()
    for _ in range(150):
        count = int(random.integers(2, 30))
        edges = np.array([(a, b) for a in range(count) for b in range(a) if random.random() < 0.2], np.int32)
        edges = edges.reshape(-1, 2)
        numbers = random.permutation(len(edges) + 2 * count).astype(np.int32) + 1
        links, source, sink = np.split(numbers, [len(edges), len(edges) + count])
        source, sink = (
            np.where(random.random(count) < 0.3, part, 0).astype(np.int32) for part in (source, sink)
        )
        if not len(edges):
            continue
        side = grow(CutGraph(count, edges), links, source, sink, np.arange(count, dtype=np.int32))
        assert side.tolist() == kruskal(count, edges, links, source, sink).tolist()
        seen |= set(side.tolist())
    assert seen == {0, 1}


def test_many_weak_links_do_not_outweigh_a_strong_one() -> None:
    """A minimum cut would add them up: node 1 hangs on S by 5 over node 0, and on T by 4 three times."""
    edges = np.array([[0, 1], [1, 2], [1, 3], [1, 4]], np.int32)
    links, source, sink = (np.array(x, np.int32) for x in ([5, 4, 4, 4], [9, 0, 0, 0, 0], [0, 0, 9, 9, 9]))
    everything = np.arange(5, dtype=np.int32)
    assert grow(CutGraph(5, edges), links, source, sink, everything).tolist() == [1, 1, 0, 0, 0]


@pytest.mark.parametrize(("source", "sink"), [([7, 0], [7, 0]), ([0, 0], [0, 0])])
def test_of_equal_links_the_one_to_the_sink(source: list[int], sink: list[int]) -> None:
    links = (np.array(x, np.int32) for x in ([3], source, sink))
    assert grow(CutGraph(2, np.array([[0, 1]], np.int32)), *links, np.arange(2, dtype=np.int32)).tolist() == [
        0,
        0,
    ]


def test_a_subset() -> None:
    """Nodes outside of it are left alone."""
    graph = CutGraph(4, np.array([[0, 1], [2, 3]], np.int32))
    links, source, sink = (np.array(x, np.int32) for x in ([3, 0], [0, 2, 0, 0], [1, 0, 0, 0]))
    assert grow(graph, links, source, sink, np.array([1, 0], np.int32)).tolist() == [1, 1, 255, 255]
