"""The limits of the checks on real pairs: as recorded they are healthy, and each fault is found in them.
sw/eval/bench/health_limits.py measures the same on more frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import real_pairs as real
from numpy.typing import NDArray
from shared_data import REPOSITORY, SHARED_DATA
from vista import StereoEngine, parameters
from vista.alignment import Estimator, Turn
from vista.chain import engine_parameters
from vista.health.finding import FrameHealth, Reason, State
from vista.health.monitor import HealthMonitor
from vista.pipeline import Pipeline
from vista.rectify import Rectifier
from vista.sequence import Frame, Sequence, open_sequence

pytestmark = pytest.mark.slow

OAK_D = REPOSITORY / "build" / "demo" / "oak-d"

# Where each recording is, and how it becomes a sequence in a folder.
RECORDINGS: dict[str, tuple[Path, Callable[[Path], Path]]] = {
    "KITTI odometry 00": (SHARED_DATA / "kitti_odometry", lambda _: STREET),
    "EuRoC V1_01": (SHARED_DATA / "euroc_v101", lambda _: SHARED_DATA / "euroc_v101"),
    "OAK-D": (OAK_D, lambda _: OAK_D),
    "Bumblebee2": (
        SHARED_DATA / "bumblebee2",
        lambda folder: real.make_bumblebee2(
            folder, ["garden01", "garden02", "lantern01", "stones01", "sundial01", "wall01"]
        ),
    ),
    "KITTI 2012": (
        SHARED_DATA / "kitti2012",
        lambda folder: real.make_kitti2012(folder, (1226, 370)),
    ),
    "Middlebury": (SHARED_DATA / "middlebury", lambda folder: real.make_middlebury(folder, "teddy")),
}
STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
COUNT = 3  # frames of each recording, in the test

Grey = NDArray[np.uint8]
Pair = tuple[Grey, Grey]
Fault = Callable[[Pair, Pair], Pair]

# What becomes of the images of a frame; the second argument are those of the frame after the next.
FAULTS: dict[str, tuple[Fault, Reason]] = {
    "left and right swapped": (lambda pair, _: (pair[1], pair[0]), Reason.LEFT_RIGHT_SWAPPED),
    "right image 6 rows off": (
        lambda pair, _: (pair[0], np.roll(pair[1], 6, axis=0)),
        Reason.ROWS_MISALIGNED,
    ),
    "right image of another frame": (lambda pair, other: (pair[0], other[1]), Reason.MOMENTS_DIFFER),
    "right image black": (lambda pair, _: (pair[0], np.zeros_like(pair[1])), Reason.NO_CONTRAST),
    "left image black": (lambda pair, _: (np.zeros_like(pair[0]), pair[1]), Reason.NO_CONTRAST),
    "identical images": (lambda pair, _: (pair[0], pair[0]), Reason.IMAGES_IDENTICAL),
}
# Swapped raw images are rectified with each other's calibration, after which they no longer look alike.
OTHER_REASON = {("EuRoC V1_01", "left and right swapped"): Reason.MOMENTS_DIFFER}
NOTHING_TO_FIND = {  # one scene, or a camera that stands still: another moment looks the same
    ("EuRoC V1_01", "right image of another frame"),
    ("Middlebury", "right image of another frame"),
}


def open_recording(name: str, folder: Path) -> Sequence:
    place, make = RECORDINGS[name]
    if not place.is_dir():
        pytest.skip(f"{place} is not there")
    return open_sequence(make(folder))


def read(sequence: Sequence, index: int, fault: Fault | None) -> Frame:
    """The raw pair, with the fault."""
    raw = sequence.read(sequence.frames[index])
    if fault is None:
        return raw
    other = sequence.read(sequence.frames[(index + 2) % len(sequence.frames)])
    left, right = fault((raw.left, raw.right), (other.left, other.right))
    return replace(raw, left=left, right=right)


def judged(
    sequence: Sequence, count: int, fault: Callable[[Pair, Pair], Pair] | None = None
) -> Iterator[FrameHealth]:
    """Health of the first `count` frames, each with the fault."""
    values = parameters.defaults()
    rectifier = Rectifier(sequence.calibration)
    engine = StereoEngine(**vars(engine_parameters(values)))
    pipeline, monitor = Pipeline(rectifier.calibration, values), HealthMonitor(sequence)
    for index in range(min(count, len(sequence.frames))):
        raw = read(sequence, index, fault)
        frame = rectifier.rectify(raw)
        if sequence.stills:
            pipeline.reset()
        levels = list(engine.levels(frame.left, frame.right))
        result = pipeline.process(frame.left, levels, frame.t_ns, frame.world_from_camera, sequence.up_world)
        yield monitor.check(raw, frame, result.health)


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
    """Where it does, features are not matched a second time; where it does not, they are, to say why."""
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
