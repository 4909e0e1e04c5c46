"""Calibration boards: what is printed on them, and where an image shows their corners."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError

Grey = NDArray[np.uint8]
Points = NDArray[np.float64]

FORMS = "chessboard:COLSxROWS:SQUARE_MM or charuco:COLSxROWS:SQUARE_MM:MARKER_MM[:DICTIONARY]"
DEFAULT_DICTIONARY = "4X4_250"
MIN_CORNERS = 8  # of a view; fewer say little about a pose
ENOUGH_CORNERS = 0.4  # of a ChArUco board; with fewer it is looked for a second time
SIDES = range(3, 41)  # columns and rows that a board may have
SQUARE_MM = (1.0, 2000.0)


@dataclass(frozen=True)
class Sighting:
    """The corners of the board that one image shows."""

    ids: NDArray[np.int64]  # which corners, increasing
    points_px: Points  # (corners, 2)


@dataclass(frozen=True)
class Board:
    """columns, rows: of a chessboard the inner corners, of a ChArUco board the squares, as OpenCV counts.

    Corners are numbered row by row, x along the columns, y along the rows, z into the board.
    """

    columns: int
    rows: int
    square_m: float
    marker_m: float = 0.0
    dictionary: str = DEFAULT_DICTIONARY
    legacy: bool = False  # a ChArUco board as OpenCV before 4.6 printed those with an even number of rows

    @property
    def markers(self) -> bool:
        """It is a ChArUco board."""
        return self.marker_m > 0.0

    @property
    def grid(self) -> tuple[int, int]:
        """Columns and rows of corners."""
        return (self.columns - 1, self.rows - 1) if self.markers else (self.columns, self.rows)

    @property
    def extent_m(self) -> tuple[float, float]:
        """Width and height of what the origin of the board is a corner of."""
        return self.columns * self.square_m, self.rows * self.square_m

    @cached_property
    def points_m(self) -> Points:
        """(corners, 3) in the frame of the board."""
        columns, rows = self.grid
        first = 1 if self.markers else 0  # where OpenCV has the origin of each kind
        x, y = np.meshgrid(np.arange(columns) + first, np.arange(rows) + first)
        return np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], -1).astype(np.float64) * self.square_m

    def charuco(self) -> cv2.aruco.CharucoBoard:
        board = cv2.aruco.CharucoBoard(
            (self.columns, self.rows), self.square_m, self.marker_m, known_dictionary(self.dictionary)
        )
        board.setLegacyPattern(self.legacy)
        return board

    def __str__(self) -> str:
        count = f"{self.columns}x{self.rows}"
        if self.markers:
            return f"ChArUco board of {count} squares ({self.dictionary})"
        return f"chessboard of {count} inner corners"

    def describe(self) -> str:
        return f"{self}, squares of {1e3 * self.square_m:g} mm"


def parse_board(text: str) -> Board:
    """The board of the option --board. Raises InputError that says what is wrong with it."""
    kind, *fields = text.split(":")
    if (kind, len(fields)) not in (("chessboard", 2), ("charuco", 3), ("charuco", 4)):
        raise InputError("--board", f"must be {FORMS}, not {text!r}")
    sides = fields[0].lower().split("x")
    if len(sides) != 2 or not all(side.isascii() and side.isdigit() for side in sides):
        raise InputError("--board", f"{fields[0]!r} is no COLSxROWS, such as 9x6")
    columns, rows = map(int, sides)
    if columns not in SIDES or rows not in SIDES:
        raise InputError(
            "--board", f"columns and rows must be {SIDES[0]} to {SIDES[-1]}, not {columns}x{rows}"
        )
    square_m = 1e-3 * _length_mm(fields[1])
    if kind == "chessboard":
        return Board(columns, rows, square_m)
    corners = (columns - 1) * (rows - 1)
    if corners < MIN_CORNERS:
        reason = f"{columns}x{rows} squares have {corners} corners between them"
        raise InputError("--board", f"{reason}, at least {MIN_CORNERS} are needed")
    marker_m = 1e-3 * _length_mm(fields[2])
    if marker_m >= square_m:
        raise InputError("--board", "the markers of a ChArUco board are smaller than its squares")
    dictionary = fields[3] if len(fields) == 4 else DEFAULT_DICTIONARY
    dictionary = dictionary.upper().removeprefix("DICT_")
    markers = columns * rows // 2
    known = len(known_dictionary(dictionary).bytesList)
    if markers > known:
        raise InputError("--board", f"has {markers} markers, the dictionary {dictionary} only {known}")
    return Board(columns, rows, square_m, marker_m, dictionary)


def _length_mm(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not SQUARE_MM[0] <= value <= SQUARE_MM[1]:
        low, high = SQUARE_MM
        raise InputError("--board", f"a side must be {low:g} to {high:g} mm, not {text!r}")
    return value


def dictionaries() -> list[str]:
    return sorted(name.removeprefix("DICT_") for name in dir(cv2.aruco) if name.startswith("DICT_"))


def known_dictionary(name: str) -> Any:
    if name not in dictionaries():
        raise InputError("--board", f"unknown dictionary {name!r}; known: {', '.join(dictionaries())}")
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{name}"))


# ---- finding it ----

CHESSBOARD_FLAGS = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
CORNER_ITERATIONS = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-3)
CORNER_WINDOW_SHARE = 0.35  # of the distance to the next corner: half the window around each
CORNER_WINDOW_PX = (2, 11)


def find_board(image: Grey, board: Board) -> Sighting | None:
    """The corners to a fraction of a pixel; None if the image does not show enough of the board."""
    return _find_charuco(image, board) if board.markers else _find_chessboard(image, board)


def _find_chessboard(image: Grey, board: Board) -> Sighting | None:
    found, corners = cv2.findChessboardCorners(
        image, board.grid, flags=CHESSBOARD_FLAGS | cv2.CALIB_CB_FAST_CHECK
    )
    if not found:  # the fast check, and the thresholds with it, fail where light or lens are bad
        found, corners = cv2.findChessboardCornersSB(image, board.grid, flags=cv2.CALIB_CB_NORMALIZE_IMAGE)
    if not found:
        return None
    points_px = corners.reshape(-1, 2).astype(np.float64)
    points_px = _refined(image, points_px, board.grid)
    return Sighting(np.arange(len(points_px)), _handed(points_px, board.grid))


def chessboard_grid(image: Grey) -> tuple[int, int] | None:
    """Columns and rows of inner corners, the larger number first, of a chessboard of any size; None: there is
    none."""
    flags = cv2.CALIB_CB_LARGER | cv2.CALIB_CB_NORMALIZE_IMAGE
    found, _, cells = cv2.findChessboardCornersSBWithMeta(image, (SIDES[0], SIDES[0]), flags)
    if not found:
        return None
    rows, columns = sorted(cells.shape)
    return columns, rows


def _refined(image: Grey, points_px: Points, grid: tuple[int, int]) -> Points:
    columns, rows = grid
    net = points_px.reshape(rows, columns, 2)
    steps_px = [np.linalg.norm(np.diff(net, axis=axis), axis=2).min() for axis in (0, 1)]
    low, high = CORNER_WINDOW_PX
    half = int(np.clip(CORNER_WINDOW_SHARE * min(steps_px), low, high))
    corners = np.ascontiguousarray(points_px[:, np.newaxis], np.float32)
    refined = cv2.cornerSubPix(image, corners, (half, half), (-1, -1), CORNER_ITERATIONS)
    return np.asarray(refined, np.float64).reshape(-1, 2)


def _handed(points_px: Points, grid: tuple[int, int]) -> Points:
    """Columns and rows turn the way x and y of an image do, as on every board that is seen from its front."""
    columns, rows = grid
    net = points_px.reshape(rows, columns, 2)
    along, down = net[0, -1] - net[0, 0], net[-1, 0] - net[0, 0]
    if along[0] * down[1] - along[1] * down[0] < 0.0:
        net = net[:, ::-1]
    return np.ascontiguousarray(net.reshape(-1, 2))


def _find_charuco(image: Grey, board: Board) -> Sighting | None:
    detector = _charuco_detector(board)
    sighting = _charuco_corners(detector, image, 1.0)
    if sighting is None or len(sighting.ids) < ENOUGH_CORNERS * len(board.points_m):
        large = cv2.resize(image, None, fx=2.0, fy=2.0, interpolation=cv2.INTER_CUBIC)  # for small markers
        again = _charuco_corners(detector, np.asarray(large, np.uint8), 2.0)
        sighting = max((sighting, again), key=lambda one: 0 if one is None else len(one.ids))
    if sighting is None:
        return None
    columns = board.grid[0]
    if len(set(sighting.ids // columns)) < 2 or len(set(sighting.ids % columns)) < 2:
        return None  # all on one line
    return sighting


def _charuco_corners(detector: cv2.aruco.CharucoDetector, image: Grey, scale: float) -> Sighting | None:
    """scale: of the image against the one whose corners are wanted."""
    corners, found, _, _ = detector.detectBoard(image)
    if found is None or len(found) < MIN_CORNERS:
        return None
    order = np.argsort(found.ravel())
    points_px = corners.reshape(-1, 2).astype(np.float64)[order]
    # Pixels have their coordinates in their centres.
    return Sighting(np.asarray(found.ravel()[order], np.int64), (points_px + 0.5) / scale - 0.5)


def _charuco_detector(board: Board) -> cv2.aruco.CharucoDetector:
    """Bits may be wrong as far as the dictionary corrects them, and are read off a larger image of a marker:
    in noise that finds up to twice as many. A false marker is not at its place on the board."""
    markers = cv2.aruco.DetectorParameters()
    markers.errorCorrectionRate = 1.0
    markers.maxErroneousBitsInBorderRate = 0.5
    markers.perspectiveRemovePixelPerCell = 8
    return cv2.aruco.CharucoDetector(board.charuco(), cv2.aruco.CharucoParameters(), markers)


def aligned(right: Sighting, left: Sighting, board: Board) -> Sighting:
    """The corners of the right image, numbered as in the left one.

    A chessboard looks the same when it is turned by half a turn, or by a quarter if it is square: the
    numbering is taken that lies on the image as it does in the left one; cameras of a pair are not turned so
    far.
    """
    if board.markers:
        return right
    columns, rows = board.grid
    net = right.points_px.reshape(rows, columns, 2)
    turns = range(0, 4) if columns == rows else (0, 2)
    shape = _centred(left.points_px)
    candidates = [np.rot90(net, turn).reshape(-1, 2) for turn in turns]
    best = min(candidates, key=lambda points_px: float(np.sum((_centred(points_px) - shape) ** 2)))
    return replace(right, points_px=np.ascontiguousarray(best))


def _centred(points_px: Points) -> Points:
    return np.asarray(points_px - points_px.mean(axis=0))
