"""Goals of flights whose scores are made up: who is asked for a first detection, and for an RMS error."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import flight_on_disk as disk
import numpy as np
import pytest
from vista_eval.dataset.truth import FlightTruth, TrueObject
from vista_eval.metrics.flight_score import (
    FIRST_DETECTION_M,
    FOOT_M,
    FlightScore,
    companion_rms_ft,
    flight_score,
)
from vista_eval.metrics.free_path import FreePath
from vista_eval.metrics.goals import Goal, goals
from vista_eval.metrics.gospa import gospa
from vista_eval.metrics.group import table
from vista_eval.metrics.judge import FrameScore

TARGETS = {kind: TrueObject(2, kind, kind, True, True, np.zeros(3), np.zeros(3), (1.0, 1.0))
           for kind in ("sign", "pole", "tree")}  # fmt: skip
AGREEING = {"matched_id": 1, "tracked": True, "error_m": 0.5}


def truth(kind: str, speed_ft_s: float) -> FlightTruth:
    rig = (disk.FOCAL_PX, disk.BASELINE_M, (disk.CU, disk.CV))
    objects = {2: TARGETS[kind]}
    return FlightTruth(Path(), "", "", "test", *rig, speed_ft_s * FOOT_M, 10.0, objects, (), ())


def score(
    name: str,
    begins_m: int,
    tracked_from_m: float,
    warned_from_m: float,
    kind: str = "sign",
    first_frame_free: bool = False,
) -> FlightScore:
    """Frames a metre apart, down to 10 m; 10 ft/s."""
    silent = FrameScore(0, kind, None, 0, None, False, None, None, (), False)
    frames = [
        replace(silent, range_m=float(range_m), tracked=range_m <= tracked_from_m)
        for range_m in range(begins_m, 9, -1)
    ]
    frames = [replace(f, **AGREEING) if f.range_m <= warned_from_m else f for f in frames]
    frames = [silent] * first_frame_free + frames
    scored = flight_score(truth(kind, 10.0), frames, [gospa(np.zeros((0, 0)))], [], FreePath(), 5.0)
    return replace(scored, name=name)


def goal(scores: list[FlightScore], start: str) -> Goal:
    (found,) = (one for one in goals(scores, [], None) if one.demand.startswith(start))
    return found


def first_goals(scores: list[FlightScore]) -> list[Goal]:
    return [one for one in goals(scores, [], None) if one.demand.startswith("first detection")]


def test_tracks_and_warnings_are_judged_against_the_same_range() -> None:
    scores = [score("early", 75, 70, 62), score("late", 75, 60, 59), score("later", 75, 55, 50)]
    tracked, warned = first_goals(scores)
    common = "first detection of sign and pole at 60 m or farther: "
    assert [tracked.demand, warned.demand] == [common + "as a tracked obstacle", common + "as a warning"]
    assert (tracked.reached, tracked.met) == ("2 of 3 flights; not later 55.0 m", False)
    assert (warned.reached, warned.met) == ("1 of 3 flights; not late 59.0 m, later 50.0 m", False)
    assert [one.met for one in first_goals(scores[:1])] == [True, True]


def test_a_flight_from_nearby_is_named_but_not_asked_for_a_first_detection() -> None:
    far, close = score("far", 75, 70, 62, "pole"), score("close", 45, 41, 41, "pole")
    for one in first_goals([far, close]):
        assert (one.reached, one.met) == ("1 of 1 flights; begins nearer: close from 45.0 m 41.0 m", True)
    for one in first_goals([close]):
        assert (one.reached, one.met) == ("no such flight; begins nearer: close from 45.0 m 41.0 m", None)
    for one in first_goals([score("blind", 60, 0, 0), score("tree", 75, 20, 20, "tree")]):
        assert (one.reached, one.met) == ("0 of 1 flights; not blind never", False)


def test_what_a_flight_from_nearby_misses_is_told() -> None:
    """The flight begins at 40 m and is warned of from 36 m on: 22 of 26 frames in the band are hits, four are
    missed."""
    far, close = score("far", 75, 70, 62), score("close", 40, 36, 36)
    assert (close.hits, close.band_frames, close.missed) == (22, 26, (0, 1, 2, 3))
    hits = goal([far, close], "hit rate")
    assert (hits.reached, hits.met) == ("1 of 1 flights; begins nearer: close from 40.0 m 22/26", True)
    assert goal([close], "error at 50 ft").met
    assert goal([close], "|P - P^|").met
    assert re.search("close +36.0 +36.0 +22/26 +4 ", table([close]).as_text())


def test_what_comes_into_the_way_later_is_asked_for() -> None:
    """A target that is no danger in the first frame may be seen before it is one."""
    crossing = score("crossing", 40, 36, 36, first_frame_free=True)
    assert crossing.begins_m is None
    hits = goal([crossing], "hit rate")
    assert (hits.reached, hits.met) == ("0 of 1 flights; not crossing 22/26", False)
    for one in first_goals([crossing]):
        assert (one.reached, one.met) == ("0 of 1 flights; not crossing 36.0 m", False)


def test_a_flight_that_begins_at_the_asked_range_is_asked() -> None:
    assert goal([score("at", 45, 41, 41)], "hit rate").reached == "0 of 1 flights; not at 27/31"
    assert first_goals([score("at", 60, 59, 59)])[0].reached == "0 of 1 flights; not at 59.0 m"


@pytest.mark.parametrize(("begins_m", "rms_ft"), [(FIRST_DETECTION_M, 10.0), (45.0, None), (None, 10.0)])
def test_near_frames_alone_are_not_set_beside_the_companion_paper(
    begins_m: float | None, rms_ft: float | None
) -> None:
    assert companion_rms_ft(truth("sign", 10.0), begins_m) == rms_ft
    assert companion_rms_ft(truth("tree", 10.0), begins_m) is None
