# SPDX-License-Identifier: Apache-2.0
"""The slowest path of a clock, from a short report in the format that common/kernel/report.cc of nextpnr has.

It was written by hand: a path between two registers of three wires, and one that comes from a pin."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from nextpnr_report import Record, critical_path, sentence, signal
from synthesis_tables import with_slowest_paths

REPORT = Path(__file__).with_name("nextpnr_report.json")


@pytest.fixture
def report() -> Record:
    found: Record = json.loads(REPORT.read_text())
    return found


def clock_of(report: Record) -> str:
    (clock,) = report["fmax"]
    return str(clock)


def test_the_path_takes_a_period_of_the_clock_that_is_reached(report: Record) -> None:
    clock = clock_of(report)
    path = critical_path(report, clock)
    assert path["ns"] == pytest.approx(1000 / report["fmax"][clock]["achieved"], abs=0.06)
    assert (path["wires_ns"], path["cells"]) == (3.3, 2)
    assert (path["from"], path["to"]) == ("u_result_fifo.read_ptr_q", "u_result_fifo.ahead_claimed_q")


def test_another_clock_has_no_path(report: Record) -> None:
    assert critical_path(report, "eth_clk") == {}


def test_the_slowest_of_several_paths_counts_and_none_that_leaves_the_clock(report: Record) -> None:
    clock = clock_of(report)
    slowest = critical_path(report, clock)
    longer = json.loads(json.dumps(next(p for p in report["critical_paths"] if p["from"] == p["to"])))
    longer["path"][0]["delay"] += 1
    asynchronous = longer | {"to": "<async>"}
    asynchronous["path"] = [part | {"delay": 50} for part in longer["path"]]
    report["critical_paths"] += [asynchronous, longer]
    assert critical_path(report, clock)["ns"] == pytest.approx(slowest["ns"] + 1, abs=0.05)


@pytest.mark.parametrize(
    ("cell", "name"),
    [
        ("u_core.u_framer.lost_q_TRELLIS_FF_Q", "u_core.u_framer.lost_q"),
        ("u_core.u_winner.gen_level[0].cost_q_LUT4_Z_3_D_CCU2C_S0", "u_core.u_winner.gen_level[0].cost_q"),
        ("u_words.mem.0.1", "u_words.mem.0.1"),
        ("u_core.$auto$alumacc.cc:512$34_CCU2C", "u_core"),
        ("$auto$alumacc.cc:512$34_CCU2C", "logic"),
    ],
)
def test_cells_go_by_the_signal_that_they_make(cell: str, name: str) -> None:
    assert signal(cell) == name


def test_a_line_of_the_table(report: Record) -> None:
    path = critical_path(report, clock_of(report))
    assert sentence(path) == (
        f"`{path['from']}` to `{path['to']}`, {path['cells']} cells, {path['ns']:.1f} ns, "
        f"{path['wires_ns']:.1f} of them in wires"
    )
    table = with_slowest_paths(["build", "MHz"], [["a", "1"], ["b", "2"]], [{"critical_path": path}, {}])
    assert table["heads"] == ["build", "MHz", "slowest path"]
    assert table["rows"] == [["a", "1", sentence(path)], ["b", "2", ""]]


def test_a_table_without_paths_has_no_column_for_them() -> None:
    assert with_slowest_paths(["build", "MHz"], [["a", "1"]], [{}])["heads"] == ["build", "MHz"]
