"""Calibrations that would be taken for others: what files and options say is heeded or refused.

Every figure of a report is what its name says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml
from board_rig import exact_row_errors_px, fisheye_rig, random_rig
from command_line import Vista, assert_refused, call
from vista.calibration.board import parse_board
from vista.calibration.formats import read_rig, write_rig
from vista.calibration.formats.common import Options
from vista.calibration.measure import distances_m
from vista.calibration.rig import Rig
from vista.calibration.solve import Solution, _without
from vista.calibration.views import View
from vista.command.calibrate import write_files
from vista.errors import InputError
from vista.geometry import CameraModel, Pose, camera_matrix
from vista.rectify import Rectifier

Capture = pytest.CaptureFixture[str]


def written(folder: Path, name: str, rig: Rig) -> list[Path]:
    files = write_rig(rig, name, Options())
    write_files(folder, files)
    return [folder / file for file in sorted(files)]


def changed(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    table = yaml.safe_load(path.read_text())
    change(table)
    path.write_text(yaml.safe_dump(table))


# ---- what a file says ----

OF_PART = [
    {"binning_x": 2, "binning_y": 2},
    {"roi": {"x_offset": 8, "y_offset": 0, "height": 400, "width": 600, "do_rectify": False}},
]


@pytest.mark.parametrize("part", OF_PART, ids=["binning", "region"])
def test_camera_info_of_a_part_of_the_image_is_refused(part: dict[str, Any], tmp_path: Path) -> None:
    files = written(tmp_path, "ros", random_rig())
    whole = {"binning_x": 1, "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0}}
    changed(files[1], lambda table: table.update(whole))
    read_rig(files, Options())
    changed(files[1], lambda table: table.update(part))
    with pytest.raises(InputError, match="binning or a region of interest"):
        read_rig(files, Options())


def test_a_chain_of_three_cameras_is_refused(tmp_path: Path) -> None:
    files = written(tmp_path, "kalibr", random_rig())
    changed(files[0], lambda table: table.update(cam2=table["cam1"]))
    with pytest.raises(InputError, match="chain of more than two cameras"):
        read_rig(files, Options())


def test_poses_of_the_imu_have_to_agree_with_the_pair(tmp_path: Path) -> None:
    files = written(tmp_path, "kalibr", random_rig(body=True))
    read_rig(files, Options())

    def move(table: dict[str, Any]) -> None:
        table["cam1"]["T_cam_imu"][0][3] += 0.01

    changed(files[0], move)
    with pytest.raises(InputError, match="T_cam_imu of both cameras do not agree with T_cn_cnm1"):
        read_rig(files, Options())


@pytest.mark.parametrize("name", ["toml", "kalibr", "euroc"])
def test_a_pair_that_is_swapped_is_refused(name: str, tmp_path: Path) -> None:
    rig = random_rig()
    swapped = Rig(rig.right, rig.left, rig.frame_from_right, rig.frame_from_left)
    with pytest.raises(InputError, match="not right of the left camera"):
        read_rig(written(tmp_path, name, swapped), Options())


def test_another_model_of_euroc_is_refused(tmp_path: Path) -> None:
    files = written(tmp_path, "euroc", random_rig())
    changed(files[0], lambda table: table.update(camera_model="omni"))
    with pytest.raises(InputError, match="camera_model omni is not known, only pinhole"):
        read_rig(files, Options())


# ---- options that would be ignored ----

IGNORED = [
    (("--size-px", "320x240"), "--size-px: the images are 640x480 px, as "),
    (("--unit", "mm"), "--unit: goes with opencv and boofcv, not with kalibr and toml"),
    (("--lens", "fisheye"), "--lens: goes with --board and with files of opencv; those of kalibr say it"),
]


@pytest.mark.parametrize(("arguments", "message"), IGNORED)
def test_options_that_a_format_does_not_take_are_refused(
    arguments: tuple[str, ...], message: str, tmp_path: Path, capsys: Capture
) -> None:
    (file,) = written(tmp_path, "kalibr", random_rig())
    capsys.readouterr()  # the seed
    assert_refused(call(capsys, "calibrate", file, *arguments, "--out", tmp_path / "out"), message)
    assert not (tmp_path / "out").exists()


def test_the_unit_counts_where_either_file_has_one(tmp_path: Path, run_vista: Vista) -> None:
    (file,) = written(tmp_path, "kalibr", random_rig())
    arguments = ("calibrate", file, "--to", "opencv", "--unit", "mm", "--size-px", "640x480")
    assert run_vista(*arguments, "--out", tmp_path / "out")[0] == 0
    storage = cv2.FileStorage(str(tmp_path / "out/stereo.yml"), cv2.FILE_STORAGE_READ)
    assert 100.0 < np.linalg.norm(storage.getNode("T").mat()) < 140.0


@pytest.mark.parametrize(("option", "value"), [("--size-px", "640x480"), ("--unit", "mm")])
def test_options_of_files_are_refused_for_pictures(
    option: str, value: str, tmp_path: Path, run_vista: Vista
) -> None:
    arguments = ("calibrate", tmp_path, "--board", "chessboard:9x6:25", option, value)
    assert_refused(run_vista(*arguments, "--out", tmp_path / "out"), f"{option}: ")


def test_pictures_need_a_board(tmp_path: Path, run_vista: Vista) -> None:
    ran = run_vista("calibrate", tmp_path, "--out", tmp_path / "out")
    assert_refused(ran, f"{tmp_path}: pictures need --board, which says what they show")


# ---- figures ----


def views_of(counts: list[int]) -> list[View]:
    return [View(str(k), np.arange(n), np.zeros((n, 2)), np.zeros((n, 2))) for k, n in enumerate(counts)]


def test_errors_of_cameras_are_those_of_all_their_corners() -> None:
    """A view of 8 corners does not count as much as one of 40."""
    camera = CameraModel(640, 480, camera_matrix(500.0, 500.0, 320.0, 240.0))
    poses = [Pose(), Pose()]
    solution = Solution(camera, camera, Pose(), views_of([8, 40]), poses, [1.0, 0.1], [0.5, 0.2])
    left, right = (np.sqrt((8 * a**2 + 40 * b**2) / 48) for a, b in ((1.0, 0.1), (0.5, 0.2)))
    assert solution.rms_of_px("left") == pytest.approx(left)
    assert solution.rms_of_px("right") == pytest.approx(right)
    assert solution.rms_px() == pytest.approx(np.sqrt((left**2 + right**2) / 2))


def test_the_distance_of_a_board_is_that_of_its_middle() -> None:
    """Turned by half a turn in its plane, it is as far away as before."""
    board = parse_board("chessboard:9x6:100")
    middle_m = np.array([0.4, 0.25, 0.0])
    turned = np.diag([-1.0, -1.0, 1.0])
    poses = [Pose(R, np.array([0.0, 0.0, 2.0]) - R @ middle_m) for R in (np.eye(3), turned)]
    assert distances_m(poses, board) == pytest.approx([2.0, 2.0])


def test_the_worst_view_is_named() -> None:
    """Its number counts and not the text of it: 10 is more than 9."""
    errors_px = np.array([0.1] * 5 + [9.0, 10.0, 0.2])
    with pytest.raises(InputError, match=r"\(6: 10\.00 px in left camera\)"):
        _without(views_of([9] * 8), errors_px > 1.0, errors_px, "left camera", {}, 8)


@pytest.mark.parametrize("coefficients", [4, 5, 8])
def test_a_fisheye_beside_a_pinhole_is_rectified(coefficients: int) -> None:
    rig = fisheye_rig()
    K = rig.right.matrix * [[1.6], [1.6], [1.0]]
    K[:2, 2] = rig.right.matrix[:2, 2]
    distortion = (-0.05, 0.01, 0.001, -0.001, 0.002, 0.0, 0.0, 0.0)[:coefficients]
    mixed = replace(rig, right=replace(rig.right, matrix=K, distortion=distortion, lens="pinhole"))
    assert Rectifier(mixed).calibration.focal_px > 0.0
    assert np.abs(exact_row_errors_px(mixed, mixed)).max() < 1e-3
