"""Arguments that several commands take."""

from __future__ import annotations

import argparse
from pathlib import Path

from vista import parameters
from vista.engine.contract import LR_OFF


def add_config(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE.toml",
        help="file of parameters; `vista config` prints one with all defaults",
    )


def load_parameters(path: Path | None, engine_name: str) -> parameters.Values:
    base = parameters.defaults()
    if engine_name == "opencv":
        base["stereo"]["lr_max_diff"] = LR_OFF  # StereoBM's own check compares other things
    return parameters.load(path, base)


def positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive number")
    return int(text)
