# SPDX-License-Identifier: Apache-2.0
"""Clocks of a frame on the simulated board, beside those of the system model.

Pairs of 640x480 go through `make board-clocks D=32 B=11 W=640 R=32` as fast as the client of libvista sends
and fetches them, two at a time on the board, and through build/bin/vista_system with the preset of the board.
So do smaller ones, through the build D=16 B=5 W=320 R=16. Both say how many clocks the engine worked at a
frame and how many lie between two frames. It takes some five minutes, --small one.

--cameras: the pairs are those of two sensors at the board, in the simulation and in the model, at the rate of
the sensors; both say how many of them the client received.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
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


# Sensors at the board: size, levels, frames a second. They send lines with this blanking at this clock.
CAMERAS = [
    ((640, 480), 1, 90.0),
    ((640, 480), 3, 60.0),
    ((320, 240), 1, 340.0),
    ((320, 240), 2, 260.0),
    ((320, 240), 3, 230.0),
]
PIXEL_MHZ, LINE_BLANKING_PX = 40, {640: 160, 320: 80}
CAMERA_FRAMES = 6


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


def camera_row(
    size: tuple[int, int], levels: int, rate_hz: float, frames: int, folder: Path
) -> dict[str, Any]:
    """Pairs of the cameras that were received, of how many, and medians of clocks: board and model."""
    config = replace(
        config_of(size, levels, 0.0),
        board_cameras=True,
        camera_rate_hz=float(rate_hz),
        camera_pixel_clock_hz=PIXEL_MHZ * 1e6,
        camera_horizontal_blanking_px=LINE_BLANKING_PX[size[0]],
        camera_vertical_blanking_lines=0,
        buffer_policy="queue",
        frames=frames + 2,
    )
    run = Simulator(find_program()).run(config)
    clocks = config.engine_clock_hz / 1e9
    came = [clocks * (f["host_start_ns"] - f["result_end_ns"]) for f in run.delivered]
    model = figures_of(spans_of(run)) | {
        "fetch_clocks": round(statistics.median(came[1:-1])),
        "received": len(run.delivered),
        "of": len(run.frames),
    }
    return row(levels, from_the_cameras(config, frames, folder), model, config) | {"sensors_hz": rate_hz}


def from_the_cameras(config: SystemConfig, frames: int, folder: Path) -> dict[str, float]:
    pixels = config.width_px * config.height_px
    pairs = folder / "pairs.raw"
    np.random.default_rng(1).integers(0, 256, 2 * pixels, np.uint8).tofile(pairs)
    options = {
        "pairs": pairs, "words": folder / "words.raw", "pixel-mhz": PIXEL_MHZ,
        "line-blanking": config.camera_horizontal_blanking_px, "rate": config.camera_rate_hz,
    }  # fmt: skip
    arguments = [str(word) for name, value in options.items() for word in (f"--{name}", value)]
    spans, came = [], {}
    for line in board_lines(config, frames, *arguments):
        match line.split():
            case ["frame", number, clock, *_]:
                came[int(number)] = float(clock)
            case [begin, end]:
                spans.append((float(begin), float(end)))
    ends = [end for _, end in spans]
    fetch = [clock - max(end for end in ends if end < clock) for clock in [*came.values()][1:-1]]
    return figures_of(spans) | {
        "fetch_clocks": round(statistics.median(fetch)),
        "received": len(came),
        "of": max(came) - min(came) + 1,
    }


def board_lines(config: SystemConfig, frames: int, *options: str) -> list[str]:
    build = config.disparities, config.block_px, config.max_width_px, config.rectify_rows
    program = program_of("board-clocks", *build)
    numbers = config.width_px, config.height_px, config.levels, frames, round(config.link_round_trip_ns)
    command = [str(program), *map(str, numbers), *options]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()


def through_the_board(config: SystemConfig, frames: int) -> list[tuple[float, float]]:
    """The clocks in which the engine began with each frame and had ended."""
    return [(float(begin), float(end)) for begin, end in map(str.split, board_lines(config, frames))]


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


def camera_table_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    cells = []
    for row in rows:
        board, model = row["board"], row["model"]
        clocks = [
            f"{board[key]:,}, {model[key]:,} ({100 * (model[key] / board[key] - 1):+.1f} %)"
            for key in ("period_clocks", "engine_clocks", "fetch_clocks")
        ]
        received = [f"{side['received']} of {side['of']}" for side in (board, model)]
        cells.append([row["size"], str(row["levels"]), f"{row['sensors_hz']:g}", *received, *clocks])
    heads = ["size", "levels", "frames/s of the sensors", "received: board", "model"]
    clocks = ["from frame to frame", "at work at a frame", "from there to the client"]
    heads += [f"clocks {what}: board, model" for what in clocks]
    return {"name": "board-cameras", "heads": heads, "rows": cells}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--small", action="store_true", help="without 640x480")
    parser.add_argument("--frames", type=int, default=FRAMES, help=f"through the board ({FRAMES})")
    parser.add_argument("--round-trip-ns", type=float, default=0, help="of network and host (0)")
    parser.add_argument("--out", type=Path, help="JSON, for make_tables.py --save board-clocks=FILE")
    parser.add_argument("--cameras", action="store_true", help="pairs of sensors at the board")
    args = parser.parse_args()
    if args.cameras:
        with tempfile.TemporaryDirectory() as folder:
            cases = [case for case in CAMERAS if case[0] in SIZES[bool(args.small) :]]
            rows = [camera_row(*case, CAMERA_FRAMES, Path(folder)) for case in cases]
        save(args.out, camera_table_of(rows), rows)
        return
    rows = []
    for size, levels in product(SIZES[1:] if args.small else SIZES, LEVELS):
        config = config_of(size, levels, args.round_trip_ns)
        board = figures_of(through_the_board(config, args.frames))
        model = figures_of(spans_of(Simulator(find_program()).run(config))[: args.frames + 8])
        rows.append(row(levels, board, model, config))
        print(as_text(rows[-1]), flush=True)
    save(args.out, table_of(rows), rows)


def save(out: Path | None, table: dict[str, Any], rows: list[dict[str, Any]]) -> None:
    print(as_text(table))
    if out:
        out.write_text(as_text({"tables": [table], "figures": {"rows": rows}}) + "\n")


if __name__ == "__main__":
    main()
