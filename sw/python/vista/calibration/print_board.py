"""A calibration board as a drawing that prints at its true size."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np

from vista.calibration.board import Board, known_dictionary

LABEL_MM = 4.0
Box = tuple[float, float, float, float]  # left, top, width, height


def board_svg(board: Board) -> str:
    """SVG in millimetres, with a white margin of a square: without one the edge of a board is not found."""
    square_mm = 1e3 * board.square_m
    columns, rows = (board.columns, board.rows) if board.markers else (board.columns + 1, board.rows + 1)
    width, height = _text(square_mm * (columns + 2)), _text(square_mm * (rows + 2))
    boxes = "".join(
        f"M{_text(x + square_mm)} {_text(y + square_mm)}h{_text(w)}v{_text(h)}h{_text(-w)}z"
        for x, y, w, h in black_boxes_mm(board)
    )
    label = f"{board.describe()}. Print it at 100 % and measure a square."
    return f"""\
<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">
<style>@page {{ size: {width}mm {height}mm; margin: 0 }}</style>
<rect width="100%" height="100%" fill="#fff"/>
<path d="{boxes}"/>
<text x="{_text(square_mm)}" y="{_text((rows + 1.6) * square_mm)}" font-family="sans-serif" \
font-size="{_text(min(LABEL_MM, 0.3 * square_mm))}">{label}</text>
</svg>
"""


def black_boxes_mm(board: Board) -> Iterator[Box]:
    """What is black, from the upper left corner of the board on."""
    yield from _marker_boxes(board) if board.markers else ()
    yield from _square_boxes(board)


def _square_boxes(board: Board) -> Iterator[Box]:
    """The upper left square is black; on older ChArUco boards with an even number of rows it is white."""
    side_mm = 1e3 * board.square_m
    columns, rows = (board.columns, board.rows) if board.markers else (board.columns + 1, board.rows + 1)
    first = int(board.legacy and rows % 2 == 0)
    for row in range(rows):
        for column in range((row + first) % 2, columns, 2):
            yield column * side_mm, row * side_mm, side_mm, side_mm


def _marker_boxes(board: Board) -> Iterator[Box]:
    """Runs of black bits. OpenCV's board says where each marker is, and its dictionary what it looks like."""
    charuco, dictionary = board.charuco(), known_dictionary(board.dictionary)
    bits = dictionary.markerSize + 2  # with the border
    bit_mm = 1e3 * board.marker_m / bits
    for marker, corners_m in zip(np.ravel(charuco.getIds()), charuco.getObjPoints(), strict=True):
        left_mm, top_mm = 1e3 * np.min(np.asarray(corners_m)[:, :2], axis=0)
        picture = cv2.aruco.generateImageMarker(dictionary, int(marker), bits, borderBits=1)
        for row, line in enumerate(picture < 128):
            edges = np.flatnonzero(np.diff(np.concatenate([[False], line, [False]]).astype(np.int8)))
            for begin, end in edges.reshape(-1, 2):
                yield left_mm + begin * bit_mm, top_mm + row * bit_mm, (end - begin) * bit_mm, bit_mm


def _text(length_mm: float) -> str:
    return f"{length_mm:.4f}".rstrip("0").rstrip(".")
