"""The report of `vista dataset`: totals, and the recordings with the worst first."""

from __future__ import annotations

from typing import Any

import numpy as np
from vista.report.page import fill_template

from vista_eval.recordings.examine import Row
from vista_eval.report.table import aligned

SHOWN, PRINTED = 500, 10
HEADING = (
    "recording",
    "what is wrong",
    "frames",
    "blind",
    "degraded",
    "warned",
    "nearest, m",
    "host, ms",
    "p99, ms",
)


def render_page(prefix: str, ordered: list[Row]) -> str:
    return fill_template(
        "recordings.html.j2",
        package="vista_eval.report",
        prefix=prefix,
        cards=[{"name": name, "value": value} for name, value in totals(ordered).items()],
        heading=HEADING,
        rows=[{"cells": cells(row), "failed": row["error"] is not None} for row in ordered[:SHOWN]],
        left_out=len(ordered[SHOWN:]),
    )


def closing_lines(ordered: list[Row]) -> list[str]:
    """The worst, and the totals."""
    table = aligned([HEADING, *map(cells, ordered[:PRINTED])])
    return [table, "", ", ".join(f"{value} {name}" for name, value in totals(ordered).items())]


def totals(rows: list[Row]) -> dict[str, Any]:
    host_ms = [row["host_ms_median"] for row in rows if row["host_ms_median"] is not None]
    frames = {
        of: sum(row[f"frames_{of}"] for row in rows) for of in ("examined", "blind", "degraded", "warned")
    }
    return {
        "recordings": len(rows),
        "with an error": sum(row["error"] is not None for row in rows),
        "frames": frames["examined"],
        "frames blind": frames["blind"],
        "frames degraded": frames["degraded"],
        "frames with a warning": frames["warned"],
        "ms host, median of the recordings": f"{np.median(host_ms):.1f}" if host_ms else "no",
    }


def cells(row: Row) -> tuple[str, ...]:
    wrong = row["error"] or ", ".join(row["problems"])
    numbers = [row["nearest_warning_m"], row["host_ms_median"], row["host_ms_p99"]]
    return (
        row["recording"],
        wrong,
        f"{row['frames_examined']}"
        if row["frames"] == row["frames_examined"]
        else f"{row['frames_examined']} of {row['frames']}",
        *(f"{row[f'frames_{of}']}" for of in ("blind", "degraded", "warned")),
        *("" if number is None else f"{number:.1f}" for number in numbers),
    )
