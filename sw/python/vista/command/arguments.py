"""Arguments that several commands take."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from vista import parameters
from vista.engine import ENGINES, LR_OFF
from vista.engine.board import DEFAULT_TIMEOUT_S


def add_board_timeout(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--board-timeout",
        type=positive,
        default=DEFAULT_TIMEOUT_S,
        metavar="S",
        help="how long a board may be silent, or work at a frame (default 2; a simulated one needs more)",
    )


def add_config(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE.toml",
        help="file of parameters; `vista config` prints one with all defaults",
    )


def add_engine(parser: argparse.ArgumentParser, help_text: str, others: tuple[str, ...] = ()) -> None:
    choices = (*ENGINES, *others)
    parser.add_argument("--engine", choices=choices, default="golden", help=f"{help_text} (default golden)")


def load_parameters(path: Path | None, engine_name: str) -> parameters.Values:
    base = parameters.defaults()
    if engine_name == "opencv":
        base["stereo"]["lr_max_diff"] = LR_OFF  # StereoBM's own check compares other things
    return parameters.load(path, base)


def not_negative(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0 on")
    return value


def positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive number")
    return int(text)


def image_size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (
        width.isascii()
        and width.isdigit()
        and height.isascii()
        and height.isdigit()
        and 0 < int(width) <= 8192  # VISTA_MOST_IMAGE_PX
        and 0 < int(height) <= 8192
    ):
        raise argparse.ArgumentTypeError(f"{text!r} is no size such as 640x480, of 1 to 8192 px a side")
    return int(width), int(height)
