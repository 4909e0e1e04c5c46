"""The half-edge graph against its definition."""

from __future__ import annotations

import numpy as np
import pytest
from cut_graph import CutGraph
from graph_cases import polar_edges
from random_seed import seeded
from stage_library import Arena, ffi, lib, pointer, status_name

RINGS, SECTORS = 7, 12


def build(node_count: int, edges: np.ndarray, missing_bytes: int = 0) -> str:
    graph = ffi.new("vista_graph *")
    edges = np.ascontiguousarray(edges, np.int32)

    def layout(arena) -> int:
        return lib.vista_graph_build(graph, arena, node_count, pointer(edges), len(edges))

    return status_name(Arena(layout, missing_bytes).status)


def test_arcs_are_the_half_edges_sorted_by_tail() -> None:
    rng = seeded(1)
    for _ in range(50):
        node_count = int(rng.integers(2, 40))
        edges = rng.integers(0, node_count, (int(rng.integers(0, 120)), 2)).astype(np.int32)
        edges = edges[edges[:, 0] != edges[:, 1]]
        graph = CutGraph(node_count, edges)
        tail = np.repeat(np.arange(node_count), np.diff(graph.first_arc))
        assert graph.first_arc[0] == 0 and graph.first_arc[-1] == 2 * len(edges)
        assert np.array_equal(tail[graph.edge_arc], edges[:, 0])
        assert np.array_equal(graph.head[graph.edge_arc], edges[:, 1])
        sisters = graph.reverse[graph.edge_arc]
        assert np.array_equal(np.sort(np.concatenate([graph.edge_arc, sisters])), np.arange(2 * len(edges)))
        assert np.array_equal(graph.reverse[sisters], graph.edge_arc)
        assert np.array_equal(tail[graph.reverse], graph.head)


def test_polar_grid_has_the_degrees_of_its_definition() -> None:
    graph = CutGraph(1 + RINGS * SECTORS, polar_edges(RINGS, SECTORS))
    degree = np.diff(graph.first_arc)
    assert degree[0] == SECTORS
    assert (degree[1:-SECTORS] == 4).all()
    assert (degree[-SECTORS:] == 3).all()


@pytest.mark.parametrize("edge", [(0, 3), (3, 0), (-1, 0), (0, -1), (1, 1), (2**31 - 1, 0)])
def test_edges_outside_the_graph_and_self_loops_are_refused(edge: tuple[int, int]) -> None:
    assert build(3, np.array([(0, 1), edge])) == "VISTA_ERROR_RANGE"


def test_sizes_are_checked() -> None:
    graph, arena = ffi.new("vista_graph *"), ffi.new("vista_arena *")
    edge = np.array([0, 1], np.int32)

    def status(graph, arena, node_count, edges, edge_count) -> str:
        return status_name(lib.vista_graph_build(graph, arena, node_count, edges, edge_count))

    assert status(graph, arena, 0, pointer(edge), 1) == "VISTA_ERROR_RANGE"
    assert status(graph, arena, 2, pointer(edge), -1) == "VISTA_ERROR_RANGE"
    assert status(graph, arena, 2, pointer(edge), 1 << 30) == "VISTA_ERROR_RANGE"
    assert status(graph, arena, 2, ffi.NULL, 1) == "VISTA_OK"  # counting reads no edges
    assert graph.arc_count == 2 and graph.head == ffi.NULL


def test_memory_one_byte_short_is_refused() -> None:
    edges = np.array([(0, 1), (1, 2)])
    assert build(3, edges) == "VISTA_OK"
    assert build(3, edges, missing_bytes=1) == "VISTA_ERROR_MEMORY"
