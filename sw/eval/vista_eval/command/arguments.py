"""Arguments that several commands take."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from vista.command.arguments import not_negative

if TYPE_CHECKING:
    from vista_eval.render.flight import Quality


def add_quality(parser: argparse.ArgumentParser, of: str, default: Quality) -> None:
    parser.add_argument(
        "--quality",
        choices=("quick", "full"),
        default=default,
        help=f"quality of the {of} that are rendered (default {default})",
    )


def add_sensor_noise(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--noise",
        nargs="+",
        type=not_negative,
        default=[],
        metavar="GREY_LEVELS",
        help="score also with sensor noise added to the images of both cameras, of each standard deviation",
    )
