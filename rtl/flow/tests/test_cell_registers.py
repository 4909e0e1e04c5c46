# SPDX-License-Identifier: Apache-2.0
"""Registers beside block RAMs and multipliers are moved into them exactly if they can hold them."""

from __future__ import annotations

from typing import Any

import pytest
from cell_registers import move_registers

Record = dict[str, Any]


def register(data: int, output: int) -> Record:
    return {
        "type": "TRELLIS_FF",
        "parameters": {"CEMUX": "1 ", "CLKMUX": "CLK", "LSRMUX": "LSR", "REGSET": "RESET"},
        "port_directions": {"CLK": "input", "DI": "input", "LSR": "input", "Q": "output"},
        "connections": {"CLK": [2], "DI": [data], "LSR": ["0"], "Q": [output]},
    }


def module() -> Record:
    """Port B of a block RAM drives two registers, whose outputs leave in turned order."""
    ram: Record = {
        "type": "DP16KD",
        "parameters": {f"{k}_{side}": v for side in "AB" for k, v in
                       {"DATA_WIDTH": "10010", "REGMODE": "NOREG"}.items()}
        | {"CLKAMUX": "CLKA", "CLKBMUX": "CLKB"},
        "port_directions": {}, "connections": {},
    }  # fmt: skip
    inputs = {"CLKA": [2], "CLKB": [2], "OCEA": ["1"], "OCEB": ["1"], "RSTA": ["0"], "RSTB": ["0"]}
    ram["connections"] = inputs | {"DOB0": [10], "DOB1": [11], "DOB2": [12]}
    ram["port_directions"] = dict.fromkeys(inputs, "input") | dict.fromkeys(
        ("DOB0", "DOB1", "DOB2"), "output"
    )
    return {
        "ports": {"out": {"direction": "output", "bits": [21, 20]}},
        "cells": {"ram": ram, "q0": register(10, 20), "q1": register(11, 21)},
    }


def test_registers_are_inside_and_each_bit_keeps_its_place() -> None:
    made = module()
    assert move_registers(made) == (1, 0)
    ram = made["cells"].pop("ram")
    assert not made["cells"]
    assert (ram["connections"]["DOB0"], ram["connections"]["DOB1"]) == ([20], [21])
    assert (ram["parameters"]["REGMODE_A"], ram["parameters"]["REGMODE_B"]) == ("NOREG", "OUTREG")


def changed(cell: str, part: str, key: str, value: object) -> Record:
    made = module()
    made["cells"][cell][part][key] = value
    return made


@pytest.mark.parametrize(
    "made",
    [
        changed("q1", "parameters", "CEMUX", "CE"),
        changed("q1", "parameters", "CLKMUX", "INV"),
        changed("q1", "parameters", "REGSET", "SET"),
        changed("q1", "connections", "LSR", [3]),
        changed("q1", "connections", "CLK", [3]),
        changed("q1", "connections", "DI", [10]),  # one bit drives two registers
        changed("q1", "connections", "DI", [12]) | {"ports": {"out": {"direction": "output", "bits": [12]}}},
        changed("ram", "connections", "RSTB", [3]),
        changed("ram", "connections", "OCEB", ["0"]),
        changed("ram", "parameters", "DATA_WIDTH_B", "100100"),
        changed("ram", "parameters", "REGMODE_B", "OUTREG"),
    ],
)
def test_what_does_not_fit_stays(made: Record) -> None:
    assert move_registers(made) == (0, 0)
    assert len(made["cells"]) == 3


def test_a_bit_that_goes_elsewhere_too_stays() -> None:
    made = module()
    made["ports"]["out"]["bits"] = [21, 20, 11]
    assert move_registers(made) == (0, 0)


def product() -> Record:
    """A multiplier of 1 x 1 bits between registers, the first of which leads elsewhere too."""
    pins = [f"{operand}{bit}" for operand in "AB" for bit in range(18)]
    inputs = {key: ["0"] for key in pins} | {"A0": [20], "B0": [21]}
    multiplier: Record = {
        "type": "MULT18X18D",
        "parameters": {},
        "port_directions": dict.fromkeys(pins, "input") | {"P0": "output", "P1": "output"},
        "connections": inputs | {"P0": [30], "P1": [31]},
    }
    cells = {"mult": multiplier, "a": register(10, 20), "b": register(11, 21), "p": register(30, 40)}
    return {"ports": {"out": {"direction": "output", "bits": [40, 20]}}, "cells": cells}


def test_a_multiplier_takes_registers_from_both_sides() -> None:
    made = product()
    assert move_registers(made) == (0, 1)
    mult = made["cells"]["mult"]
    assert made["cells"].keys() == {"mult", "a"}
    assert [mult["connections"][pin] for pin in ("A0", "B0", "P0", "CLK0")] == [[10], [11], [40], [2]]
    assert {mult["parameters"][f"REG_{stage}_CLK"] for stage in ("INPUTA", "INPUTB", "OUTPUT")} == {"CLK0"}


@pytest.mark.parametrize(
    ("cell", "part", "key", "value"),
    [
        ("a", "parameters", "CEMUX", "CE"),
        ("b", "connections", "CLK", [3]),
        ("p", "parameters", "REGSET", "SET"),
        ("p", "connections", "DI", [29]),  # the product leaves without a register
        ("mult", "connections", "B0", [12]),  # from no register
        ("mult", "parameters", "REG_OUTPUT_CLK", "CLK0"),
    ],
)
def test_a_multiplier_keeps_what_does_not_fit(cell: str, part: str, key: str, value: object) -> None:
    made = product()
    made["cells"][cell][part][key] = value
    if value == [29]:
        made["ports"]["out"]["bits"] = [40, 20, 30]
    assert move_registers(made) == (0, 0)
    assert len(made["cells"]) == 4
