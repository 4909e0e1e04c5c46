"""The rows of all recordings as a Parquet table, and which of them are worst."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet
from vista.output import make_folder, write_atomically

from vista_eval.recordings.examine import Row

SCHEMA = pa.schema(
    [
        pa.field("recording", pa.string(), nullable=False),
        ("error", pa.string()),
        ("layout", pa.string()),
        ("bytes", pa.int64()),
        ("frames", pa.int64()),
        ("seconds", pa.float64()),
        ("frames_examined", pa.int64()),
        ("frames_warned", pa.int64()),
        ("nearest_warning_m", pa.float64()),
        ("frames_healthy", pa.int64()),
        ("frames_degraded", pa.int64()),
        ("frames_blind", pa.int64()),
        ("problems", pa.list_(pa.string())),
        ("obstacles_confirmed", pa.int64()),
        ("host_ms_median", pa.float64()),
        ("host_ms_p99", pa.float64()),
        ("total_ms_median", pa.float64()),
    ]
)


def write_table(path: Path, rows: Sequence[Row]) -> None:
    """Raises InputError when it cannot be written."""
    stream = io.BytesIO()
    pyarrow.parquet.write_table(pa.Table.from_pylist(list(rows), schema=SCHEMA), stream, compression="zstd")
    make_folder(path.parent)
    write_atomically(path, stream.getvalue())


def worst_first(rows: Sequence[Row]) -> list[Row]:
    """Those that could not be read, then by the share of frames that are blind, degraded, with a warning."""

    def badness(row: Row) -> tuple[bool, float, float, float]:
        frames = max(1, row.get("frames_examined") or 0)
        blind, degraded, warned = (row.get(f"frames_{of}") or 0 for of in ("blind", "degraded", "warned"))
        return row["error"] is not None, blind / frames, degraded / frames, warned / frames

    return sorted(sorted(rows, key=lambda row: row["recording"]), key=badness, reverse=True)
