"""The score of one flight (vista_eval.metrics defines each figure)."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from vista import parameters
from vista.geometry import Array, Calibration, Pose
from vista.health.finding import State
from vista.history import FrameRecord

from vista_eval.dataset.truth import FlightTruth
from vista_eval.fly import UNDISTURBED, Disturbance, fly, judged, open_flight
from vista_eval.metrics import free_directions
from vista_eval.metrics.consistency import Consistency, consistency
from vista_eval.metrics.frame_truth import FrameTruth, flight_frames, flight_surfaces
from vista_eval.metrics.free_directions import NO_DIRECTIONS, FreeDirections
from vista_eval.metrics.free_path import FrameOnPath, FreePath, free_path
from vista_eval.metrics.judge import FrameScore, Judge
from vista_eval.metrics.rules import PAPER, Rules
from vista_eval.metrics.segmentation import matched_area

FOOT_M = 0.3048
FIRST_DETECTION_M = 60.0  # demanded of flights that begin that far away
STAYS_FRAMES = 5  # after a first detection; all but one of them agree
ERROR_AT_FT = 50.0
# RMS tracking error of the companion paper's four flights, feet, by kind of obstacle and speed in ft/s.
COMPANION_RMS_FT = {("sign", 10): 10.0, ("sign", 30): 25.9, ("pole", 30): 22.1, ("pole", 10): 22.4}


@dataclass(frozen=True)
class FlightScore:
    name: str
    title: str
    split: str
    target_kind: str | None  # of the first target; None: the flight has none
    frames: tuple[FrameScore, ...]
    begins_m: float | None  # range of the target in the first frame, if it is a danger there
    tracked_from_m: float | None
    first_detection_m: float | None  # as a warning
    band_frames: int  # in which a hit is asked for: with a target in the band of the rules
    hits: int
    missed: tuple[int, ...]  # frames
    false_alarm_frames: tuple[int, ...]
    false_alarm_obstacles: int
    ghost_frames: int  # of the false alarm frames, with nothing real there at all
    errors_dz: tuple[float, ...]  # of the matched frames, in units of dz(r)
    nees: tuple[float, ...]
    nees_dimensions: tuple[int, ...]  # of each of them
    within_2dz: float | None  # share of matched frames with an error of at most 2 dz(r)
    median_dz: float | None  # median error in units of dz(r)
    rms_ft: float | None
    companion_rms_ft: float | None
    error_at_50_ft: float | None  # feet
    id_switches: int
    consistency: Consistency | None
    blind_frames: int
    blind_reported: int  # of these, with a warning that agrees
    degraded_frames: (
        int  # in which the detector says that it sees too little, or where it is rests on a guess
    )
    unseeing_frames: int  # in which it says that it sees nothing
    free: FreePath
    host_ms: float  # median
    directions: FreeDirections = NO_DIRECTIONS

    @property
    def matched_frames(self) -> int:
        return len(self.errors_dz)

    @property
    def hit_rate(self) -> float | None:
        return self.hits / self.band_frames if self.band_frames else None


def score_flight(
    folder: Path, values: parameters.Values, disturbance: Disturbance = UNDISTURBED
) -> dict[str, Any]:
    """Flies and scores the flight on disk; the figures as plain numbers, `frames` a list. For tuning."""
    records = [judged(step) for step in fly(open_flight(folder, disturbance), values)]
    return summary(score_records(folder, records, values))


def summary(score: FlightScore) -> dict[str, Any]:
    return asdict(score) | {"hit_rate": score.hit_rate}


def score_records(
    folder: Path, records: list[FrameRecord], values: parameters.Values, rules: Rules = PAPER
) -> FlightScore:
    """records: of every frame of the flight, in its order."""
    truth, frames = flight_frames(folder, rules)
    judge = Judge(truth, blind_depth_m(truth, values), flight_surfaces(folder, rules), rules)
    by_time = {record.t_ns: record for record in records}
    scored: list[FrameScore] = []
    on_path: list[FrameOnPath] = []
    for frame in frames:
        record = by_time[frame.t_ns]
        believed = record.world_from_camera or Pose()
        world_from_estimate = frame.world_from_camera @ believed.inverse()
        scored.append(judge.frame(frame, record.obstacles, record.nearest_collision, world_from_estimate))
        on_path.append(along_path(truth, frame, record))
    host_ms = float(np.median([record.stage_ms["host"] for record in records]))
    states = [record.health.state for record in records]
    score = flight_score(truth, scored, states, free_path(on_path), host_ms)
    return replace(score, directions=along_directions(truth, by_time, values))


def along_path(truth: FlightTruth, frame: FrameTruth, record: FrameRecord) -> FrameOnPath:
    return FrameOnPath(
        frame.contact_m,
        frame.path_m,
        truth.speed_m_s,
        record.path_seen_m,
        record.nearest_collision is not None,
        record.health.state == State.HEALTHY,
    )


def along_directions(
    truth: FlightTruth, records: dict[int, FrameRecord], values: parameters.Values
) -> FreeDirections:
    stereo, found = values["stereo"], []
    for t_ns, record in records.items():
        if record.directions is None:
            continue
        disparity_px = truth.disparity_px(t_ns)
        height, width = disparity_px.shape
        camera = Calibration(width, height, truth.focal_px, *truth.center_px, truth.baseline_m)
        area = matched_area(height, width, stereo["num_disparities"], stereo["block_size"])
        found.append(free_directions.free_directions(record.directions, camera, disparity_px, area))
    return free_directions.together(found)


def blind_depth_m(truth: FlightTruth, values: parameters.Values) -> float:
    """Nearer, along the optical axis, nothing is matched."""
    stereo = values["stereo"]
    return truth.focal_baseline_px_m / ((stereo["num_disparities"] - 1) << (stereo["levels"] - 1))


def flight_score(
    truth: FlightTruth,
    frames: list[FrameScore],
    states: list[State],
    free: FreePath,
    host_ms: float,
) -> FlightScore:
    matched = [frame for frame in frames if frame.error_m is not None]
    ranges_m = np.array([frame.range_m for frame in matched], float)
    errors_m = np.array([frame.error_m for frame in matched], float)
    in_dz = errors_m / truth.depth_of_one_disparity_m(ranges_m)
    tested = [(frame.nees, frame.nees_dimensions) for frame in matched if frame.nees is not None]
    nees, dimensions = tuple(value for value, _ in tested), tuple(count for _, count in tested)
    ids = [frame.matched_id for frame in matched]
    alarms = [k for k, frame in enumerate(frames) if frame.false_alarms]
    blind = [frame for frame in frames if frame.blind]
    return FlightScore(
        name=truth.name,
        title=truth.title,
        split=truth.split,
        target_kind=truth.targets[0].kind if truth.targets else None,
        frames=tuple(frames),
        begins_m=frames[0].range_m,
        tracked_from_m=first_that_stays_m(frames, [frame.tracked for frame in frames]),
        first_detection_m=first_that_stays_m(frames, [frame.matched_id is not None for frame in frames]),
        band_frames=sum(frame.in_band for frame in frames),
        hits=sum(frame.hit for frame in frames),
        missed=tuple(k for k, frame in enumerate(frames) if frame.missed),
        false_alarm_frames=tuple(alarms),
        false_alarm_obstacles=len({alarm.id for frame in frames for alarm in frame.false_alarms}),
        ghost_frames=sum(any(alarm.ghost for alarm in frame.false_alarms) for frame in frames),
        errors_dz=tuple(in_dz.tolist()),
        nees=nees,
        nees_dimensions=dimensions,
        within_2dz=float(np.mean(in_dz <= 2.0)) if matched else None,
        median_dz=float(np.median(in_dz)) if matched else None,
        rms_ft=float(np.sqrt(np.mean(errors_m**2))) / FOOT_M if matched else None,
        companion_rms_ft=companion_rms_ft(truth, frames[0].range_m),
        error_at_50_ft=error_at_ft(ranges_m, errors_m, ERROR_AT_FT),
        id_switches=sum(a != b for a, b in pairwise(ids)),
        consistency=consistency([(nees, dimensions)]),
        blind_frames=len(blind),
        blind_reported=sum(frame.matched_id is not None for frame in blind),
        degraded_frames=states.count(State.DEGRADED),
        unseeing_frames=states.count(State.BLIND),
        free=free,
        host_ms=host_ms,
    )


def first_that_stays_m(frames: list[FrameScore], agreeing: list[bool]) -> float | None:
    """Range in the first frame that agrees and stays; agreeing: of each frame."""
    for k, frame in enumerate(frames):
        if agreeing[k] and agreeing[k + 1 : k + 1 + STAYS_FRAMES].count(False) <= 1:
            return frame.range_m
    return None


def error_at_ft(ranges_m: Array, errors_m: Array, range_ft: float) -> float | None:
    """Feet, between the matched frames on both sides of the range; None if the flight has no such."""
    wanted_m = range_ft * FOOT_M
    order = np.argsort(ranges_m)
    if not len(ranges_m) or not ranges_m.min() <= wanted_m <= ranges_m.max():
        return None
    return float(np.interp(wanted_m, ranges_m[order], errors_m[order])) / FOOT_M


def companion_rms_ft(truth: FlightTruth, begins_m: float | None) -> float | None:
    """None for a flight from nearby too: an RMS of near frames alone would flatter."""
    if begins_m is not None and begins_m < FIRST_DETECTION_M:
        return None
    kinds = {target.kind for target in truth.targets}
    return next(
        (
            rms_ft
            for (kind, speed), rms_ft in COMPANION_RMS_FT.items()
            if kinds == {kind} and round(truth.speed_m_s / FOOT_M) == speed
        ),
        None,
    )
