"""vista scenes --lidar on small folders written here: what is read, refused and reported."""

from __future__ import annotations

import json
import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from shared_data import SHARED_DATA
from vista import parameters
from vista.cli import main
from vista.errors import EXIT_INPUT, EXIT_OK
from vista.geometry import Calibration
from vista_eval.dataset import kitti_stereo
from vista_eval.metrics.segmentation import matched_area
from vista_eval.metrics.standing_points import street_points
from vista_eval.rivals import ALONE, DETECTOR, OURS, REFERENCE, SGBM, OneCamera

pytestmark = pytest.mark.slow

CAMERA = Calibration(640, 240, 400.0, 320.0, 90.0, 0.5)
CALIB = "P0: 400 0 320 0 0 400 90 0 0 0 1 0\nP1: 400 0 320 -200 0 400 90 0 0 0 1 0\n"


def street() -> np.ndarray:
    """Disparities of a road 1.6 m below the camera and a board at 10 m."""
    v = np.arange(CAMERA.height)[:, None] + np.zeros((1, CAMERA.width))
    disparity_px = 200.0 * (v - CAMERA.cy) / CAMERA.focal_px / 1.6
    disparity_px[disparity_px < 2.0] = 0.0
    disparity_px[40:154, 300:380] = 20.0
    return disparity_px


def images_of(disparity_px: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A random texture of 3 px on the surfaces, as both cameras see it."""
    random = np.random.default_rng(0)
    wide = cv2.GaussianBlur(random.uniform(0, 255, (CAMERA.height, CAMERA.width + 200)), (0, 0), 1.2)
    wide = np.clip((wide - wide.mean()) * 3.0 + 128, 0, 255).astype(np.float32)
    right = wide[:, 100:-100]
    u, v = np.meshgrid(np.arange(CAMERA.width, dtype=np.float32), np.arange(CAMERA.height, dtype=np.float32))
    left = cv2.remap(wide, u + 100 - disparity_px.astype(np.float32), v, cv2.INTER_LINEAR)
    return left.astype(np.uint8), right.astype(np.uint8)


def write_pairs(folder: Path, count: int = 2) -> Path:
    disparity_px = street()
    left, right = images_of(disparity_px)
    truth = np.rint(256 * disparity_px).astype(np.uint16)
    for name, image in (("image_0", left), ("image_1", right), ("disp_noc", truth)):
        (folder / name).mkdir(parents=True)
        for k in range(count):
            cv2.imwrite(str(folder / name / f"{k:06d}_10.png"), image)
    (folder / "calib").mkdir()
    for k in range(count):
        (folder / "calib" / f"{k:06d}.txt").write_text(CALIB)
    return folder


@pytest.fixture(scope="module")
def kitti(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pairs(tmp_path_factory.mktemp("kitti"))


def test_lidar_pairs_are_measured_by_half(kitti: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    before = sorted(kitti.rglob("*"))
    out = tmp_path / "new" / "results"
    assert main(["scenes", str(out), "--lidar", str(kitti), "--jobs", "2"]) == EXIT_OK
    assert sorted(kitti.rglob("*")) == before
    result = json.loads((out / "lidar.json").read_text())
    assert [(pair["name"], pair["split"]) for pair in result["pairs"]] == [
        ("000000_10", "dev"),
        ("000001_10", "test"),
    ]
    for half in result["halves"].values():
        assert half["pairs"] == 1
        assert list(half["detectors"]) == [OURS, REFERENCE, SGBM, ALONE]
        ours = half["detectors"][OURS]["measures"]
        assert ours["recall"]["value"] > 0.8  # a well textured board in front of nothing
        assert ours["road"]["value"] < 0.05
        assert half["detectors"][ALONE]["measures"]["road"]["value"] > 0.5  # it knows no ground
        verdicts = half["detectors"][OURS]["verdicts"]
        assert sum(share["value"] for share in verdicts.values()) == pytest.approx(1.0, abs=1e-3)
    printed = capsys.readouterr().out
    for name in (OURS, REFERENCE, SGBM, ALONE, "10 to 20 m", "accepted"):
        assert re.search(rf"^{name}  ", printed, re.MULTILINE), name
    page = (out / "lidar.html").read_text()
    assert page.count("data:image/jpeg;base64,") == 2
    assert "http" not in page


def test_one_job_measures_the_same(kitti: Path, tmp_path: Path) -> None:
    for name, jobs in (("one", "1"), ("two", "2")):
        assert main(["scenes", str(tmp_path / name), "--lidar", str(kitti), "--jobs", jobs]) == EXIT_OK
    one, two = ((tmp_path / name / "lidar.json").read_text() for name in ("one", "two"))
    assert one == two


def test_a_camera_comes_from_calib_or_from_the_size_of_the_images(kitti: Path, tmp_path: Path) -> None:
    assert kitti_stereo.find_pairs(kitti)[0].camera == CAMERA
    for name, image in (
        ("image_0", np.zeros((370, 1226), np.uint8)),
        ("image_1", np.zeros((370, 1226), np.uint8)),
        ("disp_occ", np.zeros((370, 1226), np.uint16)),
    ):
        (tmp_path / name).mkdir()
        cv2.imwrite(str(tmp_path / name / "000004_10.png"), image)
    (pair,) = kitti_stereo.find_pairs(tmp_path)
    assert pair.camera == Calibration(1226, 370, 707.0912, 601.8873, 183.1104, 0.53715)


def remove_right(folder: Path) -> Path:
    culprit = folder / "image_1" / "000001_10.png"
    culprit.unlink()
    return culprit


def remove_calib(folder: Path) -> Path:
    (folder / "calib" / "000001.txt").unlink()
    return folder / "image_0" / "000001_10.png"


def shrink_truth(folder: Path) -> Path:
    culprit = folder / "disp_noc" / "000001_10.png"
    cv2.imwrite(str(culprit), np.zeros((100, 100), np.uint16))
    return culprit


def truncate_truth(folder: Path) -> Path:
    culprit = folder / "disp_noc" / "000001_10.png"
    culprit.write_bytes(culprit.read_bytes()[:-20])
    return culprit


def remove_truth(folder: Path) -> Path:
    for path in (folder / "disp_noc").iterdir():
        path.unlink()
    return folder / "disp_noc"


def no_folder(folder: Path) -> Path:
    (folder / "disp_noc").rename(folder / "elsewhere")
    return folder


def no_road(folder: Path) -> Path:
    for path in (folder / "disp_noc").iterdir():
        cv2.imwrite(str(path), np.full((CAMERA.height, CAMERA.width), 256 * 20, np.uint16))
    return folder


@pytest.mark.parametrize(
    "damage", [remove_right, remove_calib, shrink_truth, truncate_truth, remove_truth, no_folder, no_road]
)
def test_a_bad_folder_is_refused_in_one_line(damage, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    culprit = damage(write_pairs(tmp_path / "kitti"))
    out = tmp_path / "out"
    assert main(["scenes", str(out), "--lidar", str(tmp_path / "kitti")]) == EXIT_INPUT
    error = capsys.readouterr().err
    assert error.splitlines()[-1].startswith(f"vista: {culprit}: ")
    assert not out.exists()


def test_the_reference_method_is_judged_by_the_host(kitti: Path) -> None:
    """Regions that grew from disparities of their own have the host's verdicts on the host's own partition.
    The reference method takes all for such; the host judges the others by origin and outline, too."""
    pair = kitti_stereo.read_pair(kitti_stereo.find_pairs(kitti)[0])
    camera = OneCamera(pair.camera, parameters.defaults())
    result, (_, pipeline) = DETECTOR.process(camera, pair), camera.of(DETECTOR)
    host = pipeline._lib.vista_pipeline_look(pipeline._pipeline).regions
    evidence = [host.items[k].evidence for k in range(host.count)]
    seeded = [e.sum != 0.0 and e.origin == 0.0 for e in evidence]
    _, again = pipeline.judge_partition(result.region_of_cell)
    own = result.verdict_of_region
    assert len(again) == len(own) == len(seeded)
    assert {"ACCEPTED", "HORIZONTAL"} <= {b for b, one in zip(own, seeded, strict=True) if one}
    assert all(a == b for a, b, one in zip(again, own, seeded, strict=True) if one)


KITTI_2012 = SHARED_DATA / "kitti2012"


@pytest.mark.skipif(not KITTI_2012.is_dir(), reason=f"no {KITTI_2012}")
def test_the_road_of_real_pairs_lies_below_the_camera_of_the_car() -> None:
    """The cameras of KITTI's car are 1.65 m above the ground."""
    files = kitti_stereo.find_pairs(KITTI_2012)
    assert [one.split for one in files[:3]] == ["dev", "test", "dev"]
    for one in files[::12]:
        pair = kitti_stereo.read_pair(one)
        points = street_points(pair.camera, pair.disparity_px, matched_area(*pair.left.shape, 64, 11), 63.0)
        assert points is not None
        v, u, d = points.v[points.road], points.u[points.road], points.disparity_px[points.road]
        y = (v - pair.camera.cy) * pair.camera.baseline_m / d
        near = pair.camera.focal_px * pair.camera.baseline_m / d < 12.0
        assert np.median(y[near]) == pytest.approx(1.65, abs=0.2), one.name
        assert len(u) > 5000
