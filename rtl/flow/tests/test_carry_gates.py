# SPDX-License-Identifier: Apache-2.0
"""Gates before a carry chain are folded into it so that no sum and no carry changes."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest
from carry_gates import ADDITION, fold_gates

Record = dict[str, Any]
X, Y, S, CARRY = 10, 11, 12, 13  # the other operand; what the gate takes; the carry into the bit


def adder(a: int, b: int) -> Record:
    """The first bit adds; the second one passes the carry on."""
    inputs: Record = {"A0": [a], "B0": [b], "C0": ["0"], "D0": ["1"], "CIN": [CARRY]}
    inputs |= {"A1": ["0"], "B1": ["0"], "C1": ["0"], "D1": ["1"]}
    outputs = {"S0": [20], "S1": [21], "COUT": [22]}
    return {
        "type": "CCU2C",
        "parameters": {"INIT0": f"{ADDITION:016b}", "INIT1": f"{ADDITION:016b}"},
        "port_directions": dict.fromkeys(inputs, "input") | dict.fromkeys(outputs, "output"),
        "connections": inputs | outputs,
    }


def gate(init: int) -> Record:
    return {
        "type": "LUT4",
        "parameters": {"INIT": f"{init:016b}"},
        "port_directions": dict.fromkeys("ABCD", "input") | {"Z": "output"},
        "connections": {"A": ["0"], "B": [Y], "C": ["1"], "D": [S], "Z": [14]},
    }


def first_bit(cells: dict[str, Record], values: tuple[int, ...]) -> tuple[int, int]:
    """Sum and carry of the first bit of the chain, as Yosys' ccu2c_sim.vh has them."""
    nets: dict[int | str, int] = {"0": 0, "1": 1} | dict(zip((X, Y, S, CARRY), values, strict=True))
    if "gate" in cells:
        inputs = [nets[cells["gate"]["connections"][pin][0]] for pin in "ABCD"]
        nets[14] = at(int(cells["gate"]["parameters"]["INIT"], 2), inputs)
    chain = cells["chain"]
    init = int(chain["parameters"]["INIT0"], 2)
    inputs = [nets[chain["connections"][pin][0]] for pin in ("A0", "B0", "C0", "D0")]
    whole, lower = at(init, inputs), at(init & 0xF, inputs[:2])
    return whole ^ nets[CARRY], nets[CARRY] if whole else lower


def at(init: int, values: list[int]) -> int:
    return init >> sum(value << place for place, value in enumerate(values)) & 1


@pytest.mark.parametrize("gated_first", [False, True])
@pytest.mark.parametrize("function", range(16))
def test_sums_and_carries_stay(function: int, gated_first: bool) -> None:
    init = sum((function >> ((i >> 1 & 1) + 2 * (i >> 3))) % 2 << i for i in range(16))  # of B and D
    made = {"gate": gate(init), "chain": adder(*((14, X) if gated_first else (X, 14)))}
    before = [first_bit(made, values) for values in product((0, 1), repeat=4)]
    assert fold_gates({"cells": made, "ports": {}}) == 1
    assert made.keys() == {"chain"}
    assert [first_bit(made, values) for values in product((0, 1), repeat=4)] == before


def test_a_gate_that_leads_elsewhere_too_stays() -> None:
    made = {"gate": gate(0x0FF0), "chain": adder(X, 14)}
    assert fold_gates({"cells": made, "ports": {"out": {"direction": "output", "bits": [14]}}}) == 0
    assert made.keys() == {"gate", "chain"}


@pytest.mark.parametrize(("cell", "pin", "net"), [("gate", "A", 15), ("chain", "C0", S)])
def test_a_gate_of_three_inputs_and_a_bit_that_does_more_than_add_stay(cell: str, pin: str, net: int) -> None:
    made = {"gate": gate(0x0FF0), "chain": adder(X, 14)}
    made[cell]["connections"][pin] = [net]
    assert fold_gates({"cells": made, "ports": {}}) == 0
