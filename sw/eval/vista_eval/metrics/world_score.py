"""The strict scores of sampled flights, each with its controls, and of their families.

A flight: detector and controls (vista_eval.rivals) by rules.STRICT, stereo alone with the host's tracker at
each of its thresholds, and the segmentation of every eighth frame. A family: the same over its flights, with
intervals (vista_eval.metrics.intervals).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vista_eval.baselines.stereo_alone import Threshold
from vista_eval.baselines.tracked_stereo import TrackedOutcome
from vista_eval.metrics import free_directions
from vista_eval.metrics.consistency import Consistency, consistency
from vista_eval.metrics.flight_score import FIRST_DETECTION_M, FlightScore
from vista_eval.metrics.flight_segmentation import SHOWN, FlightSegmentation
from vista_eval.metrics.free_directions import FreeDirections
from vista_eval.metrics.free_path import FreePath, together
from vista_eval.metrics.intervals import MIN_FLIGHTS, Share, share_of_flights, share_of_frames
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.scenes import CUT
from vista_eval.metrics.segmentation import STATISTICS, difference_interval, interval
from vista_eval.rivals import ALONE_THRESHOLD, FOREST, OURS


@dataclass(frozen=True)
class WorldScore:
    """One flight."""

    name: str
    family: str
    split: str
    scores: dict[str, FlightScore]  # by control
    segmentation: FlightSegmentation | None
    tracked_stereo: tuple[TrackedOutcome, ...]  # at each threshold; none: left out
    noisy: dict[float, FlightScore] = field(default_factory=dict)  # by grey levels of sensor noise added


@dataclass(frozen=True)
class ControlScore:
    """The score of one control over the flights of a family."""

    frames: int
    hits: Share | None  # of the frames in which one is asked for
    missed_frames: int
    alarm_frames: int
    alarm_flights: Share | None
    within_2dz: Share | None  # of the matched frames
    median_dz: float | None
    consistency: Consistency | None
    first_far: (
        Share | None
    )  # of the flights that begin at FIRST_DETECTION_M or farther: warned of from there on
    degraded_frames: int
    blind_frames: int  # in which it says that it sees nothing
    free: FreePath
    directions: FreeDirections


@dataclass(frozen=True)
class SegmentationScore:
    things: int
    values: dict[str, dict[str, float]]  # statistic -> partition
    interval: dict[str, tuple[float, float]]  # of the cut; none with too few flights
    against_forest: dict[str, tuple[float, float]]  # of cut - forest, over the same flights


@dataclass(frozen=True)
class StereoScore:
    """Stereo alone with M of N against the detector."""

    thresholds: int
    missed: int  # frames, the detector's
    alarmed: int
    better: int  # thresholds with fewer misses at no more false alarms
    best: tuple[Threshold, int, int] | None  # the fewest misses at no more false alarms: missed, alarmed
    alone: tuple[int, int, int, int]  # at rivals.ALONE_THRESHOLD: hits, asked, missed, alarmed


@dataclass(frozen=True)
class FamilyScore:
    name: str
    split: str
    flights: int
    controls: dict[str, ControlScore]
    noisy: dict[float, ControlScore]
    segmentation: SegmentationScore | None
    stereo: StereoScore | None


ALL = "all"


def family_scores(worlds: list[WorldScore]) -> list[FamilyScore]:
    """A family each, in the order of their first flights, and all together."""
    families = list(dict.fromkeys(world.family for world in worlds))
    found = [family_score(name, [world for world in worlds if world.family == name]) for name in families]
    return [*found, family_score(ALL, worlds)]


def family_score(name: str, worlds: list[WorldScore]) -> FamilyScore:
    controls = {
        control: control_score([world.scores[control] for world in worlds]) for control in worlds[0].scores
    }
    noisy = {grey: control_score([world.noisy[grey] for world in worlds]) for grey in worlds[0].noisy}
    segmented = [world.segmentation for world in worlds if world.segmentation is not None]
    splits = {world.split for world in worlds}
    return FamilyScore(
        name,
        splits.pop() if len(splits) == 1 else "dev and test",
        len(worlds),
        controls,
        noisy,
        segmentation_score(segmented) if any(s.scores[CUT].things for s in segmented) else None,
        stereo_score(worlds) if all(world.tracked_stereo for world in worlds) else None,
    )


def control_score(flights: list[FlightScore]) -> ControlScore:
    errors_dz = [error for flight in flights for error in flight.errors_dz]
    far = [f for f in flights if f.begins_m is not None and f.begins_m >= FIRST_DETECTION_M]
    return ControlScore(
        frames=sum(len(flight.frames) for flight in flights),
        hits=share_of_frames([(flight.hits, flight.band_frames) for flight in flights]),
        missed_frames=sum(len(flight.missed) for flight in flights),
        alarm_frames=sum(len(flight.false_alarm_frames) for flight in flights),
        alarm_flights=share_of_flights([bool(flight.false_alarm_frames) for flight in flights]),
        within_2dz=share_of_frames([in_tolerance(flight) for flight in flights]),
        median_dz=float(np.median(errors_dz)) if errors_dz else None,
        consistency=consistency([(flight.nees, flight.nees_dimensions) for flight in flights]),
        first_far=share_of_flights([(f.first_detection_m or 0.0) >= FIRST_DETECTION_M for f in far]),
        degraded_frames=sum(flight.degraded_frames for flight in flights),
        blind_frames=sum(flight.unseeing_frames for flight in flights),
        free=together(flight.free for flight in flights),
        directions=free_directions.together(flight.directions for flight in flights),
    )


def in_tolerance(flight: FlightScore) -> tuple[int, int]:
    """Matched frames with an error of at most max(2 dz, 0.5 m), and all matched frames."""
    matched = [f for f in flight.frames if f.error_m is not None and f.range_m is not None]
    good = sum(
        dz <= 2.0 or (f.error_m or 0.0) <= STRICT.least_tolerance_m
        for f, dz in zip(matched, flight.errors_dz, strict=True)
    )
    return good, len(matched)


def segmentation_score(flights: list[FlightSegmentation]) -> SegmentationScore:
    cut, forest = ([flight.scores[name] for flight in flights] for name in (CUT, FOREST))
    partitions = {name: [flight.scores[name] for flight in flights] for name in flights[0].scores}
    values = {key: {name: STATISTICS[key](scores) for name, scores in partitions.items()} for key in SHOWN}
    enough = len(flights) >= MIN_FLIGHTS
    return SegmentationScore(
        sum(len(score.things) for score in cut),
        values,
        {key: interval(cut, STATISTICS[key]) for key in SHOWN} if enough else {},
        {key: difference_interval(cut, forest, STATISTICS[key]) for key in SHOWN} if enough else {},
    )


def stereo_score(worlds: list[WorldScore]) -> StereoScore:
    ours = [world.scores[OURS] for world in worlds]
    missed, alarmed = (sum(len(f.missed) for f in ours), sum(len(f.false_alarm_frames) for f in ours))
    points = [
        (group[0].threshold, sum(one.missed for one in group), sum(one.alarmed for one in group))
        for group in zip(*(world.tracked_stereo for world in worlds), strict=True)
    ]
    quiet = [point for point in points if point[2] <= alarmed]
    better = sum(point[1] < missed for point in quiet)
    best = min(quiet, key=lambda p: p[1:], default=None)
    fixed = [o for world in worlds for o in world.tracked_stereo if o.threshold == ALONE_THRESHOLD]
    hits, asked = sum(one.hits for one in fixed), sum(one.asked for one in fixed)
    alone = (hits, asked, sum(one.missed for one in fixed), sum(one.alarmed for one in fixed))
    return StereoScore(len(points), missed, alarmed, better, best, alone)


def logged_figures(family: FamilyScore) -> dict[str, Any]:
    """What the log of scorings keeps."""
    ours, segmented = family.controls[OURS], family.segmentation
    return {
        "flights": family.flights,
        "frames": ours.frames,
        "asked_frames": ours.hits.whole if ours.hits else 0,
        "hits": ours.hits.part if ours.hits else 0,
        "missed_frames": ours.missed_frames,
        "false_alarm_frames": ours.alarm_frames,
        "within_2dz": ours.within_2dz.value if ours.within_2dz else None,
        "nees": ours.consistency.average if ours.consistency else None,
        "iou_median": segmented.values["iou_median"][CUT] if segmented else None,
        "degraded_frames": ours.degraded_frames,
        "unseeing_frames": ours.blind_frames,
        "noise_false_alarm_frames": {f"{grey:g}": score.alarm_frames for grey, score in family.noisy.items()},
    }
