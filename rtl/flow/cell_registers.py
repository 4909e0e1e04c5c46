# SPDX-License-Identifier: Apache-2.0
"""Moves registers beside block RAMs and multipliers of an ECP5 into the registers of these cells.

A block RAM is several times faster from clock to output with its output registers, and the slow way through a
multiplier ends at its registers rather than beyond further wires. Yosys maps both without and leaves the
registers of the sources beside them in the fabric; the netlist behaves the same after the move.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

Cell = dict[str, Any]
Loads = dict[int | str, list[tuple[str, str]]]  # of a bit: cells and ports; "" for a port of the module
WIDEST = 18  # bits; a port of 36 takes the outputs of both ports
OPERANDS = [f"{operand}{bit}" for operand in "AB" for bit in range(WIDEST)]  # of a multiplier
PRODUCT = [f"P{bit}" for bit in range(2 * WIDEST)]
TIED = {"CEMUX": "1", "CLKMUX": "CLK", "REGSET": "RESET", "SD": "1"}  # of a register that can be moved


def move_registers(module: dict[str, Any]) -> tuple[int, int]:
    """module: of the JSON of Yosys after synth_ecp5, flattened; changed in place. How many ports of block
    RAMs were given output registers, and how many multipliers registers on both sides."""
    cells = module["cells"]
    loads = loads_of(module)
    ports = 0
    for ram in [cell for cell in cells.values() if cell["type"] == "DP16KD"]:
        if any(int(ram["parameters"][f"DATA_WIDTH_{side}"], 2) > WIDEST for side in "AB"):
            continue
        ports += sum(move(ram, side, cells, loads) for side in "AB")
    multipliers = [cell for cell in cells.values() if cell["type"] == "MULT18X18D"]
    return ports, sum(move_both(multiplier, module) for multiplier in multipliers)


def loads_of(module: dict[str, Any]) -> Loads:
    loads: Loads = defaultdict(list)
    for name, cell in module["cells"].items():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "input":
                for bit in bits:
                    loads[bit].append((name, port))
    for port in module["ports"].values():
        if port["direction"] == "output":
            for bit in port["bits"]:
                loads[bit].append(("", "port"))
    return loads


def move(ram: Cell, side: str, cells: dict[str, Cell], loads: Loads) -> bool:
    """Moves registers into one port of a block RAM, if all that it drives are such registers."""
    connections, parameters = ram["connections"], ram["parameters"]
    outputs = [f"DO{side}{bit}" for bit in range(WIDEST)]
    used = {pin: loads[bit] for pin in outputs for bit in connections.get(pin, []) if loads[bit]}
    registers = {pin: to[0][0] for pin, to in used.items() if len(to) == 1 and to[0][1] == "DI"}
    ready = (
        parameters[f"REGMODE_{side}"] == "NOREG"
        and connections[f"OCE{side}"] == ["1"]
        and connections[f"RST{side}"] == ["0"]
        and parameters[f"CLK{side}MUX"] == f"CLK{side}"
    )
    clock = connections[f"CLK{side}"]
    if (
        not (used and ready)
        or registers.keys() != used.keys()
        or not all(follows(cells[name], clock) for name in registers.values())
    ):
        return False
    for pin, name in registers.items():
        connections[pin] = cells.pop(name)["connections"]["Q"]
    parameters[f"REGMODE_{side}"] = "OUTREG"
    return True


def move_both(multiplier: Cell, module: dict[str, Any]) -> bool:
    """Moves registers into a multiplier, if those of one clock are before all of its bits and behind all that
    are used. With those of one side alone, nextpnr would leave the way through the multiplier out of its
    timing."""
    cells, pins, parameters = module["cells"], multiplier["connections"], multiplier["parameters"]
    loads = loads_of(module)
    drivers = {
        cell["connections"]["Q"][0]: name for name, cell in cells.items() if cell["type"] == "TRELLIS_FF"
    }
    inputs = [pin for pin in OPERANDS if pins[pin] != ["0"]]
    outputs = [pin for pin in PRODUCT if pin in pins and loads[pins[pin][0]]]
    before = {pin: drivers.get(pins[pin][0], "") for pin in inputs}
    behind = {pin: alone(loads[pins[pin][0]]) for pin in outputs}
    beside = [cells[name] for name in (*before.values(), *behind.values()) if name]
    clock = beside[0]["connections"]["CLK"] if beside else []
    if (
        parameters
        or len(beside) < len(inputs) + len(outputs)
        or not all(follows(cell, clock) for cell in beside)
    ):
        return False
    for pin, name in before.items():
        pins[pin] = cells[name]["connections"]["DI"]
    for pin, name in behind.items():
        pins[pin] = cells.pop(name)["connections"]["Q"]
    loads = loads_of(module)
    for name in set(before.values()):
        if not loads[cells[name]["connections"]["Q"][0]]:
            del cells[name]
    pins |= {"CLK0": clock, "CE0": ["1"], "RST0": ["0"]}
    multiplier["port_directions"] |= dict.fromkeys(("CLK0", "CE0", "RST0"), "input")
    for stage in ("INPUTA", "INPUTB", "OUTPUT"):
        parameters |= {f"REG_{stage}_CLK": "CLK0", f"REG_{stage}_CE": "CE0", f"REG_{stage}_RST": "RST0"}
    return True


def alone(leads_to: list[tuple[str, str]]) -> str:
    """The register that a bit leads to, if that is all; otherwise nothing."""
    return leads_to[0][0] if len(leads_to) == 1 and leads_to[0][1] == "DI" else ""


def follows(register: Cell, clock: list[int | str]) -> bool:
    """The register has no enable and no reset, and starts at 0 as those of block RAMs and multipliers do."""
    parameters, connections = register["parameters"], register["connections"]
    return (
        register["type"] == "TRELLIS_FF"
        and all(parameters.get(key, value).strip() == value for key, value in TIED.items())
        and connections.get("LSR", ["0"]) == ["0"]
        and connections["CLK"] == clock
    )
