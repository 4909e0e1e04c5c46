# SPDX-License-Identifier: Apache-2.0
"""The tables of rtl/synth/results.json, which keeps them beside the figures that they state."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

from nextpnr_report import Record, sentence

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from make_tables import SYNTHESIS, as_text

COUNTS = {
    "lut4": "LUT4",
    "sites": "sites",
    "ff": "flip-flops",
    "block_ram": "block RAMs",
    "multipliers": "multipliers",
}


def write(content: Record) -> None:
    """Write the file, with its tables made anew."""
    tables = [builds_table(content["builds"])]
    tables += [blocks_table(content["blocks"])] if "blocks" in content else []
    tables += [board_table(content["board"])] if "board" in content else []
    first = {"measured": content["measured"], "headline": headline(content["builds"][0]), "tables": tables}
    SYNTHESIS.write_text(as_text(first | {k: v for k, v in content.items() if k not in first}) + "\n")


def headline(build: Record) -> list[str]:
    pixels_s = build["clock_mhz"] * 1e6
    return [
        f"stereo engine in an {build['device']}, {build['disparities']} disparities",
        f"one pixel a clock at {build['clock_mhz']:.1f} MHz: {pixels_s / (640 * 480):.0f} frames/s "
        f"at 640x480; {build['lut4']:,} LUT4",
    ]


def builds_table(builds: list[Record]) -> Record:
    keys = ("disparities", "block_px", "max_width_px", "device", "speed_grade")
    heads = ["disparities", "block", "width", "device", "speed", *COUNTS.values(), "MHz: median (range)"]
    rows = [[*(str(b[key]) for key in keys), *counts(b), clock(b)] for b in builds]
    older = [b for b in builds if "commit" in b]
    notes = [
        f"- The row of {b['disparities']} disparities was measured at commit {b['commit']}." for b in older
    ]
    alike = [b for b in builds if all(b[key] == builds[0][key] for key in ("speed_grade", "max_width_px"))]
    made = sorted((b for b in alike if b not in older), key=lambda b: int(b["disparities"]))
    for one, next_one in pairwise(made):
        low, high = one["disparities"], next_one["disparities"]
        each = [(next_one[key] - one[key]) / (high - low) for key in ("lut4", "sites")]
        notes.append(
            f"- From {low} to {high} disparities, each takes {each[0]:.0f} LUT4 and {each[1]:.0f} sites."
        )
    return {"name": "synthesis"} | with_slowest_paths(heads, rows, builds) | {"legend": "\n".join(notes)}


def blocks_table(blocks: Record) -> Record:
    """The blocks before the core."""
    found = blocks["list"]
    heads = ["block", "width", "device", "speed", *COUNTS.values(), "MHz"]
    keys = ("max_width_px", "device", "speed_grade")
    rows = [[f"`{b['block']}`", *(str(b[key]) for key in keys), *counts(b), clock(b)] for b in found]
    table = with_slowest_paths(heads, rows, found)
    return {"name": "blocks"} | table | {"origin": origin(blocks["measured"])}


def board_table(board: Record) -> Record:
    """What the bitstream takes of the chip, and its clocks."""
    names = {**COUNTS, "pll": "PLLs"} | {"sites": "LUT4 places"}
    rows = []
    for key in ("sites", "ff", "block_ram", "multipliers", "pll"):
        used, available = board[key], board["available"][key]
        rows.append([names[key], f"{used:,} of {available:,} ({100 * used / available:.0f} %)"])
    for found in board["clocks"]:
        reached = f"{found['needed_mhz']:g} MHz, reaches {found['reached_mhz']:g}"
        rows.append([f"clock of {found['name']}", ": ".join(filter(None, [reached, slowest_path(found)]))])
    heads = [f"{board['board']}, {board['device']}-{board['speed_grade']}", "used"]
    return {"name": "board", "heads": heads, "rows": rows, "origin": origin(board["measured"])}


def with_slowest_paths(heads: list[str], rows: list[list[str]], builds: list[Record]) -> dict[str, Any]:
    """Heads and rows with one more column, if that is known of a build."""
    if any(b.get("critical_path") for b in builds):
        heads = [*heads, "slowest path"]
        rows = [[*row, slowest_path(b)] for row, b in zip(rows, builds, strict=True)]
    return {"heads": heads, "rows": rows}


def slowest_path(found: Record) -> str:
    return sentence(path) if (path := found.get("critical_path")) else ""


def counts(build: Record) -> list[str]:
    return [f"{build[key]:,}" for key in COUNTS]


def clock(build: Record) -> str:
    if build["clock_mhz"] is None:
        return "not routed"
    if build["seeds"] == 1:
        return f"{build['clock_mhz']:.1f} (1 seed)"
    low, high = build["clock_range_mhz"]
    return f"{build['clock_mhz']:.1f} ({low:.1f} to {high:.1f}, {build['seeds']} seeds)"


def origin(measured: Record) -> str:
    return f"Measured at commit {measured['commit']}, {measured['date']}"
