"""The flights' report: one self-contained page."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup
from vista import parameters
from vista.report.page import fill_template

import vista_eval.metrics
from vista_eval.dataset.truth import SPLITS
from vista_eval.metrics.comparison import Comparison, comparison_line
from vista_eval.metrics.flight_score import FlightScore
from vista_eval.metrics.flight_segmentation import (
    STRIDE,
    FlightSegmentation,
    cells,
    heads,
    interval_text,
    rows,
)
from vista_eval.metrics.goals import Goal
from vista_eval.metrics.group import COLUMNS, LEGEND, group_line, group_score
from vista_eval.metrics.segmentation import BOUNDARY_PX, FAR_M, NEAR_M
from vista_eval.pose_noise import ATTITUDE_SIGMA_DEG, POSITION_SIGMA_M
from vista_eval.report.filmstrip import Still
from vista_eval.report.flight_plots import plot_comparison, plot_detection, plot_error


@dataclass(frozen=True)
class FlightPage:
    score: FlightScore
    focal_baseline_px_m: float
    stills: list[Still]


def render_flights(
    pages: list[FlightPage],
    noisy: list[FlightScore],
    sensed: dict[float, list[FlightScore]],
    segmented: list[FlightSegmentation],
    comparison: Comparison | None,
    reached: list[Goal],
    values: parameters.Values,
) -> str:
    """The page as HTML; noisy: the same flights under pose noise, or none; sensed: under sensor noise, by its
    grey levels."""
    scores = [page.score for page in pages]
    tables = [("Scores", scores)]
    if noisy:
        error = f"{POSITION_SIGMA_M:g} m, {ATTITUDE_SIGMA_DEG:g} degrees"
        tables.append((f"With poses as of a navigation filter: {error}, drifting", noisy))
    tables += [(f"With sensor noise of {grey:g} grey levels", scored) for grey, scored in sensed.items()]
    return fill_template(
        "flights.html.j2",
        package="vista_eval.report",
        goals=reached,
        heads=[head for head, _ in COLUMNS],
        legend=LEGEND,
        tables=[(title, table_rows(scored)) for title, scored in tables],
        segmentation={
            "hint": f"Frames {STRIDE} apart, each by itself; standing things at {NEAR_M:g} to {FAR_M:g} m. "
            f"Boundary recall within {BOUNDARY_PX:g} px or one cell.",
            "heads": heads(),
            "rows": [
                (row.name, cells(row), interval_text(row) if row.intervals else "") for row in rows(segmented)
            ],
        },
        comparison=comparison and comparison_line(comparison),
        plots={
            "comparison": comparison and Markup(plot_comparison(comparison)),
            "detection": Markup(plot_detection(scores)),
        },
        flights=[flight_view(page) for page in pages],
        definitions=vista_eval.metrics.__doc__,
        parameters=values,
    )


def table_rows(scores: list[FlightScore]) -> list[dict[str, Any]]:
    """A group each: its rows, and the line of its totals."""
    groups = []
    for split in SPLITS:
        members = [score for score in scores if score.split == split]
        if members:
            rows = [
                {
                    "name": score.name,
                    "failing": bool(score.missed or score.false_alarm_frames),
                    "cells": [cell(score) for _, cell in COLUMNS],
                }
                for score in members
            ]
            groups.append({"rows": rows, "total": group_line(group_score(split, members))})
    return groups


def flight_view(page: FlightPage) -> dict[str, Any]:
    return {
        "name": page.score.name,
        "title": page.score.title,
        "split": page.score.split,
        "plot": Markup(plot_error((page.score, page.focal_baseline_px_m))),
        "stills": [still_view(still) for still in page.stills],
    }


def still_view(still: Still) -> dict[str, Any]:
    return {
        "frame": still.frame,
        "caption": still.caption,
        "failing": still.failing,
        "uri": "data:image/jpeg;base64," + base64.b64encode(still.jpeg).decode(),
    }
