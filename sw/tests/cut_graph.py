"""libvista's graph and max-flow over numpy arrays, for the tests of the cuts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from graph_cases import FlowCase
from stage_library import Arena, ffi, lib, pointer, status_name


@dataclass
class Cut:
    status: str
    value: int
    source_side: np.ndarray  # uint8; 255: not written
    sink_side: np.ndarray


class CutGraph:
    """A built graph with its solver."""

    def __init__(self, node_count: int, edges: np.ndarray) -> None:
        self.node_count = node_count
        self._edges = np.ascontiguousarray(edges, np.int32)
        self.graph = ffi.new("vista_graph *")
        self.maxflow = ffi.new("vista_maxflow *")
        self._arena = Arena(self._layout)
        assert self._arena.status == lib.VISTA_OK, status_name(self._arena.status)
        self.head = self._view("head", 2 * len(edges))
        self.reverse = self._view("reverse", 2 * len(edges))
        self.first_arc = self._view("first_arc", node_count + 1)
        self.edge_arc = self._view("edge_arc", len(edges))

    def _layout(self, arena) -> int:
        status = lib.vista_graph_build(
            self.graph, arena, self.node_count, pointer(self._edges), len(self._edges)
        )
        return status or lib.vista_maxflow_layout(self.maxflow, self.graph, arena)

    def _view(self, name: str, count: int) -> np.ndarray:
        return np.frombuffer(ffi.buffer(getattr(self.graph, name), 4 * count), np.int32)

    def arc_capacity(self, case: FlowCase) -> np.ndarray:
        capacity = np.empty(2 * len(case.edges), np.int32)
        capacity[self.edge_arc] = case.forward
        capacity[self.reverse[self.edge_arc]] = case.backward
        return capacity

    def solver(self, case: FlowCase, with_sink_side: bool = True):
        """A function without arguments that solves the case, so that a bench times the C call alone."""
        arrays = (self.arc_capacity(case), case.source, case.sink, case.subset)
        source_side, sink_side = np.full((2, case.node_count), 255, np.uint8)
        value = ffi.new("int64_t *", -1)
        problem = ffi.new("vista_maxflow_problem *")
        problem.arc_capacity, problem.source_capacity, problem.sink_capacity = map(pointer, arrays[:3])
        if case.subset is not None:
            problem.subset, problem.subset_count = pointer(case.subset), len(case.subset)
        sides = [ffi.cast("uint8_t *", side.ctypes.data) for side in (source_side, sink_side)]
        if not with_sink_side:
            sides[1] = ffi.NULL

        def solve() -> Cut:
            status = lib.vista_maxflow_solve(self.maxflow, problem, *sides, value)
            return Cut(status_name(status), value[0], source_side, sink_side)

        solve.arrays = arrays  # keeps the memory behind the pointers alive
        return solve

    def solve(self, case: FlowCase, with_sink_side: bool = True) -> Cut:
        return self.solver(case, with_sink_side)()


def solve(case: FlowCase, with_sink_side: bool = True) -> Cut:
    return CutGraph(case.node_count, case.edges).solve(case, with_sink_side)
