"""Render the flights, run the detector on them, and score it against the exact truth.

DIR holds one folder for each flight; flights that it lacks are rendered. Each flight goes through the stereo
engine and the host, and the result is scored against the truth. For comparison, the disparities alone are
thresholded and clustered ("stereo alone") and scored in the same way.

The scores are printed. DIR receives flights.json, which has every figure, and report.html.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tqdm import tqdm
from vista import parameters
from vista.command.arguments import add_config, load_parameters
from vista.errors import EXIT_OK, InputError
from vista.output import write_atomically

from vista_eval.baselines.stereo_alone import Outcome, outcomes_cached
from vista_eval.command.arguments import add_quality, add_sensor_noise
from vista_eval.dataset.truth import SPLITS, TRUTH, read_truth
from vista_eval.fly import UNDISTURBED, Disturbance, fly_cached, records_name
from vista_eval.jobs import Job, Place, add_place, chosen_place, is_worker, jobs_of, keep_to_one_core, run
from vista_eval.metrics.comparison import Comparison, compare, comparison_line
from vista_eval.metrics.flight_score import FlightScore, score_records, summary
from vista_eval.metrics.flight_segmentation import FlightSegmentation, rows, segment_cached
from vista_eval.metrics.flight_segmentation import table as segmentation_table
from vista_eval.metrics.goals import Goal, goal_line, goals
from vista_eval.metrics.group import group_score, table
from vista_eval.report.filmstrip import filmstrip
from vista_eval.report.flight_tables import stated
from vista_eval.report.flights_page import FlightPage, render_flights
from vista_eval.report.table import rounded, write_measurement

if TYPE_CHECKING:
    from vista_eval.render.flight import Flight, Quality

SCORES, REPORT = "flights.json", "report.html"
Work = Callable[[Path], Any]


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
    folders = [folder / name for name in names]
    found = score_all(works_of(arguments, values), folders, place)
    scores, segmented = found["fly"], found["segmentation"]
    noisy, alone = found.get("pose noise", []), found.get("stereo alone", [])
    sensed = {grey: found[sensor_noise_title(grey)] for grey in arguments.noise}
    comparison = compare(scores, alone) if alone else None
    against_stereo = comparison_untuned(scores, alone) if alone else None
    reached = goals(untuned(scores), untuned(noisy), against_stereo)
    print(table(scores))
    if noisy:
        print("\nwith pose noise:\n" + table(noisy))
    for grey, scored in sensed.items():
        print(f"\nwith sensor noise of {grey:g} grey levels:\n" + table(scored))
    if comparison is not None:
        print("\n" + comparison_line(comparison))
    print("\n" + segmentation_table(segmented) + "\n")
    print("\n".join(goal_line(goal) for goal in reached))
    write_scores(arguments.folder / SCORES, scores, noisy, sensed, segmented, comparison, reached, values)
    pages = [flight_page(values, flight) for flight in zip(folders, scores, strict=True)]
    page = render_flights(pages, noisy, sensed, segmented, comparison, reached, values)
    write_atomically(arguments.folder / REPORT, page)
    print(f"\nreport: {arguments.folder / REPORT}")
    return EXIT_OK


def untuned(scores: list[FlightScore]) -> list[FlightScore]:
    """The scores of the flights that parameters were not chosen on."""
    return [score for score in scores if score.split == "test"]


def comparison_untuned(scores: list[FlightScore], alone: list[list[Outcome]]) -> Comparison | None:
    theirs = [one for score, one in zip(scores, alone, strict=True) if score.split == "test"]
    return compare(untuned(scores), theirs) if theirs else None


def flight_page(values: parameters.Values, flight: tuple[Path, FlightScore]) -> FlightPage:
    folder, score = flight
    records = fly_cached(folder, values, folder / records_name())
    truth = read_truth(folder)
    return FlightPage(score, truth.focal_baseline_px_m, filmstrip(truth, score, records))


def works_of(arguments: argparse.Namespace, values: parameters.Values) -> dict[str, Work]:
    """What is made of every flight, by title."""
    flown = partial(fly_and_score, values, anew=arguments.fly_again)
    works: dict[str, Work] = {"fly": partial(flown, UNDISTURBED)}
    if arguments.pose_noise:
        works["pose noise"] = partial(flown, Disturbance(poses=True, seed=arguments.seed))
    for grey in arguments.noise:
        disturbance = Disturbance(image_grey=grey, seed=arguments.seed)
        works[sensor_noise_title(grey)] = partial(flown, disturbance)
    if not arguments.no_baseline:
        works["stereo alone"] = partial(stereo_alone, values)
    return works | {"segmentation": partial(segment, values)}


def sensor_noise_title(grey: float) -> str:
    return f"sensor noise {grey:g}"


def score_all(works: dict[str, Work], folders: list[Path], place: Place) -> dict[str, list[Any]]:
    """Results of each flight, in their order, by the title of the work."""
    jobs = [
        Job(f"{folder.name}, {title}", partial(work, folder))
        for title, work in works.items()
        for folder in folders
    ]
    results = iter(run(jobs, place, "score"))
    return {title: [next(results) for _ in folders] for title in works}


def fly_and_score(
    values: parameters.Values, disturbance: Disturbance, folder: Path, anew: bool = False
) -> FlightScore:
    records = fly_cached(folder, values, folder / records_name(disturbance), disturbance, anew)
    return score_records(folder, records, values)


def segment(values: parameters.Values, folder: Path) -> FlightSegmentation:
    return segment_cached(folder, values, folder / "segmentation.json")


def stereo_alone(values: parameters.Values, folder: Path) -> list[Outcome]:
    return outcomes_cached(folder, values, folder / "stereo_alone.json")


def write_scores(
    path: Path,
    scores: list[FlightScore],
    noisy: list[FlightScore],
    sensed: dict[float, list[FlightScore]],
    segmented: list[FlightSegmentation],
    comparison: Comparison | None,
    reached: list[Goal],
    values: parameters.Values,
) -> None:
    figures = {
        "groups": groups(scores),
        "pose_noise": groups(noisy),
        "sensor_noise": [
            {"grey_levels": grey, "groups": groups(scored)}
            for grey, scored in {0.0: scores, **sensed}.items()
        ],
    }
    content: dict[str, Any] = {
        "parameters": values,
        "flights": [summary(score) for score in scores],
        "groups": groups(scores),
        "goals": [asdict(goal) for goal in reached],
        "segmentation": [asdict(row) for row in rows(segmented) if row.things],
        "stereo_alone": comparison and asdict(comparison),
        "pose_noise": {"flights": [summary(score) for score in noisy], "groups": groups(noisy)},
        "sensor_noise": [
            {"grey_levels": grey, "flights": [summary(score) for score in scored], "groups": groups(scored)}
            for grey, scored in sensed.items()
        ],
    }
    write_measurement(path, stated(scores, sensed), rounded(figures, 2), **content)


def groups(scores: list[FlightScore]) -> list[dict[str, Any]]:
    members = {split: [score for score in scores if score.split == split] for split in SPLITS}
    found = [group_score(split, flights) for split, flights in members.items() if flights]
    return [asdict(group) | {"hit_rate": group.hit_rate} for group in found]


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
    keep_to_one_core()
    try:
        frames = render_flight(flight, out, quality)
        quiet = True if is_worker() else None
        for _ in tqdm(frames, name, frames_of(flight, quality), unit="frame", leave=False, disable=quiet):
            pass
    except OSError as error:
        raise InputError(error.filename or name, error.strerror or str(error)) from None
