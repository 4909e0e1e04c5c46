"""Score the segmentation on labelled single scenes, against a control without a cut.

DIR holds folders scene_NNNN: a stereo pair (EuRoC ASL) with truth.json and truth/. Scenes of even seeds are
there to tune on, those of odd seeds to report on. The table is printed; DIR receives scenes.json and
scenes.html, which shows the worst and the best scenes.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from tqdm import tqdm

from vista import parameters
from vista.errors import EXIT_OK
from vista.output import write_atomically


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the scenes")
    parser.add_argument(
        "--config", type=Path, metavar="FILE.toml", help="parameters; `vista config` prints them"
    )


def execute(arguments: argparse.Namespace) -> int:
    from vista.score import scenes_report as report  # loads libvista, which `--help` need not
    from vista.score.scenes import partition_scenes, read_scenes

    values = parameters.load(arguments.config)
    scenes = read_scenes(arguments.folder)
    scored = []
    progress = tqdm(partition_scenes(scenes, values), total=len(scenes), unit="scene", disable=None)
    for scene, partition in progress:
        scored.append(report.score_scene(scene, partition))
    lines = report.table(scored)
    host_ms = float(np.median([s.partition.result.stage_ms["host"] for s in scored]))
    content = json.dumps(report.as_json(scored, values, host_ms), indent=1)
    write_atomically(arguments.folder / "scenes.json", content + "\n")
    write_atomically(arguments.folder / "scenes.html", report.render_page(scored, lines))
    print("\n".join(lines))
    print(f"host {host_ms:.1f} ms; report: {arguments.folder / 'scenes.html'}")
    return EXIT_OK
