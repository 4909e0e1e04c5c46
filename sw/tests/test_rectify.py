"""Rectification: matching pixels on one row, geometry kept, and no resampling where none is needed."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from numpy.typing import NDArray
from raw_rigs import RAW, blob_centre, draw_spheres
from raw_rigs import RAW_SIZE as SIZE
from real_pairs import make_bumblebee2
from scipy.spatial.transform import Rotation
from shared_data import SHARED_DATA
from vista.errors import InputError
from vista.geometry import CameraModel, Pose, RawCalibration, camera_matrix
from vista.health.features import match_pair
from vista.rectify import Rectifier, exact_map, rectified_cameras
from vista.sequence import Frame, open_sequence


def needs(name: str) -> Path:
    if not (SHARED_DATA / name).is_dir():
        pytest.skip(f"{name} is not present")
    return SHARED_DATA / name


def row_errors_px(left: NDArray[np.uint8], right: NDArray[np.uint8]) -> NDArray[np.float64]:
    errors = match_pair(left, right, features=3000).near_rows()
    assert len(errors) > 100
    return errors


def test_points_come_to_lie_where_the_rectified_camera_sees_them() -> None:
    grid = [(x, y) for x in (-0.38, -0.1, 0.12, 0.36) for y in (-0.28, 0.02, 0.3)]
    depths_m = np.linspace(2.0, 9.0, len(grid))
    points_m = np.array([(x * z, y * z, z) for (x, y), z in zip(grid, depths_m, strict=True)])
    world_from_left = Pose(
        Rotation.from_euler("xyz", [10, 20, 30], degrees=True).as_matrix(), np.array([1.0, 2, 3])
    )
    raw = Frame(
        0,
        0,
        draw_spheres(RAW.left, Pose(), points_m),
        draw_spheres(RAW.right, RAW.right_from_left, points_m),
        world_from_left,
    )
    rectifier = Rectifier(RAW)
    frame, camera = rectifier.rectify(raw), rectifier.calibration
    assert camera.baseline_m == pytest.approx(np.linalg.norm(RAW.right_from_left.translation_m))

    rectified_from_left = frame.world_from_camera.inverse() @ world_from_left
    for x, y, z in points_m @ rectified_from_left.rotation.T + rectified_from_left.translation_m:
        u, v = camera.cx + camera.focal_px * x / z, camera.cy + camera.focal_px * y / z
        disparity_px = camera.focal_px * camera.baseline_m / z
        assert blob_centre(frame.left, u, v) == pytest.approx((u, v), abs=0.15)
        assert blob_centre(frame.right, u - disparity_px, v) == pytest.approx((u - disparity_px, v), abs=0.15)


def test_the_pose_turns_with_the_axes_and_does_not_move() -> None:
    image = np.zeros(SIZE[::-1], np.uint8)
    pose = Pose(np.eye(3), np.array([4.0, 5.0, 6.0]))
    turned = Rectifier(RAW).rectify(Frame(0, 0, image, image, pose)).world_from_camera
    np.testing.assert_array_equal(turned.translation_m, pose.translation_m)
    centre_m = RAW.right_from_left.inverse().translation_m
    np.testing.assert_allclose(turned.rotation[:, 0], centre_m / np.linalg.norm(centre_m), atol=1e-9)


def test_no_pixel_comes_from_outside_the_raw_image() -> None:
    for camera, (R, P) in zip((RAW.left, RAW.right), rectified_cameras(RAW), strict=True):
        source, _ = exact_map(camera, R, P)
        u, v = source[..., 0], source[..., 1]  # whole parts of the raw coordinates
        assert u.min() >= -1 and u.max() < SIZE[0]
        assert v.min() >= -1 and v.max() < SIZE[1]


def test_a_rectified_pair_passes_untouched(tmp_path: Path) -> None:
    sequence = open_sequence(cases.make_kitti(tmp_path))
    frame = sequence.read(sequence.frames[1])
    assert Rectifier(sequence.calibration).rectify(frame) is frame


@pytest.mark.parametrize(
    "change",
    [
        {"right": CameraModel(*SIZE, RAW.left.matrix, (1e-3, 0, 0, 0))},
        {"right": CameraModel(*SIZE, RAW.left.matrix + np.diag([0, 0.1, 0]))},
        {"right_from_left": Pose(cv2.Rodrigues(np.array([0, 1e-3, 0]))[0], np.array([-0.2, 0, 0]))},
        {"right_from_left": Pose(np.eye(3), np.array([-0.2, 0.001, 0]))},
    ],
)
def test_any_deviation_is_rectified(change: dict) -> None:
    camera = CameraModel(*SIZE, camera_matrix(262.0, 262.0, 156.0, 123.0))
    aligned = {"left": camera, "right": camera, "right_from_left": Pose(np.eye(3), np.array([-0.2, 0, 0]))}
    assert Rectifier(RawCalibration(**aligned, source="")).is_passthrough
    assert not Rectifier(RawCalibration(**(aligned | change), source="")).is_passthrough


@pytest.mark.parametrize("centre_m", [(0.0, 0.2, 0.0), (-0.2, 0.0, 0.0), (0.1, 0.0, 0.3)])
def test_cameras_that_make_no_left_right_pair_are_refused(centre_m: tuple[float, float, float]) -> None:
    raw = RawCalibration(RAW.left, RAW.left, Pose(np.eye(3), -np.array(centre_m)), "calibration.toml")
    with pytest.raises(InputError, match=r"calibration\.toml: the right camera lies at"):
        Rectifier(raw)


def test_cameras_that_look_apart_are_refused() -> None:
    turn = Rotation.from_euler("y", 70, degrees=True).as_matrix()
    raw = RawCalibration(
        RAW.left, RAW.left, Pose(turn, turn @ np.array([-0.2, 0.0, 0.0])), "calibration.toml"
    )
    with pytest.raises(InputError, match=r"calibration\.toml: the cameras look in different directions"):
        Rectifier(raw)


def test_an_absurd_distortion_is_refused() -> None:
    wrong = CameraModel(*SIZE, RAW.left.matrix, (1e6, 0.0, 0.0, 0.0))
    with pytest.raises(
        InputError, match=r"calibration\.toml: cannot be rectified: the image would be zoomed"
    ):
        Rectifier(RawCalibration(wrong, RAW.right, RAW.right_from_left, "calibration.toml"))


def test_euroc_rows_align() -> None:
    sequence = open_sequence(needs("euroc_v101"))
    rectifier = Rectifier(sequence.calibration)
    raw = sequence.read(sequence.frames[0])
    frame = rectifier.rectify(raw)
    assert np.median(np.abs(row_errors_px(raw.left, raw.right))) > 2.0
    assert np.median(np.abs(row_errors_px(frame.left, frame.right))) < 0.5
    assert rectifier.calibration.baseline_m == pytest.approx(0.11, abs=0.001)


@pytest.mark.parametrize("scene", ["garden01", "lantern01", "wall01"])
def test_bumblebee2_rows_align(tmp_path: Path, scene: str) -> None:
    needs("bumblebee2")
    sequence = open_sequence(make_bumblebee2(tmp_path, [scene]))
    rectifier = Rectifier(sequence.calibration)
    frame = rectifier.rectify(sequence.read(sequence.frames[0]))
    assert np.median(np.abs(row_errors_px(frame.left, frame.right))) < 0.5
    assert rectifier.calibration.focal_px == pytest.approx(494.1, abs=0.1)
    assert rectifier.calibration.baseline_m == pytest.approx(0.120, abs=0.001)
