"""Draw figures 2 to 5 of the paper from the rendered flights.

DIR receives figure2.png (matching threshold), figure3.png (foveation), figure4.png (segmentation) and
figure5.png (flights).
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import add_config, load_parameters
from vista.errors import EXIT_OK
from vista.output import make_folder

FLIGHTS = Path("build/flights")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder that receives the pictures")
    parser.add_argument(
        "--flights",
        type=Path,
        default=FLIGHTS,
        metavar="DIR",
        help=f"folder that `vista flights` has filled (default {FLIGHTS})",
    )
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    import matplotlib as mpl
    from vista.report.plots import STYLE

    from vista_eval.figures import flights, foveation, segmentation, stereo_threshold
    from vista_eval.figures.canvas import save
    from vista_eval.figures.moments import read_flights

    values = load_parameters(arguments.config, "golden")
    truths = read_flights(arguments.flights)
    with mpl.rc_context(STYLE):
        figures = {
            "figure2.png": stereo_threshold.draw(truths, values),
            "figure3.png": foveation.draw(truths[0], values),
            "figure4.png": segmentation.draw(truths, values),
            "figure5.png": flights.draw(truths, values),
        }
    make_folder(arguments.folder)
    for name, figure in figures.items():
        print(save(figure, arguments.folder / name))
    return EXIT_OK
