# SPDX-License-Identifier: Apache-2.0
"""What the report of nextpnr (--report) says of the slowest path of a clock."""

from __future__ import annotations

import re
from typing import Any

Record = dict[str, Any]

# Yosys and nextpnr name a cell after the signal that it makes, then its kind: lost_q_TRELLIS_FF_Q_3.
KIND = re.compile(r"(_(?=[A-Z][A-Z0-9]{2,})|\$).*")


def critical_path(report: Record, clock: str) -> Record:
    """The slowest path from one register to the next of the clock of this name: the ends, its length with the
    set-up time, and how much of that are wires. Empty if nothing lies between two registers of the clock."""
    paths = [
        found["path"]
        for found in report["critical_paths"]
        if all(
            end.removeprefix("posedge ").removeprefix("negedge ") == clock
            for end in (found["from"], found["to"])
        )
    ]
    if not paths:
        return {}
    path = max(paths, key=length_ns)
    wires = [part for part in path if part["type"] == "routing"]
    return {
        "from": signal(path[0]["from"]["cell"]),
        "to": signal(path[-1]["to"]["cell"]),
        "ns": round(length_ns(path), 1),
        "wires_ns": round(length_ns(wires), 1),
        "cells": len(wires) - 1,
    }


def length_ns(path: list[Record]) -> float:
    return sum(part["delay"] for part in path)


def signal(cell: str) -> str:
    """The place of a cell in a flattened netlist: the instances it lies in, and the signal if that has a
    name."""
    return KIND.sub("", cell).rstrip(".") or "logic"


def sentence(path: Record) -> str:
    """One line of a table."""
    ends = f"`{path['from']}` to `{path['to']}`"
    return f"{ends}, {path['cells']} cells, {path['ns']:.1f} ns, {path['wires_ns']:.1f} of them in wires"
