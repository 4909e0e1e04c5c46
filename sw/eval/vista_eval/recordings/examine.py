"""What VISTA makes of one recording, as a row of a table."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from vista import native, parameters
from vista.chain import fitted_to, make_chain, run_frame
from vista.errors import InputError
from vista.health.finding import State
from vista.health.summary import summarize_health
from vista.history import FrameRecord, stage_statistics
from vista.sequence import Sequence, open_sequence

from vista_eval.cache import digest_of
from vista_eval.fly import LIBRARIES
from vista_eval.recordings.storage import as_folder

Row = dict[str, Any]


@dataclass(frozen=True)
class Detector:
    engine: str
    values: parameters.Values

    def digest(self) -> str | None:
        """The digest of what decides what it finds. None: nothing tells whether the simulated core has
        changed."""
        if self.engine == "rtl":
            return None
        values = str(sorted(parameters.flat(self.values).items()))
        return digest_of(self.engine, values, *map(native.library_path, LIBRARIES))


def examine(detector: Detector, prefix: str, name: str) -> Row:
    """A recording that cannot be read, or not to its end, has the reason in `error`."""
    with as_folder(prefix, name) as folder:
        records: list[FrameRecord] = []
        sequence, error = None, None
        obstacles: set[int] = set()
        try:
            sequence = open_sequence(folder)
            fly(detector, sequence, records, obstacles)
        except InputError as bad:
            error = str(bad).replace(f"{folder}/", "").replace(str(folder), folder.name)
    return row_of(sequence, records, obstacles) | {"error": error}


def fly(detector: Detector, sequence: Sequence, records: list[FrameRecord], obstacles: set[int]) -> None:
    """Appends a record of each frame, without its obstacles: a recording may be long. Of the things that
    were confirmed, the ids are added."""
    chain = make_chain(sequence, detector.engine, fitted_to(sequence, detector.values), threads=1)
    for files in sequence.frames:
        record = run_frame(chain, files).record
        obstacles |= {obstacle.id for obstacle in record.things}
        records.append(replace(record, items=record.items[:0]))


def row_of(sequence: Sequence | None, records: list[FrameRecord], obstacles: set[int]) -> Row:
    if sequence is None:
        return {"layout": None, "frames": 0, **figures([])}
    times_ns = [frame.t_ns for frame in sequence.frames]
    return {
        "layout": sequence.layout,
        "frames": len(sequence.frames),
        "seconds": 0.0 if sequence.stills else 1e-9 * (times_ns[-1] - times_ns[0]),
        "obstacles_confirmed": len(obstacles),
        **figures(records),
    }


def figures(records: list[FrameRecord]) -> Row:
    health = summarize_health(records)
    warned = [record.warning.distance_m for record in records if record.warning]
    times_ms = stage_statistics(records)
    return {
        "frames_examined": len(records),
        "frames_warned": len(warned),
        "nearest_warning_m": min(warned, default=None),
        **{f"frames_{state}": health["frames"][state] for state in State},
        "problems": [str(problem["reason"]) for problem in health["problems"]],
        "host_ms_median": times_ms["host"]["median"] if records else None,
        "host_ms_p99": times_ms["host"]["p99"] if records else None,
        "total_ms_median": times_ms["total"]["median"] if records else None,
    }
