# SPDX-License-Identifier: Apache-2.0
"""The test plan of the RTL traces in both directions: what its points name is there, and each bench, proof
and group of bins belongs to a point."""

import pytest
from evidence import ROOT, TESTPLAN, named, read
from traced import bins, checks_in, is_there, proofs

POINTS = read(TESTPLAN)["point"]
NAMED = set(named(POINTS))
# The folders and files whose tests all have to belong to a point.
TRACED = [
    *sorted((ROOT / "tb").glob("*/bench_*.py")),
    *sorted((ROOT / "tb").rglob("test_*.py")),
    ROOT / "rtl/flow/tests/test_soak_packets.py",
    ROOT / "rtl/flow/tests/test_release.py",
    ROOT / "rtl/flow/tests/test_netlist.py",
    ROOT / "sw/tests/test_board_sim.py",
]
RUNS_THE_BENCHES = "test_unit"


def untraced(known: set[tuple[str, str]]) -> set[str]:
    """What belongs to no point."""
    tests = {
        f"{file.relative_to(ROOT)}::{name}"
        for file in TRACED
        for name in checks_in(file)
        if name != RUNS_THE_BENCHES and ("test", f"{file.relative_to(ROOT)}::*") not in known
    }
    everything = {"test": tests, "proof": proofs(), "bins": bins()}
    return {f"{kind}: {name}" for kind, names in everything.items() for name in names} - {
        f"{kind}: {name}" for kind, name in known
    }


@pytest.mark.parametrize(("kind", "name"), sorted(NAMED))
def test_what_a_point_names_is_there(kind: str, name: str) -> None:
    assert kind in ("test", "proof", "bins") and is_there(kind, name)


def test_each_point_has_an_id_of_its_own_and_evidence() -> None:
    assert len({point["id"] for point in POINTS}) == len(POINTS)
    assert all(point["text"] and point["part"] and point["evidence"] for point in POINTS)


def test_each_bench_proof_and_group_of_bins_belongs_to_a_point() -> None:
    assert untraced(NAMED) == set()


@pytest.mark.parametrize(
    ("kind", "name"),
    [("proof", "vista_levels"), ("bins", "core.fault"),
     ("test", "tb/units/bench_winner.py::smallest_cost_wins_and_ties_go_up")],
)  # fmt: skip
def test_what_belongs_to_no_point_is_noticed(kind: str, name: str) -> None:
    assert untraced(NAMED - {(kind, name)}) == {f"{kind}: {name}"}


def test_each_bench_is_of_a_module_that_is_built() -> None:
    built = (ROOT / "tb" / "test_units.py").read_text()
    benches = [file.stem.removeprefix("bench_") for file in (ROOT / "tb" / "units").glob("bench_*.py")]
    assert benches and [b for b in benches if f'("vista_{b}", ' not in built and f'"{b}",' not in built] == []
