# SPDX-License-Identifier: Apache-2.0
"""Folds gates in front of the carry chains of an ECP5 into the lookup tables of the chains.

A bit of a chain has a lookup table of four inputs, of which an addition takes two. Yosys leaves a gate that
inverts or clears one operand in a lookup table of its own; the netlist behaves the same after the fold.

The table of a bit gives the sum without carry. Where that is 0 the carry is what its lower four entries, a
table of A and B, say: both operands are equal there, so the one without the gate will do.
"""

from __future__ import annotations

from itertools import product
from typing import Any

from cell_registers import Cell, Loads, loads_of

ADDITION = 0x96AA  # A ^ B ^ C with D at 1; carries A


def fold_gates(module: dict[str, Any]) -> int:
    """How many gates were folded. module: of the JSON of Yosys after synth_ecp5, flat; changed in place."""
    cells, loads = module["cells"], loads_of(module)
    gates = {
        cell["connections"]["Z"][0]: name
        for name, cell in cells.items()
        if cell["type"] == "LUT4" and len(varying(cell)) == 2
    }
    adders = [cell for cell in cells.values() if cell["type"] == "CCU2C"]
    return sum(fold(adder, bit, cells, gates, loads) for adder in adders for bit in "01")


def fold(adder: Cell, bit: str, cells: dict[str, Cell], gates: dict[int, str], loads: Loads) -> bool:
    """Moves a gate into one bit of a carry chain, if one of its operands comes from a gate that nothing else
    needs."""
    pins, init = adder["connections"], f"INIT{bit}"
    if int(adder["parameters"][init], 2) != ADDITION or (pins[f"C{bit}"], pins[f"D{bit}"]) != (["0"], ["1"]):
        return False
    for gated, other in ("BA", "AB"):
        net = pins[gated + bit][0]
        if net not in gates or len(loads[net]) != 1:
            continue
        gate = cells.pop(gates.pop(net))
        first, second = varying(gate)
        pins[f"A{bit}"] = pins[other + bit]
        pins[f"B{bit}"], pins[f"C{bit}"] = gate["connections"][first], gate["connections"][second]
        values = table(gate, first, second)
        sums = sum((a ^ values[b, c]) << (a + 2 * b + 4 * c) for a, b, c in product((0, 1), repeat=3))
        adder["parameters"][init] = f"{sums << 8 | ADDITION & 0xFF:016b}"
        return True
    return False


def varying(gate: Cell) -> list[str]:
    """The inputs of a lookup table that are not constant."""
    return [pin for pin in "ABCD" if gate["connections"][pin][0] not in ("0", "1")]


def table(gate: Cell, first: str, second: str) -> dict[tuple[int, int], int]:
    """The output of a gate of two inputs, by their values."""
    init = int(gate["parameters"]["INIT"], 2)
    inputs = gate["connections"]
    at = {pin: int(inputs[pin][0]) for pin in "ABCD" if pin not in (first, second)}
    found = {}
    for one, other in product((0, 1), repeat=2):
        at |= {first: one, second: other}
        found[one, other] = init >> sum(at[pin] << place for place, pin in enumerate("ABCD")) & 1
    return found
