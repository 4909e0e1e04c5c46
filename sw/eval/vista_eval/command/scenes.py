"""Score the segmentation on labelled single scenes, against a reference method without a cut.

DIR holds one folder for each scene: scene_NNNN is drawn at random with seed NNNN. Scenes that it lacks are
rendered. Scenes with even seeds form the group dev, on which parameters may be chosen, those with odd seeds
the group test. The table is printed; DIR receives scenes.json, which has every score, and scenes.html, which
shows the worst and the best scenes.

With --lidar or --dense, real pairs are measured instead, each by itself: how much of what stands there
becomes an obstacle, how much of the road does, and what becomes of the rest; beside stereo alone, the words
of OpenCV's SGBM in the same host, and the reference method. Pairs in even places of the sorted names are the
group dev, those in odd places the group test. FOLDER of --lidar is laid out as KITTI 2012 (image_0, image_1,
disp_noc or disp_occ, calib if there), that of --dense holds Middlebury's pairs. DIR (default: measured-pairs)
receives lidar.json or dense.json (every figure) and a page that shows the worst pairs; FOLDER is only read.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from vista.command.arguments import add_config, load_parameters, positive
from vista.errors import EXIT_OK, InputError

from vista_eval.command.arguments import add_quality
from vista_eval.jobs import add_place, chosen_place, jobs_of, run

if TYPE_CHECKING:
    from vista_eval.render.flight import Quality

COUNT = 160
PAIRS_FOLDER = Path("measured-pairs")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "folder", type=Path, metavar="DIR", nargs="?", help="folder of the scenes, or of results"
    )
    parser.add_argument("--lidar", type=Path, metavar="FOLDER", help="measure street pairs with LiDAR")
    parser.add_argument("--dense", type=Path, metavar="FOLDER", help="measure indoor pairs with dense truth")
    add_place(parser)
    parser.add_argument(
        "--count",
        type=positive,
        default=COUNT,
        metavar="N",
        help=f"number of scenes to render (default {COUNT})",
    )
    parser.add_argument(
        "--seed", type=int, default=0, metavar="S", help="seed of the first scene (default 0)"
    )
    add_quality(parser, "scenes", "full")
    parser.add_argument("--no-render", action="store_true", help="render nothing; score what DIR holds")
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    values = load_parameters(arguments.config, "golden")
    place = chosen_place(arguments)
    from vista_eval.score import score
    from vista_eval.suites.pairs import Pairs
    from vista_eval.suites.scenes import Scenes  # loads libvista, which `--help` need not

    measured = {"lidar": arguments.lidar, "dense": arguments.dense}
    for kind, folder in measured.items():
        if folder is not None:
            suite = Pairs(kind, place.known_to_all(folder))
            score(suite, arguments.folder or PAIRS_FOLDER, values, place)
    if any(measured.values()):
        return EXIT_OK
    if arguments.folder is None:
        raise InputError("DIR", "the folder of the scenes is missing; or name --lidar or --dense")
    folder = place.known_to_all(arguments.folder)
    if not arguments.no_render:
        seeds = range(arguments.seed, arguments.seed + arguments.count)
        render = partial(render_scene, folder, arguments.quality)
        run(jobs_of(render, seeds, "scene_{:04d}".format), place, "render", "scene")
    score(Scenes(folder), arguments.folder, values, place)
    return EXIT_OK


def render_scene(folder: Path, quality: Quality, seed: int) -> None:
    from vista_eval.render.flight import render_flight
    from vista_eval.worlds.labelled import labelled  # loads what draws, which `--help` need not

    flight = labelled(seed)
    for _ in render_flight(flight, folder / flight.name, quality):
        pass
