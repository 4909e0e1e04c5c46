"""Calibration files of other programs: read, written, and read again without loss."""

from __future__ import annotations

import contextlib
import itertools
import tomllib
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
import yaml
from board_rig import exact_row_errors_px, fisheye_rig, random_rig, seen_px
from command_line import Vista, assert_refused, call
from random_seed import seeded
from shared_data import SHARED_DATA
from vista.calibration.formats import FORMATS, read_rig, write_rig
from vista.calibration.formats.common import Options
from vista.calibration.rig import Rig, rig_of
from vista.command.calibrate import write_files
from vista.errors import InputError
from vista.geometry import Pose
from vista.lens import rectified_points
from vista.rectify import Rectifier, rectified_cameras
from vista.sequence import open_sequence
from vista.sequence.pairs import read_calibration

PINHOLE_FORMATS = list(FORMATS)
FISHEYE_FORMATS = [name for name in FORMATS if name != "boofcv"]


def through(rig: Rig, name: str, folder: Path, options: Options = Options()) -> Rig:  # noqa: B008
    """Written in a format, and read again."""
    files = write_rig(rig, name, options)
    write_files(folder, files)
    found, again = read_rig([folder / file for file in sorted(files)], options)
    assert found == name
    return again


def assert_same(first: Rig, second: Rig, tolerance: float = 4e-15) -> None:
    for a, b in ((first.left, second.left), (first.right, second.right)):
        assert (a.width, a.height, a.lens) == (b.width, b.height, b.lens)
        np.testing.assert_array_equal(a.matrix, b.matrix)
        assert a.distortion == b.distortion
    a, b = first.right_from_left, second.right_from_left
    np.testing.assert_allclose(a.rotation, b.rotation, rtol=0.0, atol=tolerance)
    np.testing.assert_allclose(a.translation_m, b.translation_m, rtol=0.0, atol=tolerance)


@pytest.mark.parametrize("name", FISHEYE_FORMATS)
def test_fisheyes_come_back(name: str, tmp_path: Path) -> None:
    rig = rig_of(fisheye_rig())
    assert_same(through(rig, name, tmp_path), rig)


@pytest.mark.parametrize("name", ["toml", "ros", "opencv", "euroc", "boofcv"])
def test_a_third_radial_coefficient_comes_back(name: str, tmp_path: Path) -> None:
    rig = random_rig(coefficients=5)
    assert_same(through(rig, name, tmp_path), rig)


@pytest.mark.parametrize("name", ["toml", "ros", "opencv"])
def test_the_rational_model_comes_back(name: str, tmp_path: Path) -> None:
    rig = random_rig(coefficients=8)
    assert_same(through(rig, name, tmp_path), rig)


@pytest.mark.parametrize("name", ["toml", "euroc"])
def test_where_the_cameras_are_on_the_vehicle_comes_back(name: str, tmp_path: Path) -> None:
    rig = random_rig(body=True)
    again = through(rig, name, tmp_path)
    assert again.is_body
    for a, b in (
        (rig.frame_from_left, again.frame_from_left),
        (rig.frame_from_right, again.frame_from_right),
    ):
        np.testing.assert_array_equal(a.rotation, b.rotation)
        np.testing.assert_array_equal(a.translation_m, b.translation_m)


@pytest.mark.parametrize(("first", "second"), list(itertools.permutations(PINHOLE_FORMATS, 2)))
def test_from_every_format_to_every_other(first: str, second: str, tmp_path: Path) -> None:
    rig = random_rig()
    assert_same(through(through(rig, first, tmp_path / "a"), second, tmp_path / "b"), rig)


@pytest.mark.parametrize("name", ["opencv", "boofcv"])
def test_lengths_in_millimetres(name: str, tmp_path: Path) -> None:
    rig = random_rig()
    assert_same(through(rig, name, tmp_path, Options(unit_m=1e-3)), rig, 1e-15)
    files = [tmp_path / file for file in write_rig(rig, name, Options())]
    with pytest.raises(InputError, match=r"the baseline is 1\d\d\.?\d* m, .*--unit says"):
        read_rig(files, Options())


def test_opencv_reads_what_is_written(tmp_path: Path) -> None:
    rig = random_rig()
    write_files(tmp_path, write_rig(rig, "opencv", Options()))
    storage = cv2.FileStorage(str(tmp_path / "stereo.yml"), cv2.FILE_STORAGE_READ)
    np.testing.assert_array_equal(storage.getNode("M1").mat(), rig.left.matrix)
    np.testing.assert_array_equal(storage.getNode("T").mat().ravel(), rig.right_from_left.translation_m)


def test_the_two_files_of_opencvs_sample(tmp_path: Path) -> None:
    rig = random_rig()
    for name, keys in (("intrinsics.yml", ("M1", "D1", "M2", "D2")), ("extrinsics.yml", ("R", "T"))):
        storage = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_WRITE)
        values = {
            "M1": rig.left.matrix,
            "D1": np.array([[*rig.left.distortion, 0.0]]),
            "M2": rig.right.matrix,
            "D2": np.array([[*rig.right.distortion, 0.0]]),
            "R": rig.right_from_left.rotation,
            "T": rig.right_from_left.translation_m.reshape(3, 1),
        }
        for key in keys:
            storage.write(key, values[key])
        storage.release()
    files = [tmp_path / "intrinsics.yml", tmp_path / "extrinsics.yml"]
    with pytest.raises(InputError, match="does not say the size of the images: give --size-px"):
        read_rig(files, Options())
    assert_same(read_rig(files, Options(size_px=(640, 480)))[1], rig)


def test_ros_messages_in_either_order(tmp_path: Path) -> None:
    """`ros2 topic echo` prints them with other keys, and plain lists."""
    rig = random_rig()
    files = []
    for side, text in write_rig(rig, "ros", Options()).items():
        table = yaml.safe_load(text)
        names = {"k": "camera_matrix", "d": "distortion_coefficients"}
        names |= {"r": "rectification_matrix", "p": "projection_matrix"}
        message = {key: table[name]["data"] for key, name in names.items()}
        message |= {"width": 640, "height": 480, "distortion_model": table["distortion_model"]}
        files.append(tmp_path / side)
        files[-1].write_text(yaml.safe_dump(message))
    for order in (files, files[::-1]):
        assert_same(read_rig(order, Options())[1], rig)


def test_a_ros_pair_means_what_ros_makes_of_it(tmp_path: Path) -> None:
    """ROS rectifies with R and P: a point comes to lie on one row, at the disparity of its distance."""
    rig = random_rig()
    infos = [yaml.safe_load(text) for text in write_rig(rig, "ros", Options()).values()]
    point_m = np.array([0.3, -0.2, 4.0])
    seen = []
    for camera, pose, info in zip((rig.left, rig.right), (Pose(), rig.right_from_left), infos, strict=True):
        R = np.array(info["rectification_matrix"]["data"]).reshape(3, 3)
        P = np.array(info["projection_matrix"]["data"]).reshape(3, 4)
        raw_px, _ = cv2.projectPoints(
            point_m,
            cv2.Rodrigues(pose.rotation)[0],
            pose.translation_m,
            camera.matrix,
            np.array(camera.distortion),
        )
        seen.append(cv2.undistortPoints(raw_px, camera.matrix, np.array(camera.distortion), R=R, P=P).ravel())
    assert seen[0][1] == pytest.approx(seen[1][1], abs=1e-2)
    focal_px, shift = (np.array(infos[1]["projection_matrix"]["data"])[at] for at in (0, 3))
    R1 = np.array(infos[0]["rectification_matrix"]["data"]).reshape(3, 3)
    assert seen[0][0] - seen[1][0] == pytest.approx(-shift / (R1 @ point_m)[2], abs=1e-2)
    assert -shift / focal_px == pytest.approx(np.linalg.norm(rig.right_from_left.translation_m))


def test_kalibr_with_an_imu(tmp_path: Path) -> None:
    rig = random_rig(body=True)
    again = through(rig, "kalibr", tmp_path)
    assert again.is_body
    assert_same(again, rig)
    table = yaml.safe_load((tmp_path / "camchain.yaml").read_text())
    T = {name: np.array(table["cam1"][name]) for name in ("T_cn_cnm1", "T_cam_imu")}
    np.testing.assert_allclose(
        T["T_cn_cnm1"] @ np.array(table["cam0"]["T_cam_imu"]), T["T_cam_imu"], atol=1e-12
    )


# ---- real calibrations ----


def numbers_of(value: object) -> list[float]:
    if isinstance(value, dict):
        return [number for key in sorted(value) for number in numbers_of(value[key])]
    if isinstance(value, list):
        return [number for item in value for number in numbers_of(item)]
    return [value] if isinstance(value, float) else []


def yaml_of(path: Path) -> dict:
    return yaml.safe_load(path.read_text().replace("%YAML:1.0", ""))


@pytest.mark.parametrize("by_way_of", ["euroc", "toml"])
def test_euroc_comes_back_to_the_digit(by_way_of: str, tmp_path: Path, run_vista: Vista) -> None:
    folder = SHARED_DATA / "euroc_v101" / "mav0"
    if not folder.is_dir():
        pytest.skip("euroc_v101 is not present")
    sources = [folder / f"cam{i}" / "sensor.yaml" for i in (0, 1)]
    assert run_vista("calibrate", *sources, "--to", by_way_of, "--out", tmp_path / "a")[0] == 0
    written = sorted((tmp_path / "a").rglob("*.*"))
    assert run_vista("calibrate", *written, "--to", "euroc", "--out", tmp_path / "b")[0] == 0
    for i, source in enumerate(sources):
        before, after = yaml_of(source), yaml_of(tmp_path / "b" / f"cam{i}" / "sensor.yaml")
        for key in ("T_BS", "intrinsics", "distortion_coefficients", "resolution"):
            assert after[key] == before[key]


def test_euroc_is_rectified_the_same_from_calibration_toml(tmp_path: Path) -> None:
    if not (SHARED_DATA / "euroc_v101").is_dir():
        pytest.skip("euroc_v101 is not present")
    sequence = open_sequence(SHARED_DATA / "euroc_v101")
    folder = SHARED_DATA / "euroc_v101" / "mav0"
    _, rig = read_rig([folder / f"cam{i}" / "sensor.yaml" for i in (0, 1)], Options())
    path = tmp_path / "calibration.toml"
    path.write_text(write_rig(rig, "toml", Options())["calibration.toml"])
    again = read_calibration(path, tomllib.loads(path.read_text()), (752, 480))
    frame = sequence.read(sequence.frames[0])
    pairs = [Rectifier(raw).rectify(frame) for raw in (sequence.calibration, again)]
    np.testing.assert_array_equal(pairs[0].left, pairs[1].left)
    np.testing.assert_array_equal(pairs[0].right, pairs[1].right)


@pytest.mark.parametrize("by_way_of", ["boofcv", "toml"])
def test_bumblebee2_comes_back_to_the_last_digit(by_way_of: str, tmp_path: Path, run_vista: Vista) -> None:
    source = SHARED_DATA / "bumblebee2" / "stereo.yaml"
    if not source.is_file():
        pytest.skip("bumblebee2 is not present")
    unit = ("--unit", "mm", "--out")
    assert run_vista("calibrate", source, "--to", by_way_of, *unit, tmp_path / "a")[0] == 0
    written = next((tmp_path / "a").iterdir())
    assert run_vista("calibrate", written, "--to", "boofcv", *unit, tmp_path / "b")[0] == 0
    before, after = yaml_of(source), yaml_of(tmp_path / "b" / "stereo.yaml")
    for side in ("left", "right"):
        assert after[side] == before[side]
    numbers = [np.array(numbers_of(table["rightToLeft"])) for table in (before, after)]
    # In one step it is the same number; by way of the inverse, some units of the last of 16 digits differ.
    np.testing.assert_allclose(*numbers, rtol=0.0, atol=0.0 if by_way_of == "boofcv" else 5e-14)


# ---- calibration.toml ----


def test_calibration_toml_for_fisheyes_and_other_sizes(tmp_path: Path) -> None:
    rig = rig_of(fisheye_rig((320, 240)))
    folder = tmp_path / "pairs"
    for side in ("left", "right"):
        cases.write_image(folder / f"a_{side}.png", cases.texture_pair(0, 320, 240)[0])
    (folder / "calibration.toml").write_text(write_rig(rig, "toml", Options())["calibration.toml"])
    assert open_sequence(folder).calibration.left.lens == "fisheye"
    for side in ("left", "right"):
        cases.write_image(folder / f"a_{side}.png", cases.texture_pair(0, 160, 120)[0])
    with pytest.raises(
        InputError, match=r"calibration\.toml: is for images of 320x240 px, these have 160x120"
    ):
        open_sequence(folder)


BAD_TOML = {
    "lens": (("[right]", 'lens = "mirror"\n[right]'), "lens must be pinhole or fisheye, not 'mirror'"),
    "size": (("size_px = [640, 480]", "size_px = [640.5, 480]"), "size_px must hold two whole numbers"),
    "body": (
        ("[left]", "body_from_left = 3\n[left]"),
        r"table \[body_from_left\] is missing",
    ),
}


@pytest.mark.parametrize("name", BAD_TOML)
def test_bad_calibration_toml(name: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (old, new), message = BAD_TOML[name]
    text = write_rig(random_rig(), "toml", Options())["calibration.toml"]
    capsys.readouterr()  # the seed
    assert old in text
    path = tmp_path / "calibration.toml"
    path.write_text(text.replace(old, new))
    assert_refused(call(capsys, "calibrate", path, "--out", tmp_path / "out"), message.replace("\\", ""))


def test_poses_on_the_vehicle_have_to_agree(tmp_path: Path) -> None:
    rig = random_rig(body=True)
    text = write_rig(rig, "toml", Options())["calibration.toml"]
    moved = replace(rig, frame_from_left=rig.frame_from_left @ Pose(np.eye(3), np.array([0.0, 0.01, 0.0])))
    other = write_rig(moved, "toml", Options())["calibration.toml"]
    path = tmp_path / "calibration.toml"
    path.write_text(
        text.partition("[body_from_left]")[0] + "[body_from_left]" + other.partition("[body_from_left]")[2]
    )
    with pytest.raises(InputError, match="do not agree with right_from_left"):
        read_calibration(path, tomllib.loads(path.read_text()), (640, 480))


# ---- bad files ----

BAD = {  # format: what is changed in its first file, and what is said of it
    "not YAML": ("kalibr", lambda text: "cam0: [1, 2", "not readable as YAML"),
    "no table": ("kalibr", lambda text: "[1, 2]", "not readable as YAML"),
    "unknown": ("kalibr", lambda text: "camera: 1", "is no calibration that is known"),
    "other model": (
        "kalibr",
        lambda text: text.replace("radtan", "omni"),
        "distortion_model omni is not known",
    ),
    "bad number": (
        "kalibr",
        lambda text: text.replace("[640, 480]", "[640, x]"),
        "resolution holds a bad number",
    ),
    "no size": ("kalibr", lambda text: text.replace("[640, 480]", "[640, -1]"), "640x-1 px is none"),
    "no rotation": (
        "kalibr",
        lambda text: text.replace("T_cn_cnm1:\n  - [0.99", "T_cn_cnm1:\n  - [0.19"),
        "T_cn_cnm1",
    ),
    "not finite": (
        "boofcv",
        lambda text: text.replace("skew: 0.0", "skew: .nan"),
        "skew holds a number that is not",
    ),
    "skew": ("boofcv", lambda text: text.replace("skew: 0.0", "skew: 1.0"), "skew must be 0"),
    "focal": (
        "euroc",
        lambda text: text.replace("intrinsics: [", "intrinsics: [-"),
        "focal lengths must be positive",
    ),
    "missing": (
        "ros",
        lambda text: text.replace("rectification_matrix", "other"),
        "rectification_matrix is missing",
    ),
    "one pair": ("ros", lambda text: text, "the files of both cameras"),
    "D": ("opencv", lambda text: text.replace("D2:", "D3:"), "D2 is missing"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files(name: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    kind, change, message = BAD[name]
    files = write_rig(random_rig(), kind, Options())
    capsys.readouterr()  # the seed
    first = sorted(files)[0]
    files[first] = change(files[first])
    write_files(tmp_path / "in", files)
    sources = [tmp_path / "in" / file for file in sorted(files)]
    if name == "one pair":
        sources = sources[:1]
    out = tmp_path / "out"
    assert_refused(call(capsys, "calibrate", *sources, "--to", "toml", "--out", out), message)
    assert not out.exists()


@pytest.mark.parametrize("kind", PINHOLE_FORMATS)
def test_damaged_files_are_read_or_refused(kind: str, tmp_path: Path) -> None:
    """A byte lost, changed or doubled somewhere: a calibration or InputError, never another exception."""
    random = seeded(15)
    files = write_rig(random_rig(body=kind in ("toml", "euroc", "kalibr")), kind, Options())
    write_files(tmp_path, files)
    paths = [tmp_path / name for name in sorted(files)]
    whole = paths[0].read_bytes()
    for _ in range(40):
        at = int(random.integers(len(whole)))
        new = [b"", bytes([int(random.integers(256))]), whole[at : at + 1] * 2][int(random.integers(3))]
        paths[0].write_bytes(whole[:at] + new + whole[at + 1 :])
        with contextlib.suppress(InputError):
            _, rig = read_rig(paths, Options())
            assert np.isfinite(rig.right_from_left.translation_m).all()


def test_what_a_format_cannot_hold_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match="--to kalibr: its distortion of a pinhole has 4 numbers, this one 5"
    ):
        write_rig(random_rig(coefficients=5), "kalibr", Options())
    with pytest.raises(InputError, match="--to boofcv: its fisheye lenses are of another model"):
        write_rig(rig_of(fisheye_rig()), "boofcv", Options())


def test_options_of_pictures_are_refused(tmp_path: Path, run_vista: Vista) -> None:
    arguments = ("calibrate", tmp_path, "--rate", 10, "--out", tmp_path / "out")
    assert_refused(run_vista(*arguments), "--rate: is for pictures of a board")


@pytest.mark.parametrize("buffer_rows", [0, 128])
def test_fisheyes_are_rectified(buffer_rows: int) -> None:
    """No pixel from outside, rows in line; by OpenCV's map and by the control grid of the hardware."""
    rig = fisheye_rig((320, 240))
    rectifier = Rectifier(rig, buffer_rows)
    assert np.abs(exact_row_errors_px(rig, rig)).max() < 1e-4
    calibration = rectifier.calibration
    assert calibration.baseline_m == pytest.approx(np.linalg.norm(rig.right_from_left.translation_m))
    assert calibration.focal_px == pytest.approx(rig.left.matrix[0, 0], rel=0.1)
    assert not rectifier.is_passthrough


def test_disparities_of_fisheyes_tell_the_distance() -> None:
    """They do as those of pinholes: focal length x baseline / depth along the rectified axis."""
    rig = fisheye_rig()
    (R, P), right = rectified_cameras(rig)
    calibration = Rectifier(rig).calibration
    points_m = np.array([[0.4, -0.3, 2.0], [-1.5, 1.0, 4.0], [3.0, 0.5, 9.0], [0.0, 0.0, 60.0]])
    left_px = rectified_points(rig.left, seen_px(rig.left, Pose(), points_m), R, P)
    right_px = rectified_points(rig.right, seen_px(rig.right, rig.right_from_left, points_m), *right)
    depths_m = (points_m @ R.T)[:, 2]
    expected_px = calibration.focal_px * calibration.baseline_m / depths_m
    np.testing.assert_allclose(left_px[:, 0] - right_px[:, 0], expected_px, atol=1e-5)
    ahead = points_m @ R.T
    np.testing.assert_allclose(
        left_px[:, 0], calibration.cx + calibration.focal_px * ahead[:, 0] / depths_m, atol=1e-5
    )
