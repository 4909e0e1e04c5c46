"""Boards as drawings: what is drawn is found again, and has the size that was stated."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command_line import assert_refused, call
from numpy.typing import NDArray
from vista.calibration.board import Board, find_board, parse_board
from vista.calibration.print_board import black_boxes_mm, board_svg

PX_PER_MM = 4
BOARDS = (
    "chessboard:9x6:20",
    "chessboard:6x6:12.5",
    "charuco:8x6:24:18",
    "charuco:7x5:30:18:5X5_250",
    "charuco:5x7:20:16:6X6_50",
    "charuco:6x4:24:18:APRILTAG_36H11",
)


def size_mm(svg: str) -> NDArray[np.float64]:
    root = ElementTree.fromstring(svg)
    assert root.get("viewBox") == f"0 0 {root.get('width', '')[:-2]} {root.get('height', '')[:-2]}"
    return np.array([float(root.get(side, "").removesuffix("mm")) for side in ("width", "height")])


def picture(svg: str) -> NDArray[np.uint8]:
    """Draws the paths of the file, which are rectangles, with PX_PER_MM."""
    width, height = np.round(size_mm(svg) * PX_PER_MM).astype(int)
    image = np.full((height, width), 255, np.uint8)
    for box in re.findall(r"M([\d.]+) ([\d.]+)h([\d.]+)v([\d.]+)h-", svg):
        x, y, w, h = (float(number) * PX_PER_MM for number in box)
        image[round(y) : round(y + h), round(x) : round(x + w)] = 0
    return image


@pytest.mark.parametrize("text", BOARDS)
def test_what_is_drawn_is_found(text: str) -> None:
    """All corners, to a fraction of a pixel, where the size of the squares says that they are."""
    board = parse_board(text)
    sighting = find_board(picture(board_svg(board)), board)
    assert sighting is not None and len(sighting.ids) == len(board.points_m)
    origin_m = board.square_m * (1 if board.markers else 2)  # margin; of a chessboard the first corner
    expected_px = 1e3 * PX_PER_MM * (board.points_m[sighting.ids, :2] + origin_m) - 0.5
    turned_px = expected_px[::-1]  # a chessboard looks the same after half a turn
    errors_px = [np.abs(sighting.points_px - points).max() for points in (expected_px, turned_px)]
    assert min(errors_px) < 0.75


def test_older_boards_begin_with_a_white_square() -> None:
    board = Board(8, 6, 0.024, 0.018, legacy=True)
    assert (0.0, 0.0, 24.0, 24.0) not in list(black_boxes_mm(board))
    sighting = find_board(picture(board_svg(board)), board)
    assert sighting is not None and len(sighting.ids) == len(board.points_m)


def test_the_command_writes_it(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    run = partial(call, capsys)
    file = tmp_path / "board.svg"
    assert run("calibrate", "--board", BOARDS[2], "--print", file)[0] == 0
    assert file.read_text() == board_svg(parse_board(BOARDS[2]))
    assert tuple(size_mm(file.read_text())) == (24.0 * 10, 24.0 * 8)
    assert_refused(run("calibrate", "--print", file), "--print: needs --board")
    assert_refused(
        run("calibrate", "--board", BOARDS[2], "--print", tmp_path / "none" / "b.svg"), "cannot be written"
    )
    assert_refused(run("calibrate", "--board", BOARDS[2], "here"), "--out: is missing")
