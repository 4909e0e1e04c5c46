"""Control grids from calibrations: near the exact map, followed to the bit, refused by a small buffer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from numpy.typing import NDArray
from random_seed import seeded
from raw_rigs import WIDE, rig
from raw_rigs import WIDE_SIZE as SIZE
from vista import parameters
from vista.chain import make_chain, run_frame
from vista.control_grid import BUFFER_ROWS, control_grid
from vista.errors import InputError
from vista.geometry import CameraModel, camera_matrix
from vista.rectify import Rectifier, by_table, rectified_cameras
from vista.sequence import Frame, open_sequence
from vista_model import rectify, row_beyond, sources


def exact_sources_px(camera: CameraModel, R: NDArray[np.float64], P: NDArray[np.float64]) -> NDArray:
    return np.stack(
        cv2.initUndistortRectifyMap(camera.matrix, np.array(camera.distortion), R, P, SIZE, cv2.CV_32FC1), -1
    )


@pytest.mark.parametrize("side", [0, 1])
def test_sources_are_near_those_of_the_exact_map(side: int) -> None:
    """They differ at a control point by half of 1/32 px in each direction; between them by the map's bend
    besides."""
    camera = (WIDE.left, WIDE.right)[side]
    R, P = rectified_cameras(WIDE)[side]
    exact_px = exact_sources_px(camera, R, P)
    grid = control_grid(camera, R, P, WIDE.source)
    assert grid.shape == (26, 41, 2)
    found_px = np.stack(sources(grid, *SIZE[::-1]), -1) / 32
    off_px = np.abs(found_px - exact_px)
    # float32 of the exact map rounds a place near 640 px by 3e-5 px
    assert off_px[::16, ::16].max() <= 1 / 64 + 1e-4
    # A straight line between points 16 px apart errs by 16^2/8 of the second derivative, along each axis.
    bend_px = sum(16**2 / 8 * np.abs(np.diff(exact_px, 2, axis)).max() for axis in (0, 1))
    assert off_px.max() <= bend_px + 2 / 64 + 1e-3
    assert np.hypot(*np.moveaxis(off_px, -1, 0)).mean() < 0.08


def test_pixels_are_near_those_of_opencv_and_equal_those_of_the_model() -> None:
    rng = seeded(0)
    noise = rng.integers(0, 256, SIZE[::-1]).astype(np.float32)
    smooth = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 3.0), None, 0, 255, cv2.NORM_MINMAX)
    images = smooth.astype(np.uint8), np.ascontiguousarray(smooth.astype(np.uint8)[::-1])
    frame = Rectifier(WIDE, 128).rectify(Frame(0, 0, *images, None))
    exact = Rectifier(WIDE).rectify(Frame(0, 0, *images, None))
    for side, camera in (("left", WIDE.left), ("right", WIDE.right)):
        R, P = rectified_cameras(WIDE)[side == "right"]
        found, wanted = getattr(frame, side), getattr(exact, side)
        raw = images[side == "right"]
        grid = control_grid(camera, R, P, WIDE.source)
        np.testing.assert_array_equal(found, rectify(raw, grid))
        np.testing.assert_array_equal(found, by_table(grid)(raw))
        steepest = max(np.abs(np.diff(raw.astype(int), axis=axis)).max() for axis in (0, 1))
        away_px = np.abs(np.stack(sources(grid, *SIZE[::-1]), -1) / 32 - exact_sources_px(camera, R, P))
        # OpenCV rounds sources to 1/32 px, and both round grey values.
        most = steepest * (away_px.sum(-1).max() + 2 / 64) + 1
        assert np.abs(found.astype(int) - wanted).max() <= most
        assert found.std() > 10


def test_a_buffer_that_is_too_small_is_refused_and_the_row_named() -> None:
    grids = [
        control_grid(camera, R, P, "")
        for camera, (R, P) in zip((WIDE.left, WIDE.right), rectified_cameras(WIDE), strict=True)
    ]
    outcomes = set()
    for rows in BUFFER_ROWS:
        beyond = [row for grid in grids if (row := row_beyond(grid, rows)) is not None]
        outcomes.add(bool(beyond))
        if not beyond:
            Rectifier(WIDE, rows)
            continue
        with pytest.raises(InputError) as refusal:
            Rectifier(WIDE, rows)
        message = f"wide.toml: cannot be rectified with a line buffer of {rows} rows: row {beyond[0]} needs"
        assert str(refusal.value).startswith(message)
    assert outcomes == {True, False}


def test_a_rig_that_no_buffer_serves_is_refused() -> None:
    with pytest.raises(InputError, match=r"line buffer of 128 rows: row 0 needs pixels .* rows away"):
        Rectifier(rig(-0.28, 0.07, 25.0), 128)


def test_a_source_beyond_the_numbers_of_the_grid_is_refused() -> None:
    camera = replace(WIDE.left, matrix=camera_matrix(330.0, 331.0, 3170.0, 203.0))
    R, P = rectified_cameras(WIDE)[0]
    with pytest.raises(InputError, match=r"wide\.toml: .*moves pixels by 1024 px or more"):
        control_grid(camera, R, P, WIDE.source)


@pytest.mark.parametrize("rows", [1, 8, 48, 127, -16])
def test_a_buffer_that_cannot_be_built_is_refused(rows: int) -> None:
    with pytest.raises(InputError, match=rf"rectify_rows: must be 0 or one of 16, 32, 64, 128, not {rows}"):
        Rectifier(WIDE, rows)


def test_a_run_rectifies_by_the_grid(tmp_path: Path) -> None:
    folder = cases.make_asl(tmp_path)
    for sensor in folder.rglob("sensor.yaml"):
        text = sensor.read_text()
        distorted = text.replace("[0.0, 0.0, 0.0, 0.0]", "[-0.2, 0.05, 0.0, 0.0]")
        assert distorted != text
        sensor.write_text(distorted)
    sequence = open_sequence(folder)
    values = parameters.defaults()
    values["stereo"] |= {"rectify_rows": 32, "num_disparities": 16, "levels": 1}
    chain = make_chain(sequence, "golden", values, threads=1)
    step = run_frame(chain, sequence.frames[0])
    raw = sequence.calibration
    (R, P), _ = rectified_cameras(raw)
    left = rectify(step.raw.left, control_grid(raw.left, R, P, ""))
    np.testing.assert_array_equal(step.frame.left, left)
    np.testing.assert_array_equal(step.pair.levels[0], chain.engine.compute(left, step.frame.right))
    assert (left != Rectifier(raw).rectify(step.raw).left).any()
