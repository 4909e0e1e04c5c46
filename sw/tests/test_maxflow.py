"""The max-flow against scipy, and against what a minimum cut has to be."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from cut_graph import Cut, CutGraph, solve
from graph_cases import FlowCase, polar_cases, random_case, real_images, synthetic_image
from random_seed import seeded
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow
from shared_data import SHARED_DATA
from stage_library import Arena, ffi, lib, pointer, status_name

RANDOM_GRAPHS = 1000
ARC_CAPACITY_MAX = (1 << 30) - 1
INT32_MAX = (1 << 31) - 1


def members(case: FlowCase) -> np.ndarray:
    return np.arange(case.node_count) if case.subset is None else case.subset


def capacity_matrix(case: FlowCase) -> csr_matrix:
    """The network of the subset with S and T as the last two nodes; S -> v -> T is kept as two arcs."""
    inside = np.zeros(case.node_count, bool)
    inside[members(case)] = True
    kept = inside[case.edges].all(axis=1)
    u, v = case.edges[kept].T
    nodes = np.flatnonzero(inside)
    source, sink = np.full((2, nodes.size), case.node_count)
    sink = sink + 1
    tails = np.concatenate([u, v, source, nodes])
    heads = np.concatenate([v, u, nodes, sink])
    values = np.concatenate([case.forward[kept], case.backward[kept], case.source[nodes], case.sink[nodes]])
    size = case.node_count + 2
    return csr_matrix((values.astype(np.int32), (tails, heads)), shape=(size, size))


def scipy_cut(case: FlowCase) -> tuple[int, np.ndarray, np.ndarray]:
    """Value, nodes that S reaches and nodes that reach T in the residual graph of scipy's maximum flow."""
    capacity = capacity_matrix(case)
    source, sink = case.node_count, case.node_count + 1
    result = maximum_flow(capacity, source, sink)
    residual = (capacity - result.flow).tocsr()
    residual.data = (residual.data > 0).astype(np.int32)
    residual.eliminate_zeros()
    sides = []
    for graph, start in ((residual, source), (residual.T.tocsr(), sink)):
        reached = np.zeros(case.node_count + 2, np.uint8)
        reached[breadth_first_order(graph, start, return_predecessors=False)] = 1
        sides.append(reached[members(case)])
    return int(result.flow_value), sides[0], sides[1]


def cut_weight(case: FlowCase, source_side: np.ndarray) -> int:
    """Capacity from the source side (1) to the rest (0), over the arcs inside the subset."""
    side = np.full(case.node_count, 255, np.int64)
    side[members(case)] = source_side[members(case)]
    a, b = side[case.edges].T
    inside = (a != 255) & (b != 255)
    weight = case.forward[inside & (a > b)].sum(dtype=np.int64)
    weight += case.backward[inside & (a < b)].sum(dtype=np.int64)
    nodes = members(case)
    weight += case.source[nodes][side[nodes] == 0].sum(dtype=np.int64)
    return int(weight + case.sink[nodes][side[nodes] == 1].sum(dtype=np.int64))


def assert_equals_scipy(case: FlowCase, cut: Cut, label: object) -> None:
    value, source_side, sink_side = scipy_cut(case)
    nodes = members(case)
    assert cut.status == "VISTA_OK", label
    assert cut.value == value, label
    assert np.array_equal(cut.source_side[nodes], source_side), label
    assert np.array_equal(cut.sink_side[nodes], sink_side), label
    assert cut_weight(case, cut.source_side) == value, label
    assert cut_weight(case, 1 - cut.sink_side) == value, label
    outside = np.setdiff1d(np.arange(case.node_count), nodes)
    assert (cut.source_side[outside] == 255).all() and (cut.sink_side[outside] == 255).all(), label


@pytest.mark.slow
def test_random_graphs_equal_scipy() -> None:
    rng = seeded(2)
    for index in range(RANDOM_GRAPHS):
        case = random_case(rng)
        assert_equals_scipy(case, solve(case), (index, case.name))


def test_polar_graphs_of_a_synthetic_image_equal_scipy() -> None:
    for case in polar_cases("synthetic image", synthetic_image(3), seed=3):
        assert_equals_scipy(case, solve(case), case.name)


@pytest.mark.slow
def test_polar_graphs_of_real_images_equal_scipy() -> None:
    images = real_images()
    if not images:
        pytest.skip("no images under VISTA_SHARED_DATA")
    for name, path in images:
        for case in polar_cases(name, cv2.imread(str(path), cv2.IMREAD_GRAYSCALE).astype(float), seed=5):
            assert_equals_scipy(case, solve(case), case.name)


def test_cuts_of_a_real_frame_equal_scipy() -> None:
    street = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
    if not street.is_dir():
        pytest.skip(f"no {street}")
    from frame_cases import isolating_cuts

    cases = isolating_cuts(street / "image_0/000020.png", street / "image_1/000020.png", 707.0912, 0.53715)
    assert len(cases) > 50
    for case in cases[::4]:
        assert_equals_scipy(case, solve(case), case.name)


@pytest.mark.slow
def test_one_solver_for_many_subsets_keeps_nothing_from_the_last_cut() -> None:
    rng = seeded(4)
    (case, *_) = polar_cases("synthetic image", synthetic_image(4), seed=4)
    graph = CutGraph(case.node_count, case.edges)
    for index in range(60):
        case.source[:] = case.sink[:] = 0
        case.subset = rng.permutation(case.node_count)[: rng.integers(1, case.node_count)].astype(np.int32)
        seeds = rng.choice(case.subset, min(40, case.subset.size), replace=False)
        case.source[seeds[::2]], case.sink[seeds[1::2]] = 500, 700
        assert_equals_scipy(case, graph.solve(case), index)


def assert_grows_alike(case: FlowCase) -> int:
    """Returns how many nodes the search left out."""
    graph = CutGraph(case.node_count, case.edges)
    whole = graph.solve(case)
    inside = np.zeros(case.node_count, bool)
    inside[members(case)] = True
    full = np.where(inside[graph.head], graph.arc_capacity(case), 0)
    capacity, source, sink = (np.full(n, -1, np.int32) for n in (full.size, *2 * [case.node_count]))
    opened = []

    @ffi.callback("void(void *, int32_t)")
    def open_node(_context: object, node: int) -> None:
        arcs = slice(graph.first_arc[node], graph.first_arc[node + 1])
        capacity[arcs], source[node], sink[node] = full[arcs], case.source[node], case.sink[node]
        opened.append(node)

    starts = np.flatnonzero(inside & (case.source > case.sink)).astype(np.int32)
    arrays = [pointer(array) for array in (capacity, source, sink, starts)]
    problem = ffi.new("vista_maxflow_problem *", [*arrays, starts.size, open_node])
    side, value = np.full(case.node_count, 255, np.uint8), ffi.new("int64_t *")
    out = ffi.cast("uint8_t *", side.ctypes.data)
    assert status_name(lib.vista_maxflow_solve(graph.maxflow, problem, out, ffi.NULL, value)) == "VISTA_OK"
    assert len(opened) == len(set(opened)) and inside[opened].all()
    assert np.array_equal(side[opened], whole.source_side[opened])
    never = np.setdiff1d(members(case), opened)
    assert (side[never] == 255).all() and (whole.source_side[never] == 0).all()
    assert (
        status_name(lib.vista_maxflow_solve(graph.maxflow, problem, out, out, value))
        == "VISTA_ERROR_ARGUMENT"
    )
    return int(never.size)


def test_a_network_that_grows_gives_the_source_side_of_the_whole() -> None:
    rng = seeded(6)
    assert sum(assert_grows_alike(random_case(rng)) for _ in range(300)) > 0


def test_a_growing_network_refuses_bad_capacities() -> None:
    case = chain(5, 9)
    graph = CutGraph(case.node_count, case.edges)
    capacity, starts = graph.arc_capacity(case), np.array([0], np.int32)
    open_node = ffi.callback("void(void *, int32_t)", lambda _context, _node: None)
    for bad, status in ((-1, "VISTA_ERROR_RANGE"), (ARC_CAPACITY_MAX + 1, "VISTA_ERROR_OVERFLOW")):
        capacity[graph.first_arc[1] : graph.first_arc[2]] = bad
        arrays = [pointer(array) for array in (capacity, case.source, case.sink, starts)]
        problem = ffi.new("vista_maxflow_problem *", [*arrays, 1, open_node])
        side, value = np.full(case.node_count, 255, np.uint8), ffi.new("int64_t *")
        out = ffi.cast("uint8_t *", side.ctypes.data)
        assert status_name(lib.vista_maxflow_solve(graph.maxflow, problem, out, ffi.NULL, value)) == status
        assert (side == 255).all()


def test_flow_beyond_32_bits_scales_with_the_capacities() -> None:
    (*_, case) = polar_cases("synthetic image", synthetic_image(8), seed=8)
    factor = ARC_CAPACITY_MAX // int(max(case.forward.max(), case.source.max(), case.sink.max()))
    small = solve(case)
    capacities = ("forward", "backward", "source", "sink")
    scaled = {name: getattr(case, name) * np.int32(factor) for name in capacities}
    large = solve(replace(case, **scaled))
    assert large.value == factor * small.value > INT32_MAX
    assert np.array_equal(large.source_side, small.source_side)
    assert np.array_equal(large.sink_side, small.sink_side)


def chain(arc_capacity: int, terminal_capacity: int) -> FlowCase:
    """S -> 0 - 1 - 2 -> T."""
    capacity = np.full(2, arc_capacity, np.int32)
    source, sink = np.array([(terminal_capacity, 0, 0), (0, 0, terminal_capacity)], np.int32)
    return FlowCase("chain", 3, np.array([(0, 1), (1, 2)], np.int32), capacity, capacity.copy(), source, sink)


def test_largest_capacities_are_exact() -> None:
    cut = solve(chain(ARC_CAPACITY_MAX, INT32_MAX))
    assert cut.value == ARC_CAPACITY_MAX
    assert cut.source_side.tolist() == [1, 0, 0] and cut.sink_side.tolist() == [0, 0, 1]
    both = chain(0, INT32_MAX)
    both.source[:] = both.sink[:] = INT32_MAX
    assert solve(both).value == 3 * INT32_MAX


def test_without_sink_side_the_rest_is_the_same() -> None:
    rng = seeded(10)
    cases = [random_case(rng) for _ in range(500)]
    cases += polar_cases("synthetic image", synthetic_image(10), seed=10)
    for index, case in enumerate(cases):
        graph = CutGraph(case.node_count, case.edges)
        expected, got = graph.solve(case), graph.solve(case, with_sink_side=False)
        again = graph.solve(case)
        assert got.value == expected.value == again.value, (index, case.name)
        assert np.array_equal(got.source_side, expected.source_side), (index, case.name)
        assert np.array_equal(again.sink_side, expected.sink_side), (index, case.name)
        assert (got.sink_side == 255).all(), (index, case.name)


BAD_PROBLEMS = {
    "negative arc": ("forward", 1, -1, "VISTA_ERROR_RANGE"),
    "negative sister arc": ("backward", 0, -(1 << 31), "VISTA_ERROR_RANGE"),
    "negative source capacity": ("source", 1, -1, "VISTA_ERROR_RANGE"),
    "negative sink capacity": ("sink", 0, -7, "VISTA_ERROR_RANGE"),
    "arc above the largest": ("forward", 0, ARC_CAPACITY_MAX + 1, "VISTA_ERROR_OVERFLOW"),
    "sister above the largest": ("backward", 1, INT32_MAX, "VISTA_ERROR_OVERFLOW"),
}


@pytest.mark.parametrize("name", BAD_PROBLEMS)
def test_bad_capacities_are_refused_and_leave_the_solver_usable(name: str) -> None:
    array, index, value, expected = BAD_PROBLEMS[name]
    case = chain(5, 9)
    graph = CutGraph(case.node_count, case.edges)
    good = getattr(case, array)[index]
    getattr(case, array)[index] = value
    refused = graph.solve(case)
    assert (refused.status, refused.value) == (expected, -1)
    assert (refused.source_side == 255).all() and (refused.sink_side == 255).all()
    getattr(case, array)[index] = good
    assert (graph.solve(case).status, graph.solve(case).value) == ("VISTA_OK", 5)


@pytest.mark.parametrize("subset", [(0, 3), (-1,), (1, 2, 1), (0, 1, 2, 0)])
def test_bad_subsets_are_refused_and_leave_the_solver_usable(subset: tuple[int, ...]) -> None:
    case = chain(5, 9)
    graph = CutGraph(case.node_count, case.edges)
    refused = graph.solve(replace(case, subset=np.array(subset, np.int32)))
    assert (refused.status, refused.value) == ("VISTA_ERROR_RANGE", -1)
    assert (refused.source_side == 255).all()
    assert graph.solve(case).value == 5


def test_capacities_outside_the_subset_do_not_matter() -> None:
    case = replace(chain(5, 9), subset=np.array([0, 1], np.int32))
    case.backward[1], case.source[2], case.sink[2] = -1, -1, -1
    case.forward[1] = ARC_CAPACITY_MAX  # leaves the subset, so it carries nothing
    case.sink[1] = 3
    cut = solve(case)
    assert (cut.status, cut.value, cut.source_side.tolist()) == ("VISTA_OK", 3, [1, 1, 255])


def test_a_negative_subset_and_short_memory_are_refused() -> None:
    case = chain(5, 9)
    graph = CutGraph(case.node_count, case.edges)
    capacity, side, value = graph.arc_capacity(case), np.zeros(3, np.uint8), ffi.new("int64_t *")
    arrays = [pointer(capacity), pointer(case.source), pointer(case.sink), pointer(capacity), -1]
    problem = ffi.new("vista_maxflow_problem *", arrays)
    status = lib.vista_maxflow_solve(
        graph.maxflow, problem, ffi.cast("uint8_t *", side.ctypes.data), ffi.NULL, value
    )
    assert status_name(status) == "VISTA_ERROR_RANGE"

    fresh = ffi.new("vista_maxflow *")
    short = Arena(lambda arena: lib.vista_maxflow_layout(fresh, graph.graph, arena), missing_bytes=1)
    assert status_name(short.status) == "VISTA_ERROR_MEMORY"
