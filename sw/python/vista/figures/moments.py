"""Which flights and frames the figures show, and what the chain makes of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vista import parameters
from vista.command.run import make_chain
from vista.errors import InputError
from vista.run import Step, run_frame
from vista.score.flight import FlightScore, score_records
from vista.score.fly import open_flight
from vista.score.truth import TRUTH, FlightTruth, read_truth

SHOWN_RANGE_M = 30.0  # of the target


@dataclass(frozen=True)
class Moment:
    """One frame of a flight, after all frames before it."""

    truth: FlightTruth
    index: int
    step: Step


def read_flights(folder: Path) -> list[FlightTruth]:
    """By name. Raises InputError where there is none."""
    truths = [read_truth(path.parent) for path in sorted(folder.glob(f"*/{TRUTH}"))]
    if not truths:
        raise InputError(folder, "holds no flights; `vista flights` renders them")
    return truths


def shown_frame(truth: FlightTruth) -> int:
    """The one whose target is nearest to SHOWN_RANGE_M; without a target the middle one."""
    poses = {files.t_ns: files.world_from_camera for files in open_flight(truth.folder).frames}
    off_m = [
        (abs(float(np.linalg.norm(seen[label]["position_m"] - poses[t_ns].translation_m)) - SHOWN_RANGE_M), k)
        for k, (t_ns, seen) in enumerate(zip(truth.times_ns, truth.seen, strict=True))
        for label in seen.keys() & {target.label for target in truth.targets}
    ]
    return min(off_m)[1] if off_m else len(truth.times_ns) // 2


def fly_to(truth: FlightTruth, index: int, values: parameters.Values) -> Moment:
    sequence = open_flight(truth.folder)
    chain = make_chain(sequence, "golden", values, threads=1)
    steps = (run_frame(chain, files) for files in sequence.frames[: index + 1])
    *_, last = steps
    return Moment(truth, index, last)


def fly_through(truth: FlightTruth, index: int, values: parameters.Values) -> tuple[Moment, FlightScore]:
    """The frame of that index, and the score of the whole flight."""
    sequence = open_flight(truth.folder)
    chain = make_chain(sequence, "golden", values, threads=1)
    records, shown = [], None
    for k, files in enumerate(sequence.frames):
        step = run_frame(chain, files)
        records.append(step.record)
        if k == index:
            shown = step
    return Moment(truth, index, shown), score_records(truth.folder, records, values)
