"""What a whole run has found of the alignment of its cameras: for summary.json and the report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vista.alignment import State

if TYPE_CHECKING:
    from vista.history import FrameRecord


def summarize_alignment(records: list[FrameRecord]) -> dict[str, Any] | None:
    """`alignment` of summary.json; None: it was not looked at."""
    found = [record.alignment for record in records if record.alignment is not None]
    if not found:
        return None
    rows_px = [alignment.row_error_px for alignment in found if alignment.row_error_px is not None]
    last = found[-1]
    return {
        "pitch_deg": round(last.correction.pitch_deg, 4),
        "roll_deg": round(last.correction.roll_deg, 4),
        "changes": sum(alignment.changed for alignment in found),
        "row_error_px": round(float(np.median(rows_px)), 3) if rows_px else None,
        "frames": {str(state): sum(alignment.state == state for alignment in found) for state in State},
    }


def alignment_card(summary: dict[str, Any]) -> tuple[str, str, str]:
    """(value, name, remark) of a figure at the top of the report."""
    alignment = summary["alignment"]
    rows_px = alignment["row_error_px"]
    rows = "no features agree on a row error" if rows_px is None else f"median row error {rows_px:.2f} px"
    return (
        f"{alignment['pitch_deg']:+.2f}°, {alignment['roll_deg']:+.2f}°",
        "pitch and roll of the right camera, corrected at the end",
        f"{rows}; the correction changed {alignment['changes']} times",
    )
