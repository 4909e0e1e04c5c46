# SPDX-License-Identifier: Apache-2.0
"""Clocks of a frame on the simulated board, beside those of the system model.

Pairs of 640x480 go through `make board-clocks D=32 B=11 W=640 R=32` as fast as the client of libvista sends
and fetches them, two at a time on the board, and through build/bin/vista_system with the preset of the board.
So do smaller ones, through the build D=16 B=5 W=320 R=16. Both say how many clocks the engine worked at a
frame and how many lie between two frames. It takes some five minutes, --small one.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path
from typing import Any

from simulated_board import program_of
from vista_throughput.presets import PRESETS
from vista_throughput.simulate import Run, Simulator, find_program
from vista_throughput.system import SystemConfig

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from make_tables import as_text

FRAMES = 6  # through the board, the first and the last of which do not count

SIZES = [(640, 480), (320, 240), (200, 180)]
LEVELS = [1, 2, 3]

# The build that the tests of the simulated board use: quicker to make and to run.
SMALL = {"disparities": 16, "block_px": 5, "max_width_px": 320, "rectify_rows": 16}


def config_of(size: tuple[int, int], levels: int, round_trip_ns: float) -> SystemConfig:
    width_px, height_px = size
    build = SMALL if width_px <= SMALL["max_width_px"] else {}
    images = {"width_px": width_px, "height_px": height_px, "levels": levels}
    config = SystemConfig(**PRESETS["board"].values | build | images)
    return replace(
        config,
        link_round_trip_ns=round_trip_ns,
        camera_rate_hz=1000.0,
        camera_pixel_clock_hz=1000.0 * config.readout_pixel_clocks * 1.001,
        buffer_policy="latest",
        frames=400,
    )


def through_the_board(config: SystemConfig, frames: int) -> list[tuple[float, float]]:
    """The clocks in which the engine began with each frame and had ended."""
    build = config.disparities, config.block_px, config.max_width_px, config.rectify_rows
    program = program_of("board-clocks", *build)
    numbers = config.width_px, config.height_px, config.levels, frames, round(config.link_round_trip_ns)
    done = subprocess.run([program, *map(str, numbers)], stdout=subprocess.PIPE, text=True, check=True)
    return [(float(begin), float(end)) for begin, end in map(str.split, done.stdout.splitlines())]


def figures_of(spans: list[tuple[float, float]]) -> dict[str, float]:
    """Medians, of the frames from the second to the last but one."""
    periods = [after - before for before, after in pairwise(begin for begin, _ in spans[1:])]
    return {
        "engine_clocks": round(statistics.median(end - begin for begin, end in spans[1:-1])),
        "period_clocks": round(statistics.median(periods)),
    }


def spans_of(run: Run) -> list[tuple[float, float]]:
    clocks = run.config.engine_clock_hz / 1e9
    return [(f["fetch_start_ns"] * clocks, f["result_end_ns"] * clocks) for f in run.delivered]


def row(
    levels: int, board: dict[str, float], model: dict[str, float], config: SystemConfig
) -> dict[str, Any]:
    return {
        "size": f"{config.width_px}x{config.height_px}",
        "levels": levels,
        "board": board,
        "model": model,
        "board_rate_hz": round(config.engine_clock_hz / board["period_clocks"], 1),
        "model_rate_hz": round(config.engine_clock_hz / model["period_clocks"], 1),
    }


def table_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    def compared(row: dict[str, Any], key: str) -> list[str]:
        board, model = row["board"][key], row["model"][key]
        return [f"{board:,}", f"{model:,} ({100 * (model / board - 1):+.1f} %)"]

    cells = []
    for row in rows:
        rates = [f"{row[side]:.1f}" for side in ("board_rate_hz", "model_rate_hz")]
        clocks = [*compared(row, "period_clocks"), *compared(row, "engine_clocks")]
        cells.append([row["size"], str(row["levels"]), *clocks, *rates])
    heads = [
        "size",
        "levels",
        "clocks from frame to frame: board",
        "model",
        "clocks at work at a frame: board",
    ]
    return {"name": "board-clocks", "heads": [*heads, "model", "frames/s: board", "model"], "rows": cells}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--small", action="store_true", help="without 640x480")
    parser.add_argument("--frames", type=int, default=FRAMES, help=f"through the board ({FRAMES})")
    parser.add_argument("--round-trip-ns", type=float, default=0, help="of network and host (0)")
    parser.add_argument("--out", type=Path, help="JSON, for make_tables.py --save board-clocks=FILE")
    args = parser.parse_args()
    rows = []
    for size, levels in product(SIZES[1:] if args.small else SIZES, LEVELS):
        config = config_of(size, levels, args.round_trip_ns)
        board = figures_of(through_the_board(config, args.frames))
        model = figures_of(spans_of(Simulator(find_program()).run(config))[: args.frames + 8])
        rows.append(row(levels, board, model, config))
        print(as_text(rows[-1]), flush=True)
    if args.out:
        args.out.write_text(as_text({"tables": [table_of(rows)], "figures": {"rows": rows}}) + "\n")


if __name__ == "__main__":
    main()
