"""Calibration of a rendered rig whose lenses are exactly known, and of what cannot be calibrated.

The rendered pictures are the same in every run; doc/results/calibration.md has figures for more of them."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from board_rig import (
    Camera,
    Conditions,
    Picture,
    board_poses,
    exact_row_errors_px,
    far_disparities_px,
    fisheye_rig,
    photograph,
    pinhole_rig,
    render_pairs,
    seen_px,
    turn_deg,
    write_pairs,
)
from command_line import Vista, assert_refused
from vista.calibration.board import find_board, parse_board
from vista.calibration.pictures import Picture as CalibrationPicture
from vista.calibration.views import find_views
from vista.geometry import RawCalibration
from vista.sequence.pairs import read_calibration

pytestmark = pytest.mark.slow

CHESSBOARD = "chessboard:9x6:50"
CHARUCO = "charuco:9x6:60:44:5X5_250"
COUNT = 14


def rendered(folder: Path, rig: RawCalibration, board: str, **options: object) -> Path:
    """A folder of pairs of the board before the rig."""
    random = np.random.default_rng(23)
    parsed = parse_board(board)
    poses = board_poses(rig, parsed, COUNT, random, **options)
    return write_pairs(folder, render_pairs(rig, parsed, poses, random))


@pytest.fixture(scope="module")
def chessboards(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return rendered(tmp_path_factory.mktemp("chessboards"), pinhole_rig(), CHESSBOARD)


@pytest.fixture(scope="module")
def fisheyes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return rendered(tmp_path_factory.mktemp("fisheyes"), fisheye_rig(), CHARUCO, fill=0.6)


def read(folder: Path, rig: RawCalibration) -> RawCalibration:
    path = folder / "calibration.toml"
    return read_calibration(path, tomllib.loads(path.read_text()), (rig.left.width, rig.left.height))


def assert_close(found: RawCalibration, rig: RawCalibration, focal: float, center_px: float) -> None:
    """focal: largest relative error. What matters in the end is the rows, of points all over the image."""
    for camera, true in ((found.left, rig.left), (found.right, rig.right)):
        assert camera.matrix[0, 0] == pytest.approx(true.matrix[0, 0], rel=focal)
        assert camera.matrix[1, 1] == pytest.approx(true.matrix[1, 1], rel=focal)
        assert camera.matrix[:2, 2] == pytest.approx(true.matrix[:2, 2], abs=center_px)
    baselines_m = [np.linalg.norm(raw.right_from_left.translation_m) for raw in (found, rig)]
    assert baselines_m[0] == pytest.approx(baselines_m[1], rel=0.002)
    assert turn_deg(found, rig) < 0.1
    errors_px = exact_row_errors_px(found, rig)
    assert np.sqrt(np.mean(errors_px**2)) < 0.1
    assert np.abs(errors_px).max() < 0.4
    assert np.sqrt(np.mean(far_disparities_px(found, rig) ** 2)) < 0.4


def test_a_chessboard_before_pinholes(chessboards: Path, tmp_path: Path, run_vista: Vista) -> None:
    """The calibration, an export along with it, and a report that holds everything."""
    arguments = ("calibrate", chessboards, "--board", CHESSBOARD, "--to", "ros", "--out", tmp_path)
    status, printed, _ = run_vista(*arguments)
    assert status == 0
    assert_every_pair_is_accounted_for(printed)
    names = {"calibration.toml", "report.html", "left.yaml", "right.yaml"}
    assert {path.name for path in tmp_path.iterdir()} == names
    assert_close(read(tmp_path, pinhole_rig()), pinhole_rig(), 0.002, 1.5)
    page = (tmp_path / "report.html").read_text()
    for heading in ("What to photograph next", "reprojection error", "row error before", "Corners in"):
        assert heading in page
    assert "baseline" in page
    assert page.count("data:image/jpeg;base64,") == 2
    assert "http" not in page.replace("http://www.w3.org", "")
    assert page.count("<circle") > 200


def assert_every_pair_is_accounted_for(printed: str) -> None:
    """Those that were used and those that were not are all that there are."""
    used, pairs = map(int, re.search(r"^(\d+) views of (\d+) pairs used", printed).groups())
    unused = re.search(r"^pairs that were not used: (.*)$", printed, re.MULTILINE)
    counts = re.findall(r"(?:^|; )(\d+) ", unused[1]) if unused else []
    assert used + sum(map(int, counts)) == pairs


def test_every_pair_that_is_not_used_is_accounted_for(
    chessboards: Path, tmp_path: Path, run_vista: Vista
) -> None:
    """One image without the board, a pair without it, and a pair that is there twice."""
    folder = tmp_path / "pictures"
    copy(chessboards, folder)
    names = sorted(folder.glob("*_left.png"))
    wall = np.full((480, 640), 95, np.uint8)
    right = [name.with_name(name.name.replace("left", "right")) for name in names]
    for path in (names[2], names[4], right[4]):
        cv2.imwrite(str(path), wall)
    for source, side in ((names[6], "left"), (right[6], "right")):
        (folder / f"900_{side}.png").write_bytes(source.read_bytes())
    arguments = ("calibrate", folder, "--board", CHESSBOARD, "--out", tmp_path / "out")
    _, printed, _ = run_vista(*arguments)
    for reason in (
        "1 like others",
        "1 with the board in the right image only",
        "1 with the board in neither image",
    ):
        assert reason in printed
        assert reason in (tmp_path / "out/report.html").read_text()
    assert_every_pair_is_accounted_for(printed)


def test_parts_of_a_charuco_board_before_fisheyes(fisheyes: Path, tmp_path: Path, run_vista: Vista) -> None:
    arguments = ("calibrate", fisheyes, "--board", CHARUCO, "--lens", "fisheye", "--out", tmp_path)
    assert run_vista(*arguments)[0] == 0
    assert_close(read(tmp_path, fisheye_rig()), fisheye_rig(), 0.004, 1.5)


def test_a_view_of_two_moments_is_left_out(chessboards: Path, tmp_path: Path, run_vista: Vista) -> None:
    folder = tmp_path / "pictures"
    copy(chessboards, folder)
    late = sorted(folder.glob("*_right.png"))
    moved = np.roll(cv2.imread(str(late[3]), cv2.IMREAD_GRAYSCALE), 9, axis=0)
    cv2.imwrite(str(late[3]), moved)
    status, printed, _ = run_vista("calibrate", folder, "--board", CHESSBOARD, "--out", tmp_path / "out")
    assert status == 0
    assert "1 in disagreement with the others" in printed
    assert_every_pair_is_accounted_for(printed)
    assert late[3].name.replace("right", "left") in (tmp_path / "out" / "report.html").read_text()
    assert_close(read(tmp_path / "out", pinhole_rig()), pinhole_rig(), 0.002, 1.5)


def copy(source: Path, folder: Path, change: object = None) -> None:
    """change: what becomes of the left and the right image."""
    folder.mkdir()
    for path in sorted(source.glob("*_left.png")):
        other = path.with_name(path.name.replace("left", "right"))
        pair = [cv2.imread(str(one), cv2.IMREAD_GRAYSCALE) for one in (path, other)]
        for one, image in zip((path, other), pair if change is None else change(*pair), strict=True):
            cv2.imwrite(str(folder / one.name), image)


def mirror(image: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(image[:, ::-1])


REFUSED = {
    "swapped": (lambda left, right: (right, left), "left and right are swapped, or the images are mirrored"),
    "both mirrored": (
        lambda left, right: (mirror(left), mirror(right)),
        "swapped, or the images are mirrored",
    ),
    "one mirrored": (lambda left, right: (left, mirror(right)), "one camera sees the board as in a mirror"),
    "right blind": (
        lambda left, right: (left, 0 * right),
        "no pair shows the board in both images (the left",
    ),
    "other size": (
        lambda left, right: (left, right[:400]),
        "the left image is 640x480, the right one 640x400",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_pictures_that_make_no_pair_are_refused(
    name: str, chessboards: Path, tmp_path: Path, run_vista: Vista
) -> None:
    change, message = REFUSED[name]
    folder, out = tmp_path / "pictures", tmp_path / "out"
    copy(chessboards, folder, change)
    assert_refused(run_vista("calibrate", folder, "--board", CHESSBOARD, "--out", out), message)
    assert not out.exists()


def some_of(pictures: Path, folder: Path) -> Path:
    """Enough of them to see what they show."""
    folder.mkdir()
    for path in pictures.glob("00[0-2]_*.png"):
        (folder / path.name).write_bytes(path.read_bytes())
    return folder


@pytest.mark.parametrize("count", ["10x7", "8x5", "5x8"])
def test_a_wrong_count_is_answered_by_one_that_works(
    count: str, chessboards: Path, tmp_path: Path, run_vista: Vista
) -> None:
    """Whether squares were counted or corners were missed; a part of the board may have that count."""
    few, board = some_of(chessboards, tmp_path / "few"), f"chessboard:{count}:50"
    outcome = run_vista("calibrate", few, "--out", tmp_path / "out", "--board", board)
    assert_refused(outcome, "a chessboard of 9x6 inner corners is there")
    assert not (tmp_path / "out").exists()
    advised = re.search(r"--board (chessboard:\S+)", outcome[2])[1]
    assert advised == CHESSBOARD  # with which the pictures are calibrated above


@pytest.mark.parametrize(
    ("board", "message"),
    [
        ("charuco:9x6:60:44:6X6_250", "but markers of the dictionary 5X5_"),
        ("charuco:7x5:60:44:5X5_250", "but markers of its dictionary"),
    ],
)
def test_another_charuco_board_is_named(
    board: str, message: str, fisheyes: Path, tmp_path: Path, run_vista: Vista
) -> None:
    few = some_of(fisheyes, tmp_path / "few")
    assert_refused(run_vista("calibrate", few, "--board", board, "--out", tmp_path / "out"), message)


def test_a_mirrored_charuco_board_is_refused(fisheyes: Path, tmp_path: Path, run_vista: Vista) -> None:
    few = some_of(fisheyes, tmp_path / "few")
    copy(few, tmp_path / "pictures", lambda left, right: (mirror(left), mirror(right)))
    arguments = ("calibrate", tmp_path / "pictures", "--board", CHARUCO, "--out", tmp_path / "out")
    assert_refused(run_vista(*arguments), "the images, or the print, are mirrored")


def some(rig: RawCalibration, count: int, tilt_deg: float, roll: bool = True) -> list[Picture]:
    random = np.random.default_rng(7)
    board = parse_board(CHESSBOARD)
    poses = board_poses(rig, board, count, random, tilt_deg)
    if not roll:  # the same direction in every view
        poses = [replace(pose, rotation=np.eye(3)) for pose in poses]
    return render_pairs(rig, board, poses, random)


def test_too_few_views_are_refused(tmp_path: Path, run_vista: Vista) -> None:
    write_pairs(tmp_path / "pictures", some(pinhole_rig((320, 240)), 5, 35.0))
    arguments = ("calibrate", tmp_path / "pictures", "--board", CHESSBOARD, "--out", tmp_path / "out")
    assert_refused(run_vista(*arguments), "at least 8 are needed")


def test_a_single_orientation_is_refused(tmp_path: Path, run_vista: Vista) -> None:
    write_pairs(tmp_path / "pictures", some(pinhole_rig(), 10, 0.0, roll=False))
    arguments = ("calibrate", tmp_path / "pictures", "--board", CHESSBOARD, "--out", tmp_path / "out")
    assert_refused(run_vista(*arguments), "the board faces one direction in all of them")


def test_a_board_that_stays_is_refused(chessboards: Path, tmp_path: Path, run_vista: Vista) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    for side in ("left", "right"):
        data = (chessboards / f"001_{side}.png").read_bytes()
        for index in range(9):
            (folder / f"{index}_{side}.png").write_bytes(data)
    arguments = ("calibrate", folder, "--board", CHESSBOARD, "--out", tmp_path / "out")
    assert_refused(run_vista(*arguments), "are nearly the same")


@pytest.mark.parametrize(
    ("board", "message"),
    [
        ("circles:9x6:30", "must be chessboard:"),
        ("chessboard:9x6", "must be chessboard:"),
        ("chessboard:9:25", "'9' is no COLSxROWS"),
        ("chessboard:2x6:25", "must be 3 to 40"),
        ("chessboard:9x6:nan", "a side must be 1 to 2000 mm"),
        ("charuco:9x6:30:30", "smaller than its squares"),
        ("charuco:9x6:30:20:9X9", "unknown dictionary '9X9'"),
        ("charuco:3x3:30:20", "3x3 squares have 4 corners between them, at least 8 are needed"),
        ("charuco:20x20:30:20:4X4_50", "has 200 markers, the dictionary 4X4_50 only 50"),
    ],
)
def test_a_board_that_is_none(board: str, message: str, tmp_path: Path, run_vista: Vista) -> None:
    assert_refused(run_vista("calibrate", tmp_path, "--board", board, "--out", tmp_path / "out"), message)


# ---- pictures of other kinds ----


def test_videos_side_by_side_and_in_two_files(chessboards: Path, tmp_path: Path, run_vista: Vista) -> None:
    pairs = [
        [cv2.imread(str(chessboards / f"{index:03d}_{side}.png")) for side in ("left", "right")]
        for index in range(COUNT)
    ]
    make_video(tmp_path / "both.avi", [np.hstack(pair) for pair in pairs])
    for side, name in enumerate(("left.avi", "right.avi")):
        make_video(tmp_path / name, [pair[side] for pair in pairs])
    for index, files in enumerate((["both.avi"], ["left.avi", "right.avi"])):
        out = tmp_path / f"out{index}"
        sources = [tmp_path / name for name in files]
        status, printed, error = run_vista("calibrate", *sources, "--board", CHESSBOARD, "--out", out)
        assert status == 0, error
        assert "of 14 pairs used" in printed
        assert_close(read(out, pinhole_rig()), pinhole_rig(), 0.004, 2.5)


def make_video(path: Path, frames: list[np.ndarray]) -> None:
    """Motion JPEG; each picture stands for as long as lies between those that are looked at."""
    height, width = frames[0].shape[:2]
    video = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 5.0, (width, height))
    assert video.isOpened()
    for frame in frames:
        for _ in range(2):  # 0.4 s
            video.write(frame)
    video.release()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda folder: folder / "missing", "no such file or folder"),
        (lambda folder: folder, "holds no pairs"),
        (lambda folder: written(folder / "a.txt", b"text"), "neither a folder nor a video ("),
        (lambda folder: written(folder / "a.mp4", b"no video"), "not readable as a video"),
        (lambda folder: written(folder / "a_left.png", b"").parent, "its right image is missing"),
        (lambda folder: written(folder / "left" / "a.png", b"").parents[1], "holds no pairs"),
    ],
)
def test_sources_that_are_none(make: object, message: str, tmp_path: Path, run_vista: Vista) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    out = tmp_path / "out"
    assert_refused(run_vista("calibrate", make(folder), "--board", CHESSBOARD, "--out", out), message)
    assert not out.exists()


def written(path: Path, data: bytes) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(data)
    return path


def test_folders_left_and_right(chessboards: Path, tmp_path: Path, run_vista: Vista) -> None:
    for side in ("left", "right"):
        (tmp_path / "pictures" / side).mkdir(parents=True)
        for path in sorted(chessboards.glob(f"*_{side}.png"))[:10]:
            (tmp_path / "pictures" / side / f"{path.stem[:3]}.png").write_bytes(path.read_bytes())
    arguments = ("calibrate", tmp_path / "pictures", "--board", CHESSBOARD, "--out", tmp_path / "out")
    assert "of 10 pairs used" in run_vista(*arguments)[1]


# ---- finding corners ----


@pytest.mark.parametrize("legacy", [False, True])
def test_charuco_boards_of_before_and_after_opencv_4_6(legacy: bool) -> None:
    """Both are found, and their corners have the same places."""
    rig, board = pinhole_rig((320, 240)), parse_board("charuco:5x4:60:44")
    printed = replace(board, legacy=legacy)
    random = np.random.default_rng(3)
    poses = board_poses(rig, board, 3, random, 20.0, 0.5)
    pairs = render_pairs(rig, printed, poses, random)
    found = find_views([CalibrationPicture(str(i), *pair) for i, pair in enumerate(pairs)], board)
    assert len(found.views) >= 2
    for view in found.views:
        true_px = seen_px(rig.left, poses[int(view.name)], board.points_m)[view.ids]
        assert np.abs(view.left_px - true_px).max() < 1.0


@pytest.mark.parametrize(
    ("conditions", "worst_px"),
    [
        (Conditions(), 0.2),
        (Conditions(noise=8.0, blur_px=1.2), 0.4),
        (Conditions(noise=4.0, shade=0.85, contrast=0.6), 0.4),
    ],
)
@pytest.mark.parametrize("text", [CHESSBOARD, CHARUCO])
def test_corners_lie_where_the_lens_shows_them(text: str, conditions: Conditions, worst_px: float) -> None:
    rig, board = pinhole_rig(), parse_board(text)
    random = np.random.default_rng(11)
    poses = board_poses(rig, board, 4, random, 30.0, 0.5 if board.markers else 0.32)[1:]
    camera = Camera(rig.left, board)
    for pose in poses:
        sighting = find_board(photograph(camera.render(pose), conditions, random), board)
        assert sighting is not None
        true_px = seen_px(rig.left, pose, board.points_m)[sighting.ids]
        errors_px = np.linalg.norm(sighting.points_px - true_px, axis=1)
        turned_px = np.linalg.norm(sighting.points_px - true_px[::-1], axis=1)  # the board's other end first
        errors_px = min(errors_px, turned_px, key=np.median)
        assert np.sqrt(np.mean(errors_px**2)) < worst_px
