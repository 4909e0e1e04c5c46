"""Max-flow of libvista beside PyMaxflow (Boykov-Kolmogorov 3.04): same graphs, same run, answers compared.

What is counted:
  vista S       the whole call, as the recursive bipartition makes it: checks, capacities, flow, source side
  vista S+T     the same with the labels of the sink side
  peer flow     maxflow() on a graph that is ready
  peer whole    construction of the graph in PyMaxflow's bulk calls, maxflow(), labels
Times are CPU times of the thread, so that other load on the machine counts for neither. The ratios are
those of the peer to "vista S".

    bench_maxflow.py [--repetitions 21] [--out build/bench/maxflow.json]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "sw" / "tests"), str(REPOSITORY / "build" / "python")]

from cut_graph import CutGraph  # noqa: E402
from frame_cases import isolating_cuts  # noqa: E402
from graph_cases import (  # noqa: E402
    SEED_CAPACITY,
    FlowCase,
    polar_cases,
    real_images,
    seed_case,
    synthetic_image,
)
from shared_data import SHARED_DATA  # noqa: E402
from vista_eval.report.table import Table, span, write_measurement  # noqa: E402

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"

try:
    import maxflow as peer
except ImportError:
    peer = None

SEED = 11
Result = TypeVar("Result")
RECURSIVE_CORES = 40


def timed_ms(call: Callable[[], Result]) -> tuple[float, Result]:
    start = time.thread_time_ns()
    result = call()
    return (time.thread_time_ns() - start) / 1e6, result


class PeerCut:
    """One cut by PyMaxflow, its nodes numbered anew within the subset; the renumbering is not timed."""

    def __init__(self, case: FlowCase) -> None:
        self.nodes = np.arange(case.node_count) if case.subset is None else case.subset
        number = np.full(case.node_count, -1)
        number[self.nodes] = np.arange(self.nodes.size)
        ends = number[case.edges]
        kept = (ends >= 0).all(axis=1)
        self.tails, self.heads = np.ascontiguousarray(ends[kept].T)
        self.forward, self.backward = case.forward[kept], case.backward[kept]
        self.source, self.sink = case.source[self.nodes], case.sink[self.nodes]

    def run(self) -> tuple[float, float, int, np.ndarray]:
        """Milliseconds of maxflow() and of the whole, flow, and the nodes that reach T."""
        start = time.thread_time_ns()
        graph = peer.GraphInt(self.nodes.size, self.tails.size)
        ids = graph.add_nodes(self.nodes.size)
        graph.add_edges(self.tails, self.heads, self.forward, self.backward)
        graph.add_grid_tedges(ids, self.source, self.sink)
        flow_ms, value = timed_ms(graph.maxflow)
        sink_side = graph.get_grid_segments(ids)
        return flow_ms, (time.thread_time_ns() - start) / 1e6, int(value), sink_side


def summary(samples_ms: list[float]) -> dict[str, float]:
    low, median, high = np.percentile(samples_ms, [10, 50, 90])
    return {"median_ms": float(median), "p10_ms": float(low), "p90_ms": float(high)}


def measure(name: str, cases: list[FlowCase], repetitions: int) -> dict:
    """Times all cases one after the other as one sample, turn about with the peer."""
    graph = CutGraph(cases[0].node_count, cases[0].edges)
    solvers = [graph.solver(case, with_sink_side=False) for case in cases]
    full_solvers = [graph.solver(case) for case in cases]
    peers = [PeerCut(case) for case in cases] if peer else []
    vista_ms, full_ms, flow_ms, whole_ms = [], [], [], []
    for _ in range(repetitions):
        vista_ms.append(sum(timed_ms(solve)[0] for solve in solvers))
        full_ms.append(sum(timed_ms(solve)[0] for solve in full_solvers))
        results = [cut.run() for cut in peers]
        flow_ms.append(sum(result[0] for result in results))
        whole_ms.append(sum(result[1] for result in results))
    answers = [solve() for solve in full_solvers]
    for answer, solve in zip(answers, solvers, strict=True):
        if answer.value != solve().value or not np.array_equal(answer.source_side, solve().source_side):
            raise SystemExit(f"bench_maxflow: {name}: the source side depends on asking for the sink side")
    row = {
        "name": name,
        "cuts": len(cases),
        "nodes": sum(case.node_count if case.subset is None else case.subset.size for case in cases),
        "value": sum(answer.value for answer in answers),
        "vista": summary(vista_ms),
        "vista_both_sides": summary(full_ms),
    }
    if peer:
        for answer, cut, result in zip(answers, peers, results, strict=True):
            if answer.value != result[2] or not np.array_equal(answer.sink_side[cut.nodes], result[3]):
                raise SystemExit(f"bench_maxflow: {name}: the answers differ")
        row |= {"peer_flow": summary(flow_ms), "peer_whole": summary(whole_ms)}
        row["ratio_flow"] = row["peer_flow"]["median_ms"] / row["vista"]["median_ms"]
        row["ratio_whole"] = row["peer_whole"]["median_ms"] / row["vista"]["median_ms"]
    return row


def recursive_cuts(image: np.ndarray) -> list[FlowCase]:
    """Seed after seed is cut out of what is left of one graph, as the recursive bipartition does."""
    case = seed_case("recursive", image, SEED)
    case.source[:] = case.sink[:] = 0
    rng = np.random.default_rng(SEED)
    seeds = rng.choice(case.node_count, RECURSIVE_CORES, replace=False)
    graph = CutGraph(case.node_count, case.edges)
    left = np.ones(case.node_count, bool)
    cuts = []
    for seed in seeds:
        others = seeds[left[seeds] & (seeds != seed)]
        if not left[seed] or others.size == 0:
            continue
        source, sink = np.zeros((2, case.node_count), np.int32)
        source[seed], sink[others] = SEED_CAPACITY, SEED_CAPACITY
        cut = replace(case, source=source, sink=sink, subset=np.flatnonzero(left).astype(np.int32))
        left[graph.solve(cut).source_side == 1] = False
        cuts.append(cut)
    return cuts


def print_row(row: dict) -> None:
    def cell(times: dict[str, float]) -> str:
        return f"{times['median_ms']:8.3f} ({times['p10_ms']:.3f}..{times['p90_ms']:.3f})".ljust(28)

    text = f"{row['name'][-48:]:48s} {row['cuts']:4d} {row['nodes']:7d} {cell(row['vista'])}"
    text += cell(row["vista_both_sides"])
    if peer:
        text += f"{cell(row['peer_flow'])}{cell(row['peer_whole'])}"
        text += f"{row['ratio_flow']:6.2f} {row['ratio_whole']:6.2f}"
    print(text, flush=True)


def grouped(rows: list[dict]) -> dict:
    """The least and the largest figures of the graphs of each kind, and the means of all."""
    groups: dict[str, list[dict]] = {}
    for row in rows:
        groups.setdefault(row["name"].rpartition(", ")[2], []).append(row)

    def ends(values: list[float]) -> list[float]:
        return [round(min(values), 2), round(max(values), 2)]

    means = {
        key: round(statistics.geometric_mean(row[key] for row in rows), 2)
        for key in ("ratio_flow", "ratio_whole")
    }
    return {
        "groups": [
            {
                "graphs": name,
                "vista_ms": ends([row["vista"]["median_ms"] for row in members]),
                **{key: ends([row[key] for row in members]) for key in means},
            }
            for name, members in groups.items()
        ],
        "geometric_mean": means | {"rows": len(rows)},
    }


def table_of(found: dict) -> Table:
    keys, mean = ("vista_ms", "ratio_flow", "ratio_whole"), found["geometric_mean"]
    rows = [(group["graphs"], *(span(group[key]) for key in keys)) for group in found["groups"]]
    rows.append(
        (
            f"geometric mean of {mean['rows']} graphs",
            "",
            f"{mean['ratio_flow']:g}",
            f"{mean['ratio_whole']:g}",
        )
    )
    heads = (
        "graphs",
        "libvista: whole call, ms",
        "PyMaxflow's `maxflow()` alone, times as long",
        "PyMaxflow with construction, times as long",
    )
    return Table("maxflow", heads, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description="Time the max-flow of libvista beside PyMaxflow.")
    parser.add_argument("--repetitions", type=int, default=21)
    parser.add_argument("--out", type=Path, default=REPOSITORY / "build" / "bench" / "maxflow.json")
    options = parser.parse_args()

    images = [("synthetic image", synthetic_image(SEED))]
    images += [
        (name, np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), float)) for name, path in real_images()
    ]
    if peer is None:
        print("peer absent: PyMaxflow is not installed (scripts/setup.sh bench); libvista alone")
    print("median (p10..p90) in ms of CPU time; x: peer / vista S")
    print(
        f"{'graph':48s} cuts   nodes {'vista S':28s}{'vista S+T':28s}"
        f"{'peer flow':28s}{'peer whole':28s}x flow x whole"
    )
    rows = []
    for name, image in images:
        for case in polar_cases(name, image, SEED):
            rows.append(measure(case.name, [case], options.repetitions))
            print_row(rows[-1])
        rows.append(measure(f"{name}, recursive", recursive_cuts(image), options.repetitions))
        print_row(rows[-1])
    if STREET.is_dir():
        cuts = isolating_cuts(STREET / "image_0/000020.png", STREET / "image_1/000020.png", 707.0912, 0.53715)
        rows.append(measure("the host's own cuts, street frame 20", cuts, options.repetitions))
        print_row(rows[-1])
    if peer:
        for key in ("ratio_flow", "ratio_whole"):
            ratios = [row[key] for row in rows]
            print(f"{key}: geometric mean {np.exp(np.mean(np.log(ratios))):.2f}, least {min(ratios):.2f}")
    found = grouped(rows) if peer else {}
    write_measurement(options.out, [table_of(found)] if peer else [], found, rows=rows)


if __name__ == "__main__":
    main()
