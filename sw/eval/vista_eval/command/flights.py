"""Render the flights, run the detector on them, and score it against the exact truth.

DIR holds one folder for each flight; flights that it lacks are rendered. Each flight goes through the stereo
engine and the host, and the result is scored against the truth. For comparison, the disparities alone are
thresholded and clustered ("stereo alone") and scored in the same way.

The scores are printed. DIR receives flights.json, which has every figure, and report.html.
"""

from __future__ import annotations

import argparse
from functools import partial
from multiprocessing import parent_process
from pathlib import Path
from typing import TYPE_CHECKING

from tqdm import tqdm
from vista.command.arguments import add_config, load_parameters
from vista.errors import EXIT_OK, InputError

from vista_eval.command.arguments import add_quality, add_sensor_noise
from vista_eval.dataset.truth import TRUTH
from vista_eval.jobs import add_place, chosen_place, jobs_of, run

if TYPE_CHECKING:
    from vista_eval.render.flight import Flight, Quality


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the flights")
    add_quality(parser, "flights", "quick")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="handle only these flights")
    parser.add_argument("--list", action="store_true", help="list the flights and stop")
    parser.add_argument(
        "--no-render",
        action="store_true",
        help="score what DIR holds, even if a flight would be rendered differently now",
    )
    parser.add_argument(
        "--fly-again",
        action="store_true",
        help="run flights again whose results are kept, to measure the times of the host anew; one at a "
        "time, unless --jobs or --cluster says otherwise",
    )
    parser.add_argument("--render-only", action="store_true", help="render what is missing and stop")
    parser.add_argument(
        "--no-baseline", action="store_true", help="leave out stereo alone, which takes longest"
    )
    parser.add_argument(
        "--pose-noise", action="store_true", help="score also with poses like those of a navigation filter"
    )
    add_sensor_noise(parser)
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="seed of all noise (default 1)")
    add_place(parser)
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    values = load_parameters(arguments.config, "golden")
    if arguments.list:
        list_flights()
        return EXIT_OK
    place = chosen_place(arguments, 1 if arguments.fly_again else None)
    folder = place.known_to_all(arguments.folder)
    names = chosen_names(folder, arguments.only, arguments.no_render)
    if not arguments.no_render:
        run(jobs_of(partial(render, folder, arguments.quality), names), place, "render", "flight")
    if arguments.render_only:
        return EXIT_OK
    from vista_eval.score import score
    from vista_eval.suites.flights import Flights  # loads libvista, which `--help` need not

    suite = Flights(
        [folder / name for name in names],
        arguments.pose_noise,
        tuple(arguments.noise),
        arguments.seed,
        not arguments.no_baseline,
        arguments.fly_again,
    )
    score(suite, arguments.folder, values, place)
    return EXIT_OK


def catalogue() -> dict[str, Flight]:
    from vista_eval.worlds.catalog import FLIGHTS  # takes a moment, for which `--help` need not wait

    return FLIGHTS


def list_flights() -> None:
    for name, flight in catalogue().items():
        print(f"{name:24s} {flight.split:7s} {flight.title}")


def chosen_names(folder: Path, only: list[str], held_only: bool) -> list[str]:
    """Names of the catalogue, in its order, and of what the folder holds beside it."""
    held = [path.parent.name for path in sorted(folder.glob(f"*/{TRUTH}"))]
    known = held if held_only else list(dict.fromkeys([*catalogue(), *held]))
    unknown = [name for name in only if name not in known]
    if unknown:
        raise InputError("--only", f"no flight {unknown[0]}; `vista flights DIR --list` names them")
    if not known:
        raise InputError(folder, "holds no flights")
    return [name for name in known if not only or name in only]


def render(folder: Path, quality: Quality, name: str) -> None:
    """What the folder lacks of a flight of the catalogue; what is there in full quality does for quick."""
    flight = catalogue().get(name)
    if flight is None:
        return
    from vista_eval.render.flight import frames_of, is_complete, render_flight

    out = folder / name
    if is_complete(flight, out, "full") or is_complete(flight, out, quality):
        return
    try:
        frames = render_flight(flight, out, quality)
        quiet = None if parent_process() is None else True  # of several that share a screen
        for _ in tqdm(frames, name, frames_of(flight, quality), unit="frame", leave=False, disable=quiet):
            pass
    except OSError as error:
        raise InputError(error.filename or name, error.strerror or str(error)) from None
