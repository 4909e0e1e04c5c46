# SPDX-License-Identifier: Apache-2.0
"""Proves that nothing can ever tell a mutated netlist from the whole one: for rtl/flow/mutate_rtl.py.

Registers and memories are cut open: what leaves them comes in from outside, and what they take goes out.
Yosys then merges what is alike in both netlists, and a SAT solver looks for values with which something
differs that goes out. If there are none, both do the same for ever, whatever their state. Registers from
which no way leads to an output or to a memory are taken away before. So no mutant is proved that differs only
in states that are never reached, or that keeps the same things in other places of a memory.
"""

from __future__ import annotations

import sys
from pathlib import Path

from pyosys import libyosys as ys

SECONDS = 60  # that the solver has
GATES = "dffunmap; opt_expr; opt_clean; simplemap; techmap; opt_expr; opt_clean"
SIMPLER = "opt_expr; opt_merge; opt_expr; opt_merge; opt_clean"


def run(design: ys.Design, command: str) -> None:
    ys.run_pass(command, design)


def identifier(name: str) -> ys.IdString:
    return ys.IdString("\\" + name)


def cut_open(module: ys.Module) -> None:
    for cell in list(module.cells_.values()):
        if cell.is_mem_cell():
            name, comes_in = str(cell.name), "RD_DATA"
        elif cell.is_builtin_ff():
            bit = cell.getPort(identifier("Q")).as_bit()
            name, comes_in = f"{bit.wire.name}[{bit.offset}]", "Q"
        else:
            continue
        ports = {str(port)[1:]: signal for port, signal in cell.connections().items()}
        module.remove(cell)
        for port, signal in ports.items():
            if signal.size():
                wire = module.addWire(identifier(f"{name}:{port}"), signal.size())
                wire.port_input, wire.port_output = port == comes_in, port != comes_in
                sides = ys.SigSpec(wire), signal
                module.connect(*(sides if wire.port_output else reversed(sides)))
    module.fixup_ports()


def prepare(design: ys.Design, netlist: Path, name: str, mutation: str = "") -> None:
    """Reads the only module of a netlist, mutates it, and cuts it open."""
    run(design, f"read_rtlil {netlist}")
    run(design, "setundef -zero")
    (old,) = (str(module)[1:] for module in design.modules_ if str(module)[1:] != "whole")
    if mutation:
        run(design, mutation)
    run(design, GATES)
    run(design, f"rename {old} {name}")
    cut_open(design.module(identifier(name)))


def ports_of(module: ys.Module) -> dict[str, ys.Wire]:
    return {str(wire.name): wire for wire in module.wires_.values() if wire.port_input or wire.port_output}


def leave_out(module: ys.Module, other: ys.Module) -> None:
    """Registers that only one of both still has may hold anything, and nothing is asked of what they take."""
    there = ports_of(other)
    for name, wire in ports_of(module).items():
        if name not in there and wire.port_input:
            other.addWire(ys.IdString(name), wire.width).port_input = True
        elif name not in there:
            wire.port_output = False


def main() -> None:
    netlist, *mutation = sys.argv[1:]
    whole = Path(netlist).with_name("whole.il")
    design = ys.Design()
    if not mutation:
        prepare(design, Path(netlist), "whole")
        run(design, f"write_rtlil {whole}")
        return
    run(design, f"read_rtlil {whole}")
    prepare(design, Path(netlist), "changed", *mutation)
    modules = [design.module(identifier(name)) for name in ("whole", "changed")]
    leave_out(*modules)
    leave_out(*reversed(modules))
    for module in modules:
        module.fixup_ports()
    run(design, "miter -equiv -flatten whole changed both; hierarchy -top both")
    run(
        design,
        f"{SIMPLER}; simplemap; techmap; {SIMPLER}; sat -verify -prove trigger 0 -timeout {SECONDS} both",
    )


if __name__ == "__main__":
    main()
