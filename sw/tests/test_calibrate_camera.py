"""`vista calibrate --camera`: which pictures of a board are kept while cameras run, and what is asked for."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from board_rig import board_poses, exact_row_errors_px, pinhole_rig, render_pairs
from command_line import Vista, assert_refused
from vista.calibration.board import parse_board
from vista.calibration.collect import Collector
from vista.calibration.pictures import Picture, read_pictures
from vista.calibration.views import MAX_VIEWS
from vista.command import source_arguments
from vista.geometry import Pose
from vista.sequence.options import Options
from vista.sequence.pairs import read_calibration_file

pytestmark = pytest.mark.slow

BOARD = "chessboard:9x6:50"
COUNT = 28
LOOKS = 4  # one may still be of the place before, and two that agree are needed


@pytest.fixture(scope="module")
def pictures() -> list[Picture]:
    """Pictures of the board in many places."""
    random, rig, board = np.random.default_rng(31), pinhole_rig(), parse_board(BOARD)
    poses = board_poses(rig, board, COUNT, random)
    return [Picture(str(k), *pair) for k, pair in enumerate(render_pairs(rig, board, poses, random))]


def turned(axis: int, degrees: float, depth_m: float = 1.2) -> Picture:
    """The board in the middle, its right edge (axis 1) or lower edge (axis 0) farther away."""
    rig, board = pinhole_rig(), parse_board(BOARD)
    angle = np.radians(degrees)
    turn, (i, j) = np.eye(3), ((0, 2), (1, 2))[axis == 0]
    turn[i, i] = turn[j, j] = np.cos(angle)
    turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
    middle_m = np.array([*board.extent_m, 0.0]) / 2.0
    pose = Pose(turn, np.array([0.05, 0.0, depth_m]) - turn @ middle_m)
    return Picture("0", *render_pairs(rig, board, [pose], np.random.default_rng(7))[0])


def test_a_board_that_moves_and_a_place_that_is_known_are_left_out(pictures: list[Picture]) -> None:
    collector = Collector(parse_board(BOARD))
    empty = Picture("empty", *np.zeros((2, 480, 640), np.uint8))
    assert not collector.look(empty)
    assert [collector.look(picture) for picture in pictures[:3]] == [False] * 3  # each elsewhere
    assert collector.look(pictures[2])
    assert not collector.look(pictures[2])  # the same again
    assert not collector.look(empty) and not collector.look(pictures[0])  # came anew: is it still?
    assert collector.look(pictures[0])
    assert collector.kept == [pictures[2], pictures[0]]


@pytest.mark.parametrize(
    ("axis", "degrees", "edge"),
    [(1, 30.0, "right"), (1, -30.0, "left"), (0, 30.0, "lower"), (0, -30.0, "upper")],
)
def test_the_tilt_that_is_missing_is_asked_for(axis: int, degrees: float, edge: str) -> None:
    """A board that is tilted one way is asked for the three others."""
    collector = Collector(parse_board(BOARD))
    picture = turned(axis, degrees)
    collector.look(picture)
    assert collector.look(picture)
    asked = [sentence for sentence in collector.missing() if "Tilt" in sentence]
    edges = {"right", "left", "lower", "upper"}
    assert {word for sentence in asked for word in sentence.split() if word in edges} == edges - {edge}


def test_a_set_without_gaps_is_full(pictures: list[Picture]) -> None:
    collector = Collector(parse_board(BOARD))
    assert next(collector.missing()).startswith("Show the board to both cameras")
    missing: list[str] = []
    for picture in pictures:
        missing = list(collector.missing())
        collector.look(picture)
        collector.look(picture)
        if collector.full:
            break
    assert len(missing) == 1 and missing[0].startswith("Show the board in the ")  # before the last picture
    assert collector.full and list(collector.missing()) == []
    assert 15 <= len(collector.kept) < MAX_VIEWS


class Held:
    """A camera with both views side by side, before which a board is held in one place after the other, in
    each until it was looked at LOOKS times: however slow the machine is."""

    def __init__(self, pictures: list[Picture]) -> None:
        self.looks = 0
        self._pictures = pictures

    def read(self) -> np.ndarray | None:
        time.sleep(0.01)
        picture = self._pictures[self.looks // LOOKS % len(self._pictures)]
        return np.hstack([picture.left, picture.right])

    def close(self) -> None: ...


def test_cameras_are_calibrated_while_they_run(
    pictures: list[Picture], tmp_path: Path, run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    camera, look = Held(pictures), Collector.look

    def counted(collector: Collector, picture: Picture) -> bool:
        camera.looks += 1
        return look(collector, picture)

    monkeypatch.setattr(Collector, "look", counted)
    monkeypatch.setattr(source_arguments, "Capture", lambda name, size: camera)
    monkeypatch.setattr("vista.calibration.collect.GOOD_VIEWS", 12)
    monkeypatch.setattr("vista.calibration.collect.MAX_VIEWS", 12)
    status, out, err = run_vista("calibrate", "--camera", "0", "--board", BOARD, "--out", tmp_path)
    assert status == 0 and "12 kept (000011)" in err
    rig = pinhole_rig()
    found = read_calibration_file(tmp_path / "calibration.toml", (640, 480)).calibration
    assert np.sqrt(np.mean(exact_row_errors_px(found, rig) ** 2)) < 0.15
    assert "views of 12 pairs used" in out
    kept = list(read_pictures([tmp_path / "pictures"], Options()))
    assert len(kept) == 12
    assert all(any(np.array_equal(one.left, picture.left) for picture in pictures) for one in kept)


def test_bad_options_take_one_line(run_vista: Vista, tmp_path: Path) -> None:
    for given, text in (
        ((), "takes SOURCE or --camera"),
        (("--camera", "0"), "--camera: needs --board"),
        (("--camera", "0", "--board", BOARD, "--rate", "3"), "--rate: does not go with --camera"),
        (
            ("pictures", "--board", BOARD, "--size-px", "4x4"),
            "--size-px: is for cameras, and calibration files",
        ),
        (("--camera", "99", "--board", BOARD), "99: no camera that OpenCV can open"),
    ):
        assert_refused(run_vista("calibrate", *given, "--out", tmp_path / "out"), text)
        assert not (tmp_path / "out").exists()
