"""The fault campaign: how a frame and an injection are judged, that each kind of disturbance disturbs, and a
small campaign on the street, in which no fault that is watched for is silent."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from shared_data import SHARED_DATA
from vista import parameters
from vista.geometry import Pose
from vista_eval.disturbances import KINDS, Now, Shot
from vista_eval.suites import faults
from vista_eval.suites.faults import (
    LENGTH,
    Faults,
    Part,
    Seen,
    apart,
    campaign,
    figures_of,
    judged,
    outcome_of,
    random_of,
    table,
)

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
CLEAN = Seen("healthy", 20.0, 19.0)
WATCHED = (
    "both cameras frozen",
    "left camera frozen",
    "right camera frozen",
    "left camera late",
    "right camera late",
    "right camera turned in yaw",
    "rows off",
    "words late",
    "words stand still",
    "bit of words at 0",
    "words of one value",
)


@pytest.mark.parametrize(
    ("seen", "outcome"),
    [
        (Seen("healthy", 20.5, 19.0), "masked"),
        (Seen("healthy", 10.0, 9.0), "safe"),
        (Seen("healthy", None, 15.0), "safe"),
        (Seen("healthy", 40.0, 38.0), "silent"),
        (Seen("healthy", None, 100.0), "silent"),
        (Seen("degraded", None, 100.0), "detected"),
        (Seen("healthy", np.nan, np.nan), "silent"),
        (Seen("refused", None, 0.0), "detected"),
        (Seen("stopped", None, 0.0), "detected"),
    ],
)
def test_a_warning_that_is_gone_is_silent_where_nothing_tells(seen: Seen, outcome: str) -> None:
    assert judged(CLEAN, seen) == outcome


def test_an_alarm_in_the_third_frame_is_in_time() -> None:
    assert outcome_of(["masked"] * LENGTH) == "masked"
    assert outcome_of(["silent", "silent", "silent", "detected", "masked"]) == "within 3"
    assert outcome_of(["silent", "silent", "silent", "silent", "detected"]) == "silent"
    assert outcome_of(["detected", "silent"]) == "within 3"
    assert outcome_of(["masked", "silent"]) == "silent"
    assert outcome_of(["safe", "detected"]) == "detected"


def test_a_program_that_crashes_or_hangs_has_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash() -> list[Seen]:
        os.kill(os.getpid(), signal.SIGSEGV)
        return [CLEAN]

    def hang() -> list[Seen]:
        time.sleep(60.0)
        return [CLEAN]

    def fail() -> list[Seen]:
        raise IndexError

    assert apart(lambda: [CLEAN]) == [CLEAN]
    monkeypatch.setattr(faults, "STOPPED_S", 0.2)
    assert [apart(work) for work in (crash, hang, fail)] == [None, None, None]


def test_recordings_whose_names_begin_alike_have_draws_of_their_own() -> None:
    part = Part(1, 0, ("fog",))
    drawn = {random_of(part, name).integers(1 << 31) for name in ("wires_000", "wires_001", "wires_0010")}
    assert len(drawn) == 3


SILENT = {
    "kind": "fog",
    "strength": 0.5,
    "outcome": "silent",
    "reasons": (),
    "recording": "a",
    "healthy": 7,
    "frames": 9,
}


def test_the_share_that_is_silent_has_an_exact_interval() -> None:
    rows = table([SILENT] + 99 * [SILENT | {"outcome": "masked"}], "kind").rows
    assert rows[-1] == ("all", "100", "99", "0", "0", "0", "1", "0.0 to 5.4 %", "")


def test_the_page_and_the_documentation_have_the_table_of_every_grouping() -> None:
    found = Faults([Path("a")], [Part(1, 0, ("fog",))]).scoring([[SILENT], [SILENT]], {})
    assert found.figures == {"injections": 2, "silent": 2} and found.content == {"results": [SILENT, SILENT]}
    assert [table.name for table in found.stated] == ["faults-kinds", "faults", "faults-recordings"]
    assert [table.name for table in found.shown] == ["faults-kinds"]
    assert [section.tables for section in found.page.sections] == [[table] for table in found.stated]
    assert "By recording" in found.page.render()


def test_recordings_have_their_healthy_frames_beside_what_was_injected() -> None:
    other = SILENT | {"recording": "other/a", "healthy": 2, "frames": 3}
    found = table([SILENT, SILENT, other], "recording")
    assert found.heads[:3] == ("recording", "healthy as it is", "times")
    assert [row[:3] for row in found.rows] == [
        ("a", "7 of 9", "2"),
        ("a", "2 of 3", "1"),
        ("all", "9 of 12", "3"),
    ]


@pytest.mark.parametrize("name", KINDS)
def test_each_kind_changes_what_it_names_and_nothing_before_the_onset(name: str) -> None:
    random = np.random.default_rng(1)
    images = random.integers(0, 256, (12, 2, 48, 64), np.uint8)
    shots = [
        Shot(left, right, 10**9 + k * 10**8, Pose(np.eye(3), np.array([0.0, 0.0, float(k)])))
        for k, (left, right) in enumerate(images)
    ]
    words = [
        [random.integers(-16, 500, (48 >> k, 64 >> k)).astype(np.int16) for k in range(3)] for _ in shots
    ]
    for strength in KINDS[name].strengths:
        changed = 0
        if (of_state := KINDS[name].of_state) is not None:
            state, now = images.tobytes(), Now(shots, 5, 5, strength, 1)
            upset = of_state(now, state)
            changed = np.unpackbits(np.frombuffer(upset, np.uint8) ^ images.ravel()).sum()
            assert changed == strength and of_state(now, state) == upset
        for index in range(5, 12):
            now = Now(shots, index, 5, strength, 1)
            if (of_words := KINDS[name].of_words) is not None:
                found = of_words(now, words)
                assert [level.shape for level in found] == [level.shape for level in words[index]]
                changed += any((a != b).any() for a, b in zip(found, words[index], strict=True))
            elif (of_shot := KINDS[name].of_shot) is not None:
                shot = of_shot(now)
                assert shot.left.shape == shot.right.shape == (48, 64)
                same_pose = shot.pose is not None and all(
                    np.array_equal(a, b)
                    for a, b in (
                        (shot.pose.rotation, shots[index].pose.rotation),
                        (shot.pose.translation_m, shots[index].pose.translation_m),
                    )
                )
                same_images = np.array_equal(shot.left, shots[index].left) and np.array_equal(
                    shot.right, shots[index].right
                )
                changed += not (same_pose and same_images and shot.t_ns == shots[index].t_ns)
        assert changed > 0 or (name == "bits of words upset" and strength < 1e-4)


@pytest.mark.slow
@pytest.mark.skipif(not STREET.is_dir(), reason="KITTI odometry 00 is not there")
def test_no_fault_that_is_watched_for_is_silent_on_the_street() -> None:
    results = campaign(parameters.defaults(), Part(1, 0, WATCHED), STREET)
    assert len(results) == 50
    assert [result for result in results if result["outcome"] == "silent"] == []
    assert figures_of(results)["detected"] > 10
    assert table(results).rows[-1][:2] == ("all", "50")
