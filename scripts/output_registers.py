"""Moves registers that only follow a block RAM of an ECP5 into its own output registers.

The clock-to-output time of a block RAM is several times shorter with them. Yosys maps every block RAM without
and leaves the registers of the sources behind it in the fabric; the netlist behaves the same after the move.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

Cell = dict[str, Any]
WIDEST = 18  # bits; a port of 36 takes the outputs of both ports
TIED = {"CEMUX": "1", "CLKMUX": "CLK", "REGSET": "RESET", "SD": "1"}  # of a register that can be moved


def move_output_registers(module: dict[str, Any]) -> int:
    """module: of the JSON of Yosys after synth_ecp5, flattened; changed in place. The ports that were given
    output registers."""
    cells = module["cells"]
    loads: dict[int | str, list[tuple[str, str]]] = defaultdict(list)
    for name, cell in cells.items():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "input":
                for bit in bits:
                    loads[bit].append((name, port))
    for port in module["ports"].values():
        if port["direction"] == "output":
            for bit in port["bits"]:
                loads[bit].append(("", "port"))
    moved = 0
    for ram in [cell for cell in cells.values() if cell["type"] == "DP16KD"]:
        if any(int(ram["parameters"][f"DATA_WIDTH_{side}"], 2) > WIDEST for side in "AB"):
            continue
        moved += sum(move(ram, side, cells, loads) for side in "AB")
    return moved


def move(ram: Cell, side: str, cells: dict[str, Cell], loads: dict[int | str, list[tuple[str, str]]]) -> bool:
    """Into one port of a block RAM, if all that it drives are such registers."""
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


def follows(register: Cell, clock: list[int | str]) -> bool:
    """The register has no enable and no reset, and starts at 0 as those of a block RAM do."""
    parameters, connections = register["parameters"], register["connections"]
    return (
        register["type"] == "TRELLIS_FF"
        and all(parameters.get(key, value).strip() == value for key, value in TIED.items())
        and connections.get("LSR", ["0"]) == ["0"]
        and connections["CLK"] == clock
    )
