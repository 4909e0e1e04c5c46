"""The report of `vista dataset`: totals, and the recordings with the worst first."""

from __future__ import annotations

from typing import Any

import numpy as np

from vista_eval.recordings.examine import Row
from vista_eval.report.page import Page, Section
from vista_eval.report.table import Table

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


def page(prefix: str, ordered: list[Row]) -> Page:
    more = len(ordered[SHOWN:])
    facts = ", ".join(f"{value} {name}" for name, value in totals(ordered).items())
    text = (
        "Worst first: what could not be read to its end, then by the share of frames that are blind, "
        "degraded, "
        f"with a collision warning.{f' {more} more are in the table recordings.parquet.' if more else ''}"
    )
    return Page(prefix, facts, [Section("Recordings", [table(ordered[:SHOWN])], text)])


def closing_lines(ordered: list[Row]) -> list[str]:
    """The worst, and the totals."""
    worst = table(ordered[:PRINTED]).as_text()
    return [worst, "", ", ".join(f"{value} {name}" for name, value in totals(ordered).items())]


def table(rows: list[Row]) -> Table:
    return Table("recordings", HEADING, [cells(row) for row in rows])


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
