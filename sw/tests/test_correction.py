"""The calibration is corrected in flight: right images are rectified for the turn that was found, by OpenCV
and by control grids, and a run tells of it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
import turned_camera as turned
from command_line import Vista
from obstacle_schema import valid_lines
from random_seed import seeded
from raw_rigs import RAW, WIDE, blob_centre, draw_spheres, rig
from turned_camera import degrees
from turned_recordings import CAMERA, write_turned_pairs
from vista import parameters
from vista.alignment import Alignment, State, Turn
from vista.chain import Chain, finish, take
from vista.control_grid import GridPair, control_grid
from vista.detector import Detector, Novelty
from vista.engine import INVALID, Disparity
from vista.engine.hardware import level_shapes
from vista.geometry import Pose, RawCalibration, rectified_rig
from vista.health.finding import Reason
from vista.health.finding import State as Health
from vista.history import StageClock
from vista.rectify import Rectifier, rectified_cameras
from vista.sequence import Frame, Sequence

ON = "[alignment]\ncorrect = 'on'\n"
TURN = degrees(0.7, -0.6)


# ---- the map ----


@pytest.mark.parametrize("buffer_rows", [0, 128])
def test_a_camera_that_has_turned_is_rectified_to_where_it_was(buffer_rows: int) -> None:
    """The turn is about the axes of the rectified camera, in the raw images of a lens."""
    _, (R, P) = rectified_cameras(RAW)
    turn_of_rays = R.T @ TURN.rotation() @ R
    right_from_left = Pose(turn_of_rays, np.zeros(3)) @ RAW.right_from_left
    places_m = np.array([(x, y, 4.0) for x in (-1.2, 0.0, 0.9) for y in (-0.9, 0.1, 0.8)])
    rectifier = Rectifier(RAW, buffer_rows)
    for place_m in places_m:
        image = draw_spheres(RAW.right, right_from_left, place_m[np.newaxis])
        found = turned.rectified_right(rectifier, TURN, image)
        x, y, z = P[:, :3] @ R @ RAW.right_from_left.apply(place_m)
        u, v = x / z, y / z
        assert blob_centre(found, u, v) == pytest.approx((u, v), abs=0.15)


def test_the_grid_of_a_turn_is_that_of_the_camera_that_has_turned() -> None:
    """It is, up to the bend of the map between control points, and two roundings."""
    _, (R, P) = rectified_cameras(WIDE)
    random = seeded(1)
    calibrated = control_grid(WIDE.right, R, P, "")
    rectifier = Rectifier(WIDE, 128)
    np.testing.assert_array_equal(turned.turned_grid(rectifier, Turn()), calibrated)
    bend = sum(np.abs(np.diff(calibrated.astype(int), 2, axis)).max() / 8 for axis in (0, 1))
    for _ in range(20):
        turn = degrees(*random.uniform(-1.0, 1.0, 2))
        exact = control_grid(WIDE.right, turn.rotation().T @ R, P, "")
        off = np.abs(turned.turned_grid(rectifier, turn).astype(int) - exact)[1:-2, 1:-2]
        assert off.max() <= bend + 1


def test_a_rectified_pair_is_not_resampled_without_a_turn() -> None:
    rectifier = Rectifier(rectified_rig(CAMERA, ""))
    pairs = turned.textured_flight(CAMERA, seeded(2))
    frames = list(turned.corrected(CAMERA, pairs, lambda _: TURN, 12))
    first, last = frames[0].frame, frames[-1]
    assert rectifier.rectify(first) is first and last.applied != Turn()
    np.testing.assert_array_equal(first.right, turned.seen(pairs(0)[1], CAMERA, TURN))
    np.testing.assert_array_equal(last.frame.left, pairs(11)[0])
    inner = (slice(20, -20), slice(20, -20))
    assert np.abs(last.frame.right[inner].astype(int) - pairs(11)[1][inner]).mean() < 2.0
    assert np.abs(first.right[inner].astype(int) - pairs(0)[1][inner]).mean() > 5.0


class Hardware:
    """An engine that rectifies, and matches nothing."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self.maps: list[GridPair] = []
        levels = parameters.defaults()["stereo"]["levels"]
        self._blank = [np.full(size, INVALID, np.int16) for size in level_shapes(shape, levels)]

    def load_map(self, grids: GridPair) -> None:
        self.maps.append(grids)

    def levels(self, *_: object) -> Iterator[Disparity]:
        return iter(self._blank)


def with_hardware(raw: RawCalibration, buffer_rows: int) -> tuple[Chain, Hardware]:
    rectifier, sequence = Rectifier(raw, buffer_rows), Sequence("", "pairs", raw, ())
    engine = Hardware((rectifier.calibration.height, rectifier.calibration.width))
    detector = Detector(rectifier, turned.correcting(buffer_rows=buffer_rows))
    return Chain(sequence, rectifier, engine, detector, engine_rectifies=True), engine  # type: ignore[arg-type]


def fly(chain: Chain, turn: Turn, seed: int) -> Alignment:
    """What is known after a dozen pairs of a camera that has turned."""
    camera, applied = chain.rectifier.calibration, Turn()
    pairs = turned.textured_flight(camera, seeded(seed))
    for k in range(12):
        left, right = pairs(k)
        frame = Frame(k, 1 + 40_000_000 * k, left, turned.seen(right, camera, turn, applied), None)
        chain.detector.take(frame.left, frame.right, frame.t_ns, rectified=True)
        found = finish(chain, frame, StageClock()).record.alignment
        applied = found.correction
    return found


def test_an_engine_that_rectifies_is_given_the_map() -> None:
    chain, engine = with_hardware(WIDE, 128)
    found, before = fly(chain, degrees(0.3, 0.0), 3), chain.rectifier.grids
    assert len(engine.maps) >= 1
    np.testing.assert_array_equal(engine.maps[-1].right, chain.detector.right_grid())
    assert engine.maps[-1].left is before.left
    assert (engine.maps[-1].right != before.right).any()
    assert found.correction.pitch_deg == pytest.approx(0.3, abs=0.03)
    blank = np.zeros((chain.rectifier.calibration.height, chain.rectifier.calibration.width), np.uint8)
    assert take(chain, Frame(0, 0, blank, blank, None)) == Novelty.RESTARTED
    np.testing.assert_array_equal(engine.maps[-1].right, before.right)


def test_a_turn_that_the_line_buffer_does_not_reach_raises_the_alarm() -> None:
    """The rig needs all of its 32 rows already."""
    chain, engine = with_hardware(rig(0.0, 0.0, 0.4), 32)
    found = fly(chain, degrees(-0.5, 0.0), 4)
    assert (found.state, found.health, found.changed) == (State.BEYOND, Health.BLIND, False)
    assert found.correction == Turn()
    np.testing.assert_array_equal(chain.detector.right_grid(), chain.rectifier.grids.right)
    assert engine.maps == []


# ---- a run ----


@pytest.mark.slow
def test_a_run_corrects_a_turn_in_flight_and_says_so(tmp_path: Path, run_vista: Vista) -> None:
    folder = write_turned_pairs(tmp_path / "flight", degrees(0.5, 0.0), 10, 40)
    (tmp_path / "on.toml").write_text(ON)
    valid = {}
    for name, options in (("on", ["--config", tmp_path / "on.toml"]), ("off", [])):
        out = tmp_path / name
        status, _, _ = run_vista("run", folder, "--out", out, "--no-overlay", *options)
        assert status == 0
        lines = valid_lines(out)
        assert all(Reason.ALIGNMENT_LOST not in line["health"]["reasons"] for line in lines)
        valid[name] = np.mean([line["valid_fraction"] for line in lines[25:]])
        alignment = json.loads((out / "summary.json").read_text())["alignment"]
        if name == "off":
            assert alignment is None
            continue
        assert alignment["pitch_deg"] == pytest.approx(0.5, abs=0.03)
        assert alignment["roll_deg"] == pytest.approx(0.0, abs=0.05)
        assert alignment["row_error_px"] < 0.3 and alignment["changes"] >= 1
        assert sum(alignment["frames"].values()) == 40
        assert "corrected at the end" in (out / "report.html").read_text()
    assert valid["on"] > 1.5 * valid["off"]


@pytest.mark.slow
def test_a_run_raises_the_alarm_when_a_turn_is_too_large(tmp_path: Path, run_vista: Vista) -> None:
    folder, out = write_turned_pairs(tmp_path / "flight", degrees(3.0, 0.0), 10, 50), tmp_path / "out"
    (tmp_path / "on.toml").write_text(ON)
    status, stdout, stderr = run_vista(
        "run", folder, "--out", out, "--no-overlay", "--config", tmp_path / "on.toml"
    )
    assert status == 0
    told = [line["frame"] for line in valid_lines(out) if "alignment_lost" in line["health"]["reasons"]]
    assert told and 10 < told[0] <= 40 and told[-1] == 49
    assert "has a camera moved?" in stdout and "has a camera moved?" in stderr


def test_the_picture_says_nothing_of_what_cv2_makes_of_a_homography() -> None:
    """The tests' own images: a homography of the rays is what the library's rotation means."""
    turn, place = degrees(0.8, 0.5), np.array([0.2, -0.1, 1.0])
    seen = turned.homography(CAMERA, turn) @ np.array([159.5 + 300 * 0.2, 119.5 - 300 * 0.1, 1.0])
    axis = cv2.Rodrigues(np.array([turn.pitch_rad, 0.0, turn.roll_rad]))[0]
    x, y, z = axis.T @ place  # the camera turns one way, what it sees the other
    assert seen[:2] / seen[2] == pytest.approx((159.5 + 300 * x / z, 119.5 + 300 * y / z), abs=1e-6)
