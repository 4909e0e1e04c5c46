"""Sampled flights of a folder: scored strictly, by family, beside their controls; figures, tables and
report."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import partial
from pathlib import Path

from vista import parameters
from vista.errors import InputError
from vista.output import write_atomically

from vista_eval.dataset.truth import TRUTH
from vista_eval.jobs import HERE, Place, jobs_of, run
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.world_score import EVERYTHING, Beside, WorldScore, family_scores, score_world
from vista_eval.report.world_tables import as_text, tables
from vista_eval.report.worlds_page import render_worlds


def flights_in(folder: Path) -> list[Path]:
    """Raises InputError for a folder without any."""
    found = [path.parent for path in sorted(folder.glob(f"*/{TRUTH}"))]
    if not found:
        raise InputError(folder, "holds no flights")
    return found


def score_worlds(
    folder: Path, values: parameters.Values, beside: Beside = EVERYTHING, place: Place = HERE
) -> list[WorldScore]:
    """Of all flights in the folder."""
    work = partial(score_world, values=values, beside=beside)
    return run(jobs_of(work, flights_in(folder), lambda flight: flight.name), place, "score", "flight")


def write_worlds(
    folder: Path, worlds: list[WorldScore], values: parameters.Values, name: str = "worlds"
) -> str:
    """Writes NAME.json and NAME.html into the folder that holds those of the flights; the tables as text."""
    families = family_scores(worlds)
    made = tables(families)
    content = {
        "rules": asdict(STRICT),
        "parameters": values,
        "families": [asdict(family) for family in families],
        "tables": [asdict(table) for table in made],
        "flights": [asdict(world) for world in worlds],
    }
    write_atomically(folder / f"{name}.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
    write_atomically(folder / f"{name}.html", render_worlds(folder, worlds, values))
    return "\n\n".join(as_text(table) for table in made)
