"""Turns the options of the command line, a preset and the defaults into one SystemConfig."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from vista.errors import InputError

from vista_throughput.presets import PRESETS, Clock, routed_clock
from vista_throughput.system import DEFAULT_PIXEL_CLOCK_HZ, SystemConfig


def count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive whole number")
    return int(text)


def blanking(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0")
    return int(text)


def quantity(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or value <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return value


def samples(text: str) -> tuple[float, ...]:
    return tuple(quantity(part) for part in text.split(","))


@dataclass(frozen=True)
class Option:
    name: str
    key: str  # of SystemConfig
    read: Callable[[str], Any]
    metavar: str
    meaning: str
    by_default: str | None = None  # None: what SystemConfig says


OPTIONS = (
    Option("--width", "width_px", count, "PX", "width of an image"),
    Option("--height", "height_px", count, "PX", "height of an image"),
    Option(
        "--disparities",
        "disparities",
        count,
        "N",
        "disparities that are searched, a multiple of 16 up to 256",
    ),
    Option("--block", "block_px", count, "PX", "side of the block that is matched, odd, 5 to 21"),
    Option(
        "--build-width", "max_width_px", count, "PX", "width of the widest image that the engine is built for"
    ),
    Option(
        "--clock",
        "engine_clock_hz",
        quantity,
        "HZ",
        "clock of the engine",
        "that of the build as placed and routed",
    ),
    Option("--lanes", "lanes", count, "N", "number of engines side by side; each takes whole frames"),
    Option(
        "--rectify-rows",
        "rectify_rows",
        count,
        "N",
        "rows of the line buffer of a front end in hardware: 16, 32, 64 or 128",
        "no front end",
    ),
    Option("--levels", "levels", count, "N", "levels of the pyramid that are matched, 1 to 4"),
    Option(
        "--link",
        "link_bytes_s",
        quantity,
        "BYTES/S",
        "bytes per second, each way, of the link to a board",
        "the camera feeds the memory of the engine",
    ),
    Option(
        "--round-trip",
        "link_round_trip_ns",
        quantity,
        "NS",
        "nanoseconds that network and host take for a question and its answer",
    ),
    Option(
        "--memory-clock",
        "memory_clock_hz",
        quantity,
        "HZ",
        "clock of the SDRAM of a board, whose bandwidth and latency follow from it",
        "that of the engine",
    ),
    Option("--camera-rate", "camera_rate_hz", quantity, "HZ", "frames per second of the camera"),
    Option(
        "--pixel-clock",
        "camera_pixel_clock_hz",
        quantity,
        "HZ",
        "pixel clock of each camera",
        f"{DEFAULT_PIXEL_CLOCK_HZ:g}, or more if the frame rate needs it",
    ),
    Option(
        "--horizontal-blanking",
        "camera_horizontal_blanking_px",
        blanking,
        "PX",
        "pixel clocks between one line and the next",
    ),
    Option(
        "--vertical-blanking",
        "camera_vertical_blanking_lines",
        blanking,
        "LINES",
        "lines between one frame and the next",
    ),
    Option(
        "--memory-bandwidth",
        "memory_bandwidth_bytes_s",
        quantity,
        "BYTES/S",
        "bytes per second of the memory, reads and writes together; not of a board",
    ),
    Option(
        "--memory-latency",
        "memory_latency_ns",
        quantity,
        "NS",
        "nanoseconds from the end of a burst to its data; not of a board",
    ),
    Option(
        "--result-bytes",
        "result_bytes_px",
        count,
        "N",
        "bytes of a pixel that the engine writes: 2, or 4 with Smin",
    ),
    Option("--buffers", "buffers", count, "N", "frame buffers of each kind, 2 or 3"),
    Option(
        "--host-cores",
        "host_cores",
        count,
        "N",
        "processor cores of the host, 1 or 2; with 2, one of them rectifies",
    ),
    Option("--frames", "frames", count, "N", "frames of the camera that are simulated"),
    Option(
        "--seed", "seed", blanking, "N", "seed of the synthetic images and of the host's times that are drawn"
    ),
)


BUS = ("memory_bandwidth_bytes_s", "memory_latency_ns")  # what the memory of a board does not have


def add_options(parser: argparse.ArgumentParser) -> None:
    defaults = SystemConfig()
    for option in OPTIONS:
        default = option.by_default or f"{getattr(defaults, option.key):g}"
        parser.add_argument(
            option.name,
            type=option.read,
            metavar=option.metavar,
            dest=option.key,
            help=f"{option.meaning} (default {default})",
        )


def configure(arguments: argparse.Namespace) -> tuple[SystemConfig, Clock]:
    """Defaults, then the preset, then what was given; without the host's times.

    Raises InputError for what does not go together, before anything is simulated."""
    values = dict(PRESETS[arguments.preset].values) if arguments.preset else {}
    given = {option.key: getattr(arguments, option.key) for option in OPTIONS}
    values |= {key: value for key, value in given.items() if value is not None}
    config = SystemConfig(**values)
    _check_memory(config, given)
    if config.width_px > config.max_width_px:
        reason = f"{config.width_px} px, the engine is built for {config.max_width_px}: name --build-width"
        raise InputError("--width", reason)
    if "engine_clock_hz" in values:
        origin = "as given" if arguments.engine_clock_hz is not None else "of the board"
        clock = Clock(config.engine_clock_hz, origin, None)
    else:
        clock = routed_clock(config.disparities, config.block_px, config.max_width_px)
    # A little more than the rate takes: the exact quotient may round to just below the rate.
    least_hz = config.readout_pixel_clocks * config.camera_rate_hz * (1 + 1e-9)
    if "camera_pixel_clock_hz" not in values:
        config = replace(config, camera_pixel_clock_hz=max(DEFAULT_PIXEL_CLOCK_HZ, least_hz))
    elif config.camera_pixel_clock_hz < least_hz * (1 - 1e-6):
        most_hz = config.camera_pixel_clock_hz / config.readout_pixel_clocks
        raise InputError(
            "--camera-rate", f"{config.camera_rate_hz:g} Hz; --pixel-clock and blanking allow {most_hz:.4g}"
        )
    else:
        config = replace(config, camera_pixel_clock_hz=max(config.camera_pixel_clock_hz, least_hz))
    config = replace(config, engine_clock_hz=clock.hz)
    if config.has_board and config.memory_clock_hz == 0:
        config = replace(config, memory_clock_hz=clock.hz)
    return config, clock


def _check_memory(config: SystemConfig, given: dict[str, Any]) -> None:
    if not config.has_board and config.memory_clock_hz:
        raise InputError("--memory-clock", "is that of a board: name its --link, or --memory-bandwidth")
    for option in OPTIONS:
        if config.has_board and option.key in BUS and given[option.key] is not None:
            raise InputError(option.name, "the memory of a board is an SDRAM: name its --memory-clock")
