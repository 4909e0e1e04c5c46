"""Named systems. Their clocks come from rtl/synth/results.json, where `make synth` writes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vista.errors import InputError

from vista_throughput import synthesis


@dataclass(frozen=True)
class Preset:
    meaning: str
    values: dict[str, Any]  # of SystemConfig


BOARD_CLOCK_HZ = 45e6  # MHZ of rtl/board/board.mk
CLOCK_NS = 1e9 / BOARD_CLOCK_HZ

# The memory of the board as LiteDRAM 2024.12 drives the M12L64322A. Clocks are counted in LiteDRAM's source.
WORD_BYTES = 4  # a word a clock
QUEUE_WORDS = 8  # cmd_buffer_depth: what a bank takes of one master before another has its turn
READ_TIME_CLOCKS, WRITE_TIME_CLOCKS = 32, 16  # read_time and write_time, while the others wait
# Multiplexer: after reads a clock to see that there are none and read_latency - 1 of RTW; after writes a
# clock, and WTR until tWTR + tCCD have passed. The mean of 4 and 3.
TURNAROUND_CLOCKS = 3.5
# A master that comes to its next row waits for its lock on the bank before (2), a grant of the next (1), and
# that one's queue (2), precharge and activation (2).
ROW_WORDS, ROW_CLOCKS = 256, 7
# Every tREFI: grants of all banks, precharge, tRP, tRFC, and activations.
REFRESH_INTERVAL_CLOCKS, REFRESH_CLOCKS = 703, 12
MEMORY_LATENCY_CLOCKS = 10

# The Colorlight i9 as `make bitstream` builds it, its memory as LiteDRAM drives it.
BOARD: dict[str, Any] = {
    "width_px": 640,
    "height_px": 480,
    "disparities": 32,
    "max_width_px": 640,
    "engine_clock_hz": BOARD_CLOCK_HZ,
    "rectify_rows": 32,
    "levels": 3,
    "camera_rate_hz": 30.0,
    "link_bytes_s": 125e6,
    "memory_bandwidth_bytes_s": WORD_BYTES * BOARD_CLOCK_HZ * (1 - REFRESH_CLOCKS / REFRESH_INTERVAL_CLOCKS),
    "memory_latency_ns": MEMORY_LATENCY_CLOCKS * CLOCK_NS,
    "memory_burst_overhead_ns": ROW_CLOCKS * QUEUE_WORDS / ROW_WORDS * CLOCK_NS,
    "memory_turnaround_ns": TURNAROUND_CLOCKS * CLOCK_NS,
    "memory_read_time_ns": READ_TIME_CLOCKS * CLOCK_NS,
    "memory_write_time_ns": WRITE_TIME_CLOCKS * CLOCK_NS,
    "burst_bytes": WORD_BYTES * QUEUE_WORDS,
    "dma_fifo_bytes": 256,
}


PRESETS = {
    "acadia": Preset(
        "the system of the paper: 640x480, 32 disparities, 23 Hz",
        {"width_px": 640, "height_px": 480, "disparities": 32, "camera_rate_hz": 23.0},
    ),
    "ecp5": Preset(
        "the reference build on an LFE5U-25F behind a 60 Hz camera",
        {"width_px": 640, "height_px": 480, "disparities": 32, "camera_rate_hz": 60.0},
    ),
    "board": Preset(
        "640x480 over gigabit Ethernet to a Colorlight i9, three levels, a 30 Hz camera at the host",
        BOARD,
    ),
    "hd": Preset(
        "1920x1080 at 30 Hz, 64 disparities",
        {
            "width_px": 1920,
            "height_px": 1080,
            "disparities": 64,
            "max_width_px": 2048,
            "camera_rate_hz": 30.0,
            "camera_horizontal_blanking_px": 280,  # 2200 x 1125 pixel clocks: 1080p timing
            "camera_vertical_blanking_lines": 45,
        },
    ),
}


@dataclass(frozen=True)
class Clock:
    """A clock of the engine, and where it comes from, in words."""

    hz: float
    origin: str
    build: synthesis.Build | None  # the build that was placed and routed with this clock


def routed_clock(disparities: int, block_px: int, max_width_px: int) -> Clock:
    """The clock of this exact build; otherwise that of a build with another width, noted in `origin`."""
    exact = synthesis.find(disparities, block_px, max_width_px)
    if exact is not None:
        return Clock(exact.clock_mhz * 1e6, f"placed and routed: {exact}", exact)
    near = synthesis.find(disparities, block_px)
    if near is not None:
        origin = f"not routed for {max_width_px} px; the clock is that of {near}"
        return Clock(near.clock_mhz * 1e6, origin, None)
    routed = ", ".join(sorted({f"{b.disparities} (block {b.block_px})" for b in synthesis.builds()}))
    raise InputError(
        "--clock", f"name one: of {disparities} disparities, block {block_px}, none was routed; {routed} were"
    )
