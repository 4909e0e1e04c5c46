"""Real recordings whose right camera turns by half a degree in mid-flight: the rows match again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import turned_camera as turned
from turned_camera import Corrected, Grey, degrees
from turned_recordings import REAL as RECORDINGS
from vista.alignment import State, Turn
from vista.geometry import Calibration
from vista.health.finding import State as Health
from vista.rectify import Rectifier
from vista.sequence import open_sequence

pytestmark = pytest.mark.slow

BEFORE, AFTER = 20, 50
JUMPS = {"pitch": (0.5, 0.0), "roll": (0.0, 0.5), "both": (-0.5, 0.5)}


def recording(name: str) -> tuple[Calibration, turned.Pairs]:
    """Played forwards and backwards, at the rate of turned_camera."""
    place: Path = RECORDINGS[name][0]
    if not place.is_dir():
        pytest.skip(f"{place} is not there")
    sequence = open_sequence(place)
    rectifier, last = Rectifier(sequence.calibration), len(sequence.frames) - 1

    def pair(k: int) -> tuple[Grey, Grey]:
        frame = rectifier.rectify(sequence.read(sequence.frames[last - abs(last - k % (2 * last))]))
        return frame.left, frame.right

    return rectifier.calibration, pair


def fly(name: str, turn: Turn) -> list[Corrected]:
    camera, pairs = recording(name)
    return list(turned.corrected(camera, pairs, lambda k: turn if k >= BEFORE else Turn(), BEFORE + AFTER))


@pytest.mark.parametrize("jump", JUMPS)
@pytest.mark.parametrize("name", RECORDINGS)
def test_rows_match_again_within_two_seconds(name: str, jump: str) -> None:
    frames = fly(name, degrees(*JUMPS[jump]))
    assert {frame.alignment.health for frame in frames[:BEFORE] + frames[BEFORE + 12 :]} == {Health.HEALTHY}
    assert frames[BEFORE].alignment.health != Health.HEALTHY
    rows_px = [frame.alignment.row_error_px for frame in frames[-10:]]
    assert np.median([row_px for row_px in rows_px if row_px is not None]) < RECORDINGS[name][1]
    before, after = frames[BEFORE - 1].alignment.estimate, frames[-1].alignment.estimate
    assert after.pitch_deg - before.pitch_deg == pytest.approx(JUMPS[jump][0], abs=0.03)
    assert after.roll_deg - before.roll_deg == pytest.approx(JUMPS[jump][1], abs=0.06)


@pytest.mark.parametrize("name", RECORDINGS)
def test_three_degrees_raise_the_alarm(name: str) -> None:
    frames = fly(name, degrees(3.0, 0.0))
    assert frames[BEFORE - 1].alignment.health == Health.HEALTHY
    assert {frame.alignment.health for frame in frames[BEFORE + 45 :]} == {Health.BLIND}


def test_a_good_calibration_of_a_real_camera_is_left_alone() -> None:
    frames = fly("EuRoC V1_01", Turn())
    assert {frame.applied for frame in frames} == {Turn()}
    assert {frame.alignment.state for frame in frames} == {State.MEASURED}
