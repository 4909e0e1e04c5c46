"""What the checks of a run measure on real pairs, as recorded and with each fault, and what they say of them.

usage: health_limits.py OUT.json

The recordings and faults are those of sw/tests/faulty_recordings.py."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

import faulty_recordings as real
from vista.health.checks import NEGATIVE_PX
from vista.health.features import match_pair
from vista.health.monitor import FEATURES
from vista.rectify import Rectifier
from vista.sequence import Sequence
from vista_eval.report.table import Table, span, write_measurement

COUNT = 51  # frames of each recording, at most
MEASURES = {
    "agreeing_share": "features that agree (share)",
    "row_error_px": "row error (px)",
    "row_spread_px": "scatter of rows (px)",
    "negative_share": "negative (share)",
}


def measure(name: str, folder: Path) -> Iterator[dict[str, Any]]:
    """A row for each fault: in how many frames each reason was given, and the ranges of what was measured."""
    sequence = real.open_recording(name, folder)
    rectifier = Rectifier(sequence.calibration)
    count = min(COUNT, len(sequence.frames))
    changes: dict[str, real.Fault | None] = {"none": None}
    changes |= {fault: change for fault, (change, _) in real.FAULTS.items()}
    for fault, change in changes.items():
        found = [reason for health in real.judged(sequence, count, change) for reason in health.reasons]
        row = {"recording": name, "fault": fault, "frames": count}
        row |= {"reasons": {str(reason): found.count(reason) for reason in dict.fromkeys(found)}}
        yield row | ranges(np.array([features(sequence, rectifier, index, change) for index in range(count)]))


def features(
    sequence: Sequence, rectifier: Rectifier, index: int, change: real.Fault | None
) -> tuple[float, ...]:
    frame = rectifier.rectify(real.read(sequence, index, change))
    matches = match_pair(frame.left, frame.right, FEATURES)
    rows = matches.near_rows()
    if len(rows) == 0:
        return 0.0, np.nan, np.nan, np.nan
    error_px = float(np.median(rows))
    spread_px = float(np.median(np.abs(rows - error_px)))
    negative = float(np.mean(matches.disparity_px < NEGATIVE_PX))
    return len(rows) / matches.candidates, abs(error_px), spread_px, negative


def ranges(measured: np.ndarray) -> dict[str, list[float]]:
    """Smallest and largest value of each measure, where it was one."""
    known = {name: column[np.isfinite(column)] for name, column in zip(MEASURES, measured.T, strict=True)}
    return {
        name: [round(float(column.min()), 2), round(float(column.max()), 2)]
        for name, column in known.items()
        if len(column)
    }


def table_of(rows: list[dict[str, Any]]) -> Table:
    cells = []
    for row in rows:
        reasons = ", ".join(f"`{name}` {count}" for name, count in row["reasons"].items()) or "none"
        ranges = (span(row.get(name)) for name in MEASURES)
        cells.append((row["recording"], row["fault"], str(row["frames"]), reasons, *ranges))
    heads = ("recording", "fault", "frames", "reasons and frames", *MEASURES.values())
    return Table("health", heads, cells)


def main(out: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        rows = [
            row
            for name, (place, _) in real.RECORDINGS.items()
            if place.is_dir()
            for row in measure(name, Path(folder) / name.replace(" ", "_"))
        ]
    write_measurement(out, [table_of(rows)], {"rows": rows})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
