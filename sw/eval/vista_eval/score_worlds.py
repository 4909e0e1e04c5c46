"""Sampled flights, flown and scored strictly beside their controls; figures, tables and report of their
families."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

from vista import parameters
from vista.output import write_atomically

from vista_eval.baselines.tracked_stereo import FULL, Sweep, tracked_cached
from vista_eval.controls import CONTROLS, control_cached
from vista_eval.dataset.truth import read_truth
from vista_eval.detectors import OURS
from vista_eval.fly import Disturbance, fly_cached, records_name
from vista_eval.jobs import HERE, Place, jobs_of, run
from vista_eval.metrics.flight_score import score_records
from vista_eval.metrics.flight_segmentation import segment_cached
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.world_score import WorldScore, family_scores
from vista_eval.report.table import rounded, write_measurement
from vista_eval.report.world_tables import tables
from vista_eval.report.worlds_page import render_worlds


@dataclass(frozen=True)
class Beside:
    """What is scored beside the detector as configured."""

    controls: tuple[str, ...] = CONTROLS[1:]
    sweep: Sweep | None = FULL  # of stereo alone with the host's tracker
    segmentation: bool = True
    noise_grey: tuple[float, ...] = ()


EVERYTHING, NOTHING = Beside(), Beside((), None, False)


def kept_name(control: str) -> str:
    return records_name() if control == OURS else f"records_{control.replace(' ', '_')}.json"


def score_world(folder: Path, values: parameters.Values, beside: Beside = EVERYTHING) -> WorldScore:
    """Flies and scores one flight on disk. What is kept in its folder is not made again."""
    truth = read_truth(folder)
    sweep = beside.sweep
    scores = {}
    for control in (OURS, *beside.controls):
        records = control_cached(control, folder, values, folder / kept_name(control))
        scores[control] = score_records(folder, records, values, STRICT)
    noisy = {}
    for grey in beside.noise_grey:
        disturbance = Disturbance(image_grey=grey)
        records = fly_cached(folder, values, folder / records_name(disturbance), disturbance)
        noisy[grey] = score_records(folder, records, values, STRICT)
    return WorldScore(
        truth.name,
        truth.family or truth.name,
        truth.split,
        scores,
        segment_cached(folder, values, folder / "segmentation.json") if beside.segmentation else None,
        () if sweep is None else tuple(tracked_cached(folder, values, folder / "tracked_stereo.json", sweep)),
        noisy,
    )


def score_worlds(
    folders: list[Path], values: parameters.Values, beside: Beside = EVERYTHING, place: Place = HERE
) -> list[WorldScore]:
    """Scores the flights in these folders."""
    work = partial(score_world, values=values, beside=beside)
    return run(jobs_of(work, folders, lambda folder: folder.name), place, "score", "flight")


def write_worlds(
    folder: Path, worlds: list[WorldScore], values: parameters.Values, name: str = "worlds"
) -> str:
    """Writes NAME.json and NAME.html into the folder that holds those of the flights; the tables as text."""
    families = family_scores(worlds)
    made = tables(families)
    figures = {"rules": asdict(STRICT), "families": rounded([asdict(family) for family in families], 3)}
    flights = [asdict(world) for world in worlds]
    named = [replace(table, name=f"{name}-{table.name}") for table in made]
    write_measurement(folder / f"{name}.json", named, figures, flights=flights, parameters=values)
    write_atomically(folder / f"{name}.html", render_worlds(folder, worlds, values))
    return "\n\n".join(table.as_text() for table in made)
