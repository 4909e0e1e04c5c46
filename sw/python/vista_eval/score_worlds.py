"""Sampled flights of a folder: scored strictly, by family, beside their controls; figures, tables and
report."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from vista import parameters
from vista.errors import InputError
from vista.output import write_atomically

from vista_eval.dataset.truth import TRUTH
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.world_score import WorldScore, family_scores, score_world
from vista_eval.report.world_tables import as_text, tables
from vista_eval.report.worlds_page import render_worlds

SCORES, REPORT = "worlds.json", "worlds.html"


def flights_in(folder: Path) -> list[Path]:
    """Raises InputError for a folder without any."""
    found = [path.parent for path in sorted(folder.glob(f"*/{TRUTH}"))]
    if not found:
        raise InputError(folder, "holds no flights")
    return found


def score_worlds(folder: Path, values: parameters.Values) -> list[WorldScore]:
    """Of all flights, one after the other; `score_world` is the job of one of them."""
    return [score_world(flight, values) for flight in flights_in(folder)]


def write_worlds(folder: Path, worlds: list[WorldScore], values: parameters.Values) -> str:
    """Writes figures and report into the folder that holds those of the flights; the tables as text."""
    families = family_scores(worlds)
    made = tables(families)
    content = {
        "rules": asdict(STRICT),
        "parameters": values,
        "families": [asdict(family) for family in families],
        "tables": [asdict(table) for table in made],
        "flights": [asdict(world) for world in worlds],
    }
    write_atomically(folder / SCORES, json.dumps(content, indent=1, allow_nan=False) + "\n")
    write_atomically(folder / REPORT, render_worlds(folder, worlds, values))
    return "\n\n".join(as_text(table) for table in made)
