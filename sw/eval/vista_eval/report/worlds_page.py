"""The report of sampled flights: one self-contained page, the frames that fail first."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vista import parameters
from vista.report.page import fill_template

import vista_eval.metrics
from vista_eval.dataset.truth import read_truth
from vista_eval.detectors import OURS
from vista_eval.fly import fly_cached, records_name
from vista_eval.metrics.world_score import WorldScore, family_scores
from vista_eval.report.filmstrip import filmstrip
from vista_eval.report.flights_page import still_view
from vista_eval.report.world_tables import tables

MOST_FLIGHTS = 60  # with pictures


def render_worlds(folder: Path, worlds: list[WorldScore], values: parameters.Values) -> str:
    """The page as HTML; folder: that holds those of the flights."""
    failing = sorted((world for world in worlds if failures(world)), key=failures, reverse=True)
    return fill_template(
        "worlds.html.j2",
        package="vista_eval.report",
        flights=len(worlds),
        frames=sum(len(world.scores[OURS].frames) for world in worlds),
        failing_frames=sum(failures(world) for world in worlds),
        failing=[failing_view(folder / world.name, world, values) for world in failing[:MOST_FLIGHTS]],
        without_pictures=[world.name for world in failing[MOST_FLIGHTS:]],
        tables=tables(family_scores(worlds)),
        definitions=vista_eval.metrics.__doc__,
        parameters=values,
    )


def failures(world: WorldScore) -> int:
    """Frames."""
    score = world.scores[OURS]
    return len({*score.missed, *score.false_alarm_frames})


def failing_view(folder: Path, world: WorldScore, values: parameters.Values) -> dict[str, Any]:
    records = fly_cached(folder, values, folder / records_name())
    score = world.scores[OURS]
    stills = filmstrip(read_truth(folder), score, records)
    return {
        "name": world.name,
        "family": world.family,
        "missed": len(score.missed),
        "alarms": len(score.false_alarm_frames),
        "stills": [still_view(still) for still in stills if still.failing],
    }
