"""Measure real street pairs with LiDAR: how much of what stands there becomes an obstacle.

Each pair is measured by itself: how much of what stands becomes an obstacle, how much of the road does, and
what becomes of the rest; beside stereo alone, the words of OpenCV's SGBM in the same host, and the reference
method. Pairs in even places of the sorted names are the group dev, those in odd places the group test. FOLDER
is laid out as KITTI 2012 (image_0, image_1, disp_noc or disp_occ, calib if there) and is only read. DIR
receives lidar.json, which has every figure, and lidar.html, which shows the worst pairs.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import add_config, load_parameters
from vista.errors import EXIT_OK

from vista_eval.jobs import add_place, chosen_place

PAIRS_FOLDER = Path("measured-pairs")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "folder",
        type=Path,
        metavar="DIR",
        nargs="?",
        default=PAIRS_FOLDER,
        help=f"folder of the results (default {PAIRS_FOLDER})",
    )
    parser.add_argument("--lidar", type=Path, metavar="FOLDER", required=True, help="folder of the pairs")
    add_place(parser)
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    values = load_parameters(arguments.config, "golden")
    place = chosen_place(arguments)
    from vista_eval.score import score
    from vista_eval.suites.pairs import Pairs  # loads libvista, which `--help` need not

    score(Pairs(place.known_to_all(arguments.lidar)), arguments.folder, values, place)
    return EXIT_OK
