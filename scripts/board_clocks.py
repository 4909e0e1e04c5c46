"""Clocks of a frame on the simulated board, beside those of the system model.

Pairs of 640x480 go through `make board-sim` as fast as the client of libvista sends and fetches them, two at
a time on the board, and through build/bin/vista_system with the preset of the board. Both say how many
clocks the engine worked at a frame and how many lie between two frames. A frame takes about 10 s.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from measured_figures import ROOT, as_text
from vista import native
from vista.engine import EngineParameters
from vista.engine.hardware import settings_of
from vista_throughput.presets import PRESETS
from vista_throughput.simulate import Run, Simulator, find_program
from vista_throughput.system import SystemConfig

FRAMES = 6  # through the board, the first and the last of which do not count
TIMEOUT_MS = 120_000
SIMULATED_ROUND_TRIP_NS = 1100.0  # the simulation looks for packets every 64 clocks


# The build that the tests of the simulated board use, for images of 320x240: quicker to make and to run.
SMALL = {"width_px": 320, "height_px": 240, "disparities": 16, "block_px": 5, "max_width_px": 320,
         "rectify_rows": 16}  # fmt: skip


def config_of(levels: int, small: bool) -> SystemConfig:
    config = SystemConfig(**PRESETS["board"].values | (SMALL if small else {}))
    return replace(
        config,
        levels=levels,
        link_round_trip_ns=SIMULATED_ROUND_TRIP_NS,
        camera_rate_hz=1000.0,
        camera_pixel_clock_hz=1000.0 * config.readout_pixel_clocks * 1.001,
        buffer_policy="latest",
        frames=400,
    )


def program_of(config: SystemConfig) -> Path:
    name = f"d{config.disparities}_b{config.block_px}_w{config.max_width_px}_r{config.rectify_rows}"
    program = ROOT / "build" / "board" / name / "board-sim"
    if not program.is_file():
        parts = " ".join(f"{part[0].upper()}={part[1:]}" for part in name.split("_"))
        sys.exit(f"board_clocks: {program.relative_to(ROOT)} is missing: make board-sim {parts}")
    return program


def through_the_board(config: SystemConfig, frames: int) -> list[tuple[int, int]]:
    """The clocks in which the engine began with each frame and had ended."""
    with tempfile.TemporaryDirectory() as folder:
        clocks = Path(folder) / "clocks"
        command = [str(program_of(config)), "--clocks", str(clocks)]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as board:
            assert board.stdout is not None
            send_and_fetch(int(board.stdout.readline()), config, frames)
            board.communicate()
        return [(int(begin), int(end)) for begin, end in map(str.split, clocks.read_text().splitlines())]


def send_and_fetch(port: int, config: SystemConfig, frames: int) -> None:
    ffi, lib = native.load("vista")
    memory, handle = ffi.new("char[]", lib.vista_board_bytes()), ffi.new("vista_board **")
    checked(lib.vista_board_connect(memory, len(memory), b"127.0.0.1", port, TIMEOUT_MS, handle))
    board = handle[0]
    parameters = EngineParameters(config.disparities, config.block_px, levels=config.levels)
    size = {"width_px": config.width_px, "height_px": config.height_px}
    checked(
        lib.vista_board_configure(board, ffi.new("vista_board_settings *", settings_of(parameters) | size))
    )
    rng = np.random.default_rng(1)
    images = rng.integers(0, 256, (2, config.height_px, config.width_px), dtype=np.uint8)
    left, right = (ffi.from_buffer("uint8_t[]", image) for image in images)
    words = ffi.new("int16_t[]", lib.vista_board_words(board))
    for frame in range(frames + 1):
        if frame < frames:
            checked(lib.vista_board_submit(board, left, right, config.width_px))
        if frame > 0:
            checked(lib.vista_board_collect(board, words, len(words)))
    lib.vista_board_disconnect(board)


def checked(status: int) -> None:
    if status != 0:
        raise RuntimeError(f"the client ended with status {status}")


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


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--small", action="store_true", help="320x240, with the build that the tests use")
    parser.add_argument("--frames", type=int, default=FRAMES, help=f"through the board ({FRAMES})")
    args = parser.parse_args()
    for levels in (1, 2, 3):
        config = config_of(levels, args.small)
        model = figures_of(spans_of(Simulator(find_program()).run(config))[: args.frames + 8])
        board = figures_of([(float(b), float(e)) for b, e in through_the_board(config, args.frames)])
        print(as_text(row(levels, board, model, config)), flush=True)


if __name__ == "__main__":
    main()
