"""Point clouds and coloured disparities of `vista disparity`."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused
from vista.geometry import Calibration
from vista.point_cloud import points_of, write_ply

CAMERA = Calibration(3, 2, 100.0, 1.0, 0.5, 0.2)


@pytest.fixture
def pair(tmp_path: Path) -> tuple[Path, Path]:
    folder = cases.make_pairs(tmp_path / "pairs", 1)
    return folder / "scene00_left.png", folder / "scene00_right.png"


def test_points_are_where_the_pixels_look(tmp_path: Path) -> None:
    words = np.array([[-16, 16, 0], [32, 64, -16]], np.int16)
    left = np.arange(6, dtype=np.uint8).reshape(2, 3)
    points = points_of(words, left, CAMERA)
    assert points["z"].tolist() == [20.0, 10.0, 5.0]  # 100 px * 0.2 m / 1, 2 and 4 px
    np.testing.assert_allclose(points["x"], [0.0, -0.1, 0.0], atol=1e-7)
    np.testing.assert_allclose(points["y"], [-0.1, 0.05, 0.025], atol=1e-7)
    assert points["green"].tolist() == [1, 3, 4]
    write_ply(tmp_path / "cloud.ply", points)
    seen = cv2.loadPointCloud(str(tmp_path / "cloud.ply"))[0].reshape(-1, 3)  # OpenCV's own reader
    np.testing.assert_array_equal(seen, np.stack([points[axis] for axis in "xyz"], axis=1))


def test_the_command_writes_clouds_and_colours(
    tmp_path: Path, pair: tuple[Path, Path], run_vista: Vista
) -> None:
    calibration = pair[0].parent / "calibration.toml"
    for name in ("cloud.ply", "colours.jpg"):
        outcome = run_vista("disparity", *pair, "--out", tmp_path / name, "--calibration", calibration)
        assert outcome == (0, "", "")
    cloud = cv2.loadPointCloud(str(tmp_path / "cloud.ply"))[0].reshape(-1, 3)
    depth_m = cases.FOCAL_PX * cases.BASELINE_M / cases.DISPARITY_PX
    assert len(cloud) > 5000 and np.median(cloud[:, 2]) == pytest.approx(depth_m, rel=0.01)
    picture = cv2.imread(str(tmp_path / "colours.jpg"))
    assert picture.shape == (cases.HEIGHT, cases.WIDTH, 3) and picture.std(axis=2).max() > 20.0
    assert run_vista("disparity", *pair, "--out", tmp_path / "plain.jpg") == (0, "", "")


def test_bad_calls_take_one_line(tmp_path: Path, pair: tuple[Path, Path], run_vista: Vista) -> None:
    calibration = pair[0].parent / "calibration.toml"
    out = tmp_path / "cloud.ply"
    assert_refused(run_vista("disparity", *pair, "--out", out), "a point cloud needs --calibration")
    outcome = run_vista("disparity", *pair, "--out", tmp_path / "d.png", "--calibration", calibration)
    assert_refused(outcome, "--calibration: goes with .jpg and .ply")
    raw = tmp_path / "raw.toml"
    camera = f"fx_px = {cases.FOCAL_PX}\nfy_px = {cases.FOCAL_PX}\ncx = {cases.CX}\ncy = {cases.CY}\n"
    distorted = f"{camera}distortion = [-0.3, 0.1, 0.0, 0.0]\n"
    motion = "rotation = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\ntranslation_m = [-0.25, 0.0, 0.0]\n"
    raw.write_text(f"[left]\n{distorted}[right]\n{distorted}[right_from_left]\n{motion}")
    outcome = run_vista("disparity", *pair, "--out", out, "--calibration", raw)
    assert_refused(outcome, "cameras that are not rectified")
    assert [p.name for p in tmp_path.iterdir() if p.suffix in (".ply", ".png")] == []
