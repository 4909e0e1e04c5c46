"""The readers on good input: synthetic sequences in every layout."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from scipy.spatial.transform import Rotation, Slerp
from vista.geometry import rotation_from_quaternion, slerp
from vista.rectify import Rectifier
from vista.sequence import Options, Sequence, open_sequence, read_grey
from vista.sequence.image import read_size

MAKERS = {"EuRoC ASL": cases.make_asl, "KITTI odometry": cases.make_kitti, "pairs": cases.make_pairs}


@pytest.fixture(params=MAKERS)
def sequence(request: pytest.FixtureRequest, tmp_path: Path) -> Sequence:
    opened = open_sequence(MAKERS[request.param](tmp_path / "flight"))
    assert opened.layout == request.param
    return opened


def test_frames_hold_the_images_in_order(sequence: Sequence) -> None:
    assert [files.index for files in sequence.frames] == list(range(cases.FRAMES))
    for files in sequence.frames:
        frame = sequence.read(files)
        left, right = cases.texture_pair(files.index)
        np.testing.assert_array_equal(frame.left, left)
        np.testing.assert_array_equal(frame.right, right)


def test_every_layout_gives_the_same_rectified_camera(sequence: Sequence) -> None:
    rectifier = Rectifier(sequence.calibration)
    camera = rectifier.calibration
    assert rectifier.is_passthrough
    assert (camera.width, camera.height) == (cases.WIDTH, cases.HEIGHT)
    expected = (cases.FOCAL_PX, cases.CX, cases.CY, cases.BASELINE_M)
    assert (camera.focal_px, camera.cx, camera.cy, camera.baseline_m) == pytest.approx(expected)


def test_kitti_times_and_poses(tmp_path: Path) -> None:
    frames = open_sequence(cases.make_kitti(tmp_path)).frames
    assert [files.t_ns for files in frames] == [0, 100_000_000, 200_000_000, 300_000_000]
    np.testing.assert_array_equal(frames[3].world_from_camera.translation_m, [0, 0, 3])


def test_kitti_in_colour(tmp_path: Path) -> None:
    """The poses are those of the grey left camera, 6 cm to the right of the one in colour."""
    folder = cases.make_kitti(tmp_path)
    for grey, colour in (("image_0", "image_2"), ("image_1", "image_3")):
        (folder / grey).rename(folder / colour)
    rows = {"P0": 0.0, "P1": -60.0, "P2": 0.06 * cases.FOCAL_PX, "P3": (0.06 - 0.4) * cases.FOCAL_PX}
    of_camera = f"0 {cases.FOCAL_PX} {cases.CY} 0 0 0 1 0\n"
    lines = (f"{key}: {cases.FOCAL_PX} 0 {cases.CX} {offset} {of_camera}" for key, offset in rows.items())
    (folder / "calib.txt").write_text("".join(lines))
    sequence = open_sequence(folder)
    np.testing.assert_allclose(sequence.calibration.right_from_left.translation_m, [-0.4, 0.0, 0.0])
    for index, frame in enumerate(sequence.frames):
        assert frame.world_from_camera is not None
        np.testing.assert_allclose(frame.world_from_camera.translation_m, [-0.06, 0.0, index], atol=1e-12)


@pytest.mark.parametrize("make", [cases.make_kitti, cases.make_asl])
def test_poses_are_optional(tmp_path: Path, make) -> None:
    folder = make(tmp_path)
    for name in ("poses/00.txt", "mav0/state_groundtruth_estimate0/data.csv"):
        (tmp_path / name).unlink(missing_ok=True)
    assert all(files.world_from_camera is None for files in open_sequence(folder).frames)


def test_pairs_have_no_poses_and_ten_frames_a_second(tmp_path: Path) -> None:
    frames = open_sequence(cases.make_pairs(tmp_path / "pairs")).frames
    assert [files.t_ns for files in frames] == [0, 100_000_000, 200_000_000, 300_000_000]
    assert all(files.world_from_camera is None for files in frames)


def test_asl_poses_are_interpolated_to_the_image_time(tmp_path: Path) -> None:
    for files in open_sequence(cases.make_asl(tmp_path)).frames:  # image times lie between two samples
        z_m = (files.t_ns - cases.ASL_START_NS) / 1e9
        np.testing.assert_allclose(files.world_from_camera.translation_m, [0, 0, z_m], atol=1e-9)


def test_asl_leaves_out_frames_without_a_pose(tmp_path: Path) -> None:
    folder = cases.make_asl(tmp_path)
    path = tmp_path / "mav0/state_groundtruth_estimate0/data.csv"
    late = [
        line for line in path.read_text().splitlines()[1:] if int(line.split(",")[0]) > cases.ASL_START_NS + 1
    ]
    path.write_text("\n".join(late))
    sequence = open_sequence(folder)
    assert [files.index for files in sequence.frames] == [1, 2, 3]
    assert "1 of 4 frames" in sequence.notes[0]


def test_quaternions_against_scipy() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        first, second = (q / np.linalg.norm(q) for q in rng.normal(size=(2, 4)))
        fraction = rng.uniform()
        rotations = Rotation.from_quat(np.array([first, second]), scalar_first=True)
        np.testing.assert_allclose(rotation_from_quaternion(first), rotations[0].as_matrix(), atol=1e-12)
        expected = Slerp([0, 1], rotations)(fraction).as_matrix()
        np.testing.assert_allclose(
            rotation_from_quaternion(slerp(first, second, fraction)), expected, atol=1e-9
        )


def test_pairs_may_bring_calibrated_cameras(tmp_path: Path) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    camera = f"fx_px = {cases.FOCAL_PX}\nfy_px = {cases.FOCAL_PX}\ncx = {cases.CX}\ncy = {cases.CY}\n"
    motion = f"rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]\ntranslation_m = [-{cases.BASELINE_M}, 0, 0]\n"
    text = f"[left]\n{camera}[right]\n{camera}distortion = [-0.1, 0, 0, 0]\n[right_from_left]\n{motion}"
    (folder / "calibration.toml").write_text(text)
    calibration = open_sequence(folder).calibration
    assert calibration.left.distortion == (0, 0, 0, 0)
    assert calibration.right.distortion == (-0.1, 0, 0, 0)


@pytest.mark.parametrize("extension", [".png", ".jpg", ".pgm"])
def test_grey_images_of_every_format(tmp_path: Path, extension: str) -> None:
    image = cv2.GaussianBlur(cases.texture_pair(3)[0], (0, 0), 3)
    path = tmp_path / f"image{extension}"
    cases.write_image(path, image)
    assert np.abs(read_grey(path).astype(int) - image).max() <= (8 if extension == ".jpg" else 0)
    assert read_size(path) == (cases.WIDTH, cases.HEIGHT)


@pytest.mark.parametrize("extension", [".png", ".ppm"])
def test_colour_becomes_grey_by_bt601(tmp_path: Path, extension: str) -> None:
    colour = np.random.default_rng(5).integers(0, 256, (20, 30, 3), np.uint8)
    cases.write_image(tmp_path / f"colour{extension}", colour)
    expected = colour @ np.array([0.114, 0.587, 0.299])
    assert np.abs(read_grey(tmp_path / f"colour{extension}") - expected).max() <= 0.51


def test_transparency_is_ignored(tmp_path: Path) -> None:
    colour = np.random.default_rng(6).integers(0, 256, (20, 30, 4), np.uint8)
    cases.write_image(tmp_path / "rgba.png", colour)
    cases.write_image(tmp_path / "rgb.png", colour[:, :, :3])
    np.testing.assert_array_equal(read_grey(tmp_path / "rgba.png"), read_grey(tmp_path / "rgb.png"))


def add_times_and_poses(folder: Path, times_s: list[str], poses: str) -> None:
    rows = "".join(f"scene{index:02d},{time_s}\n" for index, time_s in enumerate(times_s))
    (folder / "times.csv").write_text("name,t_s\n" + rows)
    (folder / "poses.csv").write_text("t_s,x_m,y_m,z_m,qx,qy,qz,qw\n" + poses)


def test_pairs_may_bring_times_and_poses(tmp_path: Path) -> None:
    """Times decide the order, to the nanosecond; poses are interpolated; a frame outside them is left out."""
    folder = cases.make_pairs(tmp_path / "pairs")
    times_s = ["1700000000.300000001", "1700000000.1", "1700000000.2", "1700000009"]
    poses = "1700000000.0,0,0,0,0,0,0,1\n1700000000.4,0,0,4,0,0.6,0,0.8\n"
    add_times_and_poses(folder, times_s, poses)
    text = (folder / "calibration.toml").read_text()
    (folder / "calibration.toml").write_text(text + "up_world = [0, 0, 1]\n")
    sequence = open_sequence(folder)
    assert [files.left.name[:7] for files in sequence.frames] == ["scene01", "scene02", "scene00"]
    assert [files.t_ns - 1_700_000_000_000_000_000 for files in sequence.frames] == [
        100_000_000,
        200_000_000,
        300_000_001,
    ]
    z_m = [files.world_from_camera.translation_m[2] for files in sequence.frames]
    assert z_m == pytest.approx([1.0, 2.0, 3.0], abs=1e-6)
    turns = Rotation.from_matrix([files.world_from_camera.rotation for files in sequence.frames])
    angle = 2 * np.arctan2(0.6, 0.8)
    np.testing.assert_allclose(
        turns.as_rotvec(), [[0, share * angle, 0] for share in (0.25, 0.5, 0.75)], atol=1e-6
    )
    np.testing.assert_array_equal(sequence.up_world, [0, 0, 1])
    assert sequence.notes == (f"1 of 4 frames lie outside the time of {folder / 'poses.csv'}",)


def test_poses_in_nanoseconds_and_any_order_of_columns(tmp_path: Path) -> None:
    folder = cases.make_pairs(tmp_path / "pairs", 1)
    (folder / "times.csv").write_text("t_ns,name\n7,scene00\n")
    (folder / "poses.csv").write_text("qw,qx,qy,qz,x_m,y_m,z_m,t_ns\n1,0,0,0,1,2,3,7\n")
    (frame,) = open_sequence(folder).frames
    assert frame.t_ns == 7
    np.testing.assert_array_equal(frame.world_from_camera.translation_m, [1, 2, 3])


def shift_right_times(folder: Path, *shifts_ns: int) -> None:
    path = folder / "mav0/cam1/data.csv"
    head, *rows = path.read_text().splitlines()
    moved = (
        f"{int(time) + shift_ns},{name}"
        for (time, name), shift_ns in zip((row.split(",") for row in rows), shifts_ns, strict=True)
    )
    path.write_text("\n".join([head, *moved]))


def test_left_and_right_times_may_differ_within_a_tolerance(tmp_path: Path) -> None:
    """The period is 50 ms, so that 5 ms pass; the third pair is 6 ms apart."""
    folder = cases.make_asl(tmp_path)
    shift_right_times(folder, 7, 0, 6_000_000, -5_000_000)
    sequence = open_sequence(folder)
    assert [files.index for files in sequence.frames] == [0, 1, 3]
    assert [files.left.name == files.right.name for files in sequence.frames] == [True] * 3
    assert sequence.notes == (
        "2 of 3 pairs have images of two times; they differ by up to 5 ms",
        "2 of 8 images have no partner within 5 ms and are left out",
    )
    assert len(open_sequence(folder, Options(pair_tolerance_ms=6)).frames) == 4
    assert len(open_sequence(folder, Options(pair_tolerance_ms=0)).frames) == 1


def test_an_image_pairs_with_its_nearest_only(tmp_path: Path) -> None:
    folder = cases.make_asl(tmp_path)
    shift_right_times(folder, 40_000_000, 40_000_000, 40_000_000, 40_000_000)
    pairs = [(f.left.stem, f.right.stem) for f in open_sequence(folder, Options(pair_tolerance_ms=45)).frames]
    times = [str(cases.ASL_START_NS + index * cases.ASL_PERIOD_NS) for index in range(4)]
    assert pairs == list(zip(times[1:], times[:-1], strict=True))
