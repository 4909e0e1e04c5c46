# SPDX-License-Identifier: Apache-2.0
"""A mutation is proved to be equivalent if nothing can show it, and no other is."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

PROOF = Path(__file__).resolve().parents[1] / "equivalent_mutant.py"
SOURCE = """
module adder (input clk_i, input [3:0] a_i, input [3:0] b_i, input [1:0] place_i, output reg [2:0] high_o);
  reg [3:0] sum_q, held [3:0];
  always @(posedge clk_i) begin
    sum_q         <= a_i + b_i;
    held[place_i] <= a_i;
    high_o        <= sum_q[3:1] ^ held[place_i][3:1];
  end
endmodule
"""
PREPARE = """
from pyosys import libyosys as ys
design = ys.Design()
for command in ("read_verilog -sv adder.v", "proc; memory_collect; opt_clean", "write_rtlil netlist.il"):
    ys.run_pass(command, design)
"""


def yosys(folder: Path, *arguments: str) -> int:
    return subprocess.run([sys.executable, *arguments], cwd=folder, capture_output=True).returncode


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("adder")
    (folder / "adder.v").write_text(SOURCE)
    assert yosys(folder, "-c", PREPARE) == 0
    assert yosys(folder, str(PROOF), "netlist.il") == 0
    return folder


@pytest.mark.parametrize(
    ("kind", "port", "bit", "equivalent"),
    [
        ("$add", "Y", 0, True),  # which nothing looks at
        ("$add", "B", 0, False),  # which is carried
        ("$add", "Y", 1, False),
        ("$xor", "A", 2, False),
        ("$mem_v2", "RD_DATA", 0, True),
        ("$mem_v2", "RD_DATA", 1, False),
        ("$mem_v2", "WR_ADDR", 0, False),
    ],
)
def test_only_what_nothing_shows_is_proved(
    folder: Path, kind: str, port: str, bit: int, equivalent: bool
) -> None:
    (cell,) = re.findall(rf"cell {re.escape(kind)} (\S+)", (folder / "netlist.il").read_text())
    mutation = f"mutate -mode inv -module adder -cell {cell} -port {port} -portbit {bit}"
    assert (yosys(folder, str(PROOF), "netlist.il", mutation) == 0) == equivalent
