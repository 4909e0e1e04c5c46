"""The flights and frames that the figures show, and the results of the chain for them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from vista import parameters
from vista.chain import Step
from vista.errors import InputError

from vista_eval.dataset.truth import TRUTH, FlightTruth, read_truth
from vista_eval.fly import fly, open_flight
from vista_eval.metrics.flight_score import FlightScore, score_records

SHOWN_RANGE_M = 30.0  # of the target


@dataclass(frozen=True)
class Moment:
    """One frame of a flight, after all frames before it."""

    truth: FlightTruth
    step: Step


def read_flights(folder: Path) -> list[FlightTruth]:
    """Reads flights in the order of their names. Raises InputError where there is none."""
    truths = [read_truth(path.parent) for path in sorted(folder.glob(f"*/{TRUTH}"))]
    if not truths:
        raise InputError(folder, "holds no flights; `vista flights` renders them")
    return truths


def shown_frame(truth: FlightTruth) -> int:
    """The one whose target is nearest to SHOWN_RANGE_M; without a target the middle one."""
    frames = open_flight(truth.folder).frames
    poses = {files.t_ns: files.world_from_camera for files in frames if files.world_from_camera is not None}
    off_m = [
        (abs(float(np.linalg.norm(seen[label]["position_m"] - poses[t_ns].translation_m)) - SHOWN_RANGE_M), k)
        for k, (t_ns, seen) in enumerate(zip(truth.times_ns, truth.seen, strict=True))
        for label in seen.keys() & {target.label for target in truth.targets}
    ]
    return min(off_m)[1] if off_m else len(truth.times_ns) // 2


def fly_to(truth: FlightTruth, index: int, values: parameters.Values) -> Moment:
    (step,) = islice(fly(open_flight(truth.folder), values), index, index + 1)
    return Moment(truth, step)


def fly_through(truth: FlightTruth, index: int, values: parameters.Values) -> tuple[Moment, FlightScore]:
    """The frame of that index, and the score of the whole flight."""
    records, shown = [], None
    for k, step in enumerate(fly(open_flight(truth.folder), values)):
        records.append(step.record)
        if k == index:
            shown = step.keep()
    assert shown is not None, f"{truth.folder} has no frame {index}"
    return Moment(truth, shown), score_records(truth.folder, records, values)
