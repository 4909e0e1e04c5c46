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

import numpy as np
from tqdm import tqdm
from vista.command.arguments import add_config, load_parameters, positive
from vista.errors import EXIT_OK, InputError
from vista.output import write_atomically
from vista.parameters import Values

from vista_eval.command.arguments import add_quality
from vista_eval.jobs import Place, add_place, chosen_place, jobs_of, keep_to_one_core, run

if TYPE_CHECKING:
    from vista_eval.render.flight import Quality

SCORES, REPORT = "scenes.json", "scenes.html"
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
    measured = {"lidar": arguments.lidar, "dense": arguments.dense}
    if any(measured.values()):
        from vista_eval.command.measured_pairs import (
            measure_folder,
        )  # loads libvista, which `--help` need not

        for kind, folder in measured.items():
            if folder is not None:
                measure_folder(kind, folder, arguments.folder or PAIRS_FOLDER, values, place)
        return EXIT_OK
    if arguments.folder is None:
        raise InputError("DIR", "the folder of the scenes is missing; or name --lidar or --dense")
    return score_scenes(arguments, values, place)


def score_scenes(arguments: argparse.Namespace, values: Values, place: Place) -> int:
    from vista_eval.dataset.scenes import read_scenes
    from vista_eval.metrics.scenes import partition_scenes, score_scene
    from vista_eval.report import scenes_page as report  # loads libvista, which `--help` need not
    from vista_eval.report.table import write_measurement

    if not arguments.no_render:
        seeds = range(arguments.seed, arguments.seed + arguments.count)
        render = partial(render_scene, place.known_to_all(arguments.folder), arguments.quality)
        run(jobs_of(render, seeds, "scene_{:04d}".format), place, "render", "scene")
    scenes = read_scenes(arguments.folder)
    pairs = tqdm(
        partition_scenes(scenes, values), desc="score", total=len(scenes), unit="scene", disable=None
    )
    scored = [score_scene(scene, partition) for scene, partition in pairs]
    summary = report.halves(scored)
    lines = report.table(summary)
    host_ms = float(np.median([s.partition.host_ms for s in scored]))
    content = report.as_json(scored, summary, values, host_ms)
    stated = [report.stated(summary["test"])] if "test" in summary else []
    write_measurement(arguments.folder / SCORES, stated, content["halves"], **content)
    write_atomically(arguments.folder / REPORT, report.render_page(scored, lines))
    print("\n".join(lines))
    print(f"host {host_ms:.1f} ms; report: {arguments.folder / REPORT}")
    return EXIT_OK


def render_scene(folder: Path, quality: Quality, seed: int) -> None:
    from vista_eval.render.flight import render_flight
    from vista_eval.worlds.labelled import labelled  # loads what draws, which `--help` need not

    keep_to_one_core()
    flight = labelled(seed)
    for _ in render_flight(flight, folder / flight.name, quality):
        pass
