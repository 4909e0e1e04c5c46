"""The limits of the checks on real pairs: as recorded they are healthy, and each fault is found in them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import faulty_recordings
import numpy as np
import pytest
from faulty_recordings import FAULTS, RECORDINGS, judged, read
from turned_camera import Estimator
from vista.alignment import Turn
from vista.health.finding import Reason, State
from vista.health.monitor import HealthMonitor
from vista.rectify import Rectifier
from vista.sequence import Sequence

pytestmark = pytest.mark.slow

COUNT = 3  # frames of each recording
# Swapped raw images are rectified with each other's calibration, after which they no longer look alike.
OTHER_REASON = {("EuRoC V1_01", "left and right swapped"): Reason.MOMENTS_DIFFER}
NOTHING_TO_FIND = {  # one scene, or a camera that stands still: another moment looks the same
    ("EuRoC V1_01", "right image of another frame"),
    ("Middlebury", "right image of another frame"),
}


def open_recording(name: str, folder: Path) -> Sequence:
    place, _ = RECORDINGS[name]
    if not place.is_dir():
        pytest.skip(f"{place} is not there")
    return faulty_recordings.open_recording(name, folder)


@pytest.mark.parametrize("name", RECORDINGS)
def test_real_pairs_are_healthy(tmp_path: Path, name: str) -> None:
    for health in judged(open_recording(name, tmp_path), COUNT):
        assert health.findings == ()


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("name", RECORDINGS)
def test_each_fault_is_found_in_real_pairs(tmp_path: Path, name: str, fault: str) -> None:
    if (name, fault) in NOTHING_TO_FIND:
        pytest.skip("another moment looks the same")
    change, reason = FAULTS[fault]
    reason = OTHER_REASON.get((name, fault), reason)
    found = list(judged(open_recording(name, tmp_path), COUNT, change))
    assert len(found) > 0
    assert all(reason in health.reasons and health.state == State.BLIND for health in found)


ALIGNED = [name for name in RECORDINGS if name != "KITTI 2012"]  # half of whose pairs are kept for results


@pytest.mark.parametrize("fault", [None, *list(FAULTS)[:3]])
@pytest.mark.parametrize("name", ALIGNED)
def test_the_alignment_knows_the_rows_of_pairs_that_belong_together(
    tmp_path: Path, name: str, fault: str | None
) -> None:
    """It does, and then features are not matched a second time; else they are, to say why."""
    if (name, fault) in NOTHING_TO_FIND:
        pytest.skip("another moment looks the same")
    sequence = open_recording(name, tmp_path)
    rectifier = Rectifier(sequence.calibration)
    for index in range(min(COUNT, len(sequence.frames))):
        frame = rectifier.rectify(read(sequence, index, FAULTS[fault][0] if fault else None))
        found = Estimator(rectifier.calibration).update(frame.left, frame.right, 1, Turn())
        if fault is None:
            assert found.row_error_px is not None and found.health == State.HEALTHY
        elif FAULTS[fault][1] == Reason.ROWS_MISALIGNED:
            assert found.row_error_px is not None and found.health == State.BLIND
        else:
            assert found.row_error_px is None


def scaled(sequence: Sequence, factor: float) -> Sequence:
    """The sequence with the calibration of images that are so many times as large."""
    raw = sequence.calibration
    cameras = {
        side: replace(camera, matrix=np.diag([factor, factor, 1.0]) @ camera.matrix)
        for side, camera in (("left", raw.left), ("right", raw.right))
    }
    return replace(sequence, calibration=replace(raw, **cameras))


@pytest.mark.parametrize("factor", [0.5, 0.75, 1.5, 2.0])
@pytest.mark.parametrize("name", RECORDINGS)
def test_a_calibration_of_another_size_is_found(tmp_path: Path, name: str, factor: float) -> None:
    monitor = HealthMonitor(scaled(open_recording(name, tmp_path), factor))
    assert [finding.reason for finding in monitor.of_run] == [Reason.CALIBRATION_MISFIT]
