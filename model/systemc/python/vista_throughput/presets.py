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
    "memory_clock_hz": BOARD_CLOCK_HZ,
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
