"""Sampled flights, flown and scored strictly beside their controls, by family."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, astuple, dataclass, replace
from functools import partial
from pathlib import Path

from vista import parameters

import vista_eval.metrics
from vista_eval.baselines.tracked_stereo import FULL, Sweep, tracked_cached
from vista_eval.dataset.truth import read_truth
from vista_eval.fly import Disturbance, fly_cached, records_name
from vista_eval.jobs import Job, jobs_of
from vista_eval.metrics.flight_score import score_records
from vista_eval.metrics.flight_segmentation import segment_cached
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.world_score import WorldScore, family_scores
from vista_eval.report.filmstrip import filmstrip
from vista_eval.report.page import Page, Section
from vista_eval.report.table import Table, rounded
from vista_eval.rivals import ALONE_THRESHOLD, IN_HOST, OF_FLIGHTS, OURS
from vista_eval.score import Scoring
from vista_eval.suites.world_tables import tables


@dataclass(frozen=True)
class Beside:
    """What is scored beside the detector as configured."""

    controls: tuple[str, ...] = OF_FLIGHTS[1:]
    sweep: Sweep | None = FULL  # of stereo alone with the host's tracker
    segmentation: bool = True
    noise_grey: tuple[float, ...] = ()


AT_ONE_THRESHOLD = Sweep(*((value,) for value in astuple(ALONE_THRESHOLD)))
EVERYTHING, NOTHING = Beside(), Beside((), None, False)


def kept_name(control: str) -> str:
    return records_name() if control == OURS else f"records_{control.replace(' ', '_')}.json"


def score_world(folder: Path, values: parameters.Values, beside: Beside = EVERYTHING) -> WorldScore:
    """Flies and scores one flight on disk. What is kept in its folder is not made again."""
    truth = read_truth(folder)
    sweep = beside.sweep
    scores = {}
    for control in (OURS, *beside.controls):
        records = IN_HOST[control].fly_cached(folder, values, folder / kept_name(control))
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


@dataclass(frozen=True)
class Worlds:
    folders: list[Path]
    beside: Beside = EVERYTHING
    name: str = "worlds-dev"
    before_shown: Callable[[list[WorldScore], parameters.Values], None] = lambda worlds, values: None

    @property
    def page_name(self) -> str:
        return f"{self.name}.html"

    def jobs(self, values: parameters.Values) -> list[Job]:
        work = partial(score_world, values=values, beside=self.beside)
        return jobs_of(work, self.folders, lambda folder: folder.name)

    def scoring(self, results: list[WorldScore], values: parameters.Values) -> Scoring:
        self.before_shown(results, values)
        families = family_scores(results)
        shown = tables(families)
        flights = dict(zip(self.folders, results, strict=True))
        return Scoring(
            shown,
            page(flights, shown, values),
            {"flights": [asdict(world) for world in results], "parameters": values},
            [replace(table, name=f"{self.name}-{table.name}") for table in shown],
            {"rules": asdict(STRICT), "families": rounded([asdict(family) for family in families], 3)},
        )


# ---- the page ----

MOST_FLIGHTS = 60  # with pictures


def page(flights: dict[Path, WorldScore], shown: list[Table], values: parameters.Values) -> Page:
    """The frames that fail first."""
    failing = sorted((one for one in flights.items() if failures(one[1])), key=lambda one: -failures(one[1]))
    frames = sum(len(world.scores[OURS].frames) for world in flights.values())
    facts = (
        f"{len(flights)} flights, {frames} frames, scored strictly against their exact truth. Frames that "
        "fail: "
        f"{sum(map(failures, flights.values()))}, in {len(failing)} flights. Yellow: a tracked obstacle, "
        "red: "
        "one on the collision course, thin white box: the target's pixels."
    )
    sections = [failing_section(folder, world, values) for folder, world in failing[:MOST_FLIGHTS]]
    if len(failing) > MOST_FLIGHTS:
        names = ", ".join(world.name for _, world in failing[MOST_FLIGHTS:])
        sections.append(Section("Failing too, without pictures here", text=names))
    sections += [Section(table.title, [table]) for table in shown]
    return Page("Sampled flights", facts, sections, vista_eval.metrics.__doc__ or "", values)


def failures(world: WorldScore) -> int:
    """Frames that are missed, or have a false alarm."""
    score = world.scores[OURS]
    return len({*score.missed, *score.false_alarm_frames})


def failing_section(folder: Path, world: WorldScore, values: parameters.Values) -> Section:
    score, records = world.scores[OURS], fly_cached(folder, values, folder / records_name())
    counts = f"{len(score.missed)} missed, {len(score.false_alarm_frames)} with a false alarm"
    pictures = [one for one in filmstrip(read_truth(folder), score, records) if one.failing]
    return Section(f"{world.name} ({world.family}: {counts})", pictures=pictures)
