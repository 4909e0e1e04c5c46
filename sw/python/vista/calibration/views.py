"""Views of the board in both cameras, and the choice of those that tell most about them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.calibration.board import MIN_CORNERS, Board, Points, Sighting, aligned, chessboard_grid, find_board
from vista.calibration.pictures import Grey, Picture
from vista.errors import InputError

MAX_VIEWS = 30  # more make the fit slow and hardly better
MIN_VIEWS = 8
MIN_APART = 0.06  # of two views in the space of `_place`; nearer ones say the same twice
HINT_PICTURES = 3  # that are searched for another board when hardly any shows the named one
# The smaller ones hold the first markers of these.
LARGEST_DICTIONARIES = (
    "4X4_1000",
    "5X5_1000",
    "6X6_1000",
    "7X7_1000",
    "ARUCO_ORIGINAL",
    "ARUCO_MIP_36H12",
    "APRILTAG_16H5",
    "APRILTAG_25H9",
    "APRILTAG_36H10",
    "APRILTAG_36H11",
)


@dataclass(frozen=True)
class View:
    """Corners of the board that both images of a pair show."""

    name: str
    ids: NDArray[np.int64]
    left_px: Points
    right_px: Points


@dataclass
class Found:
    """What the pictures show."""

    size: tuple[int, int] = (0, 0)
    pictures: int = 0
    views: list[View] = field(default_factory=list)
    left_only: int = 0
    right_only: int = 0
    few_common: int = 0  # both images show the board, but hardly the same corners
    without: list[Picture] = field(default_factory=list)  # the last few pairs that are no view
    shown: Picture | None = None  # the pair with the largest board, for the report


def find_views(pictures: Iterable[Picture], board: Board) -> Found:
    """Raises InputError when no picture shows the board, and says what is there instead, if anything."""
    found = Found()
    asked = board
    largest = 0.0
    for picture in pictures:
        found.pictures += 1
        found.size = picture.size
        if not (found.views or found.left_only or found.right_only):
            board = printed_board(picture, asked)
        left, right = find_board(picture.left, board), find_board(picture.right, board)
        view = None
        if left is not None and right is not None:
            view = _common(picture.name, left, right, board)
            found.few_common += view is None
        else:
            found.left_only += left is not None
            found.right_only += right is not None
        if view is None:
            found.without = [*found.without[-HINT_PICTURES + 1 :], picture]
            continue
        found.views.append(view)
        area = float(np.prod(np.ptp(view.left_px, axis=0)))
        if area > largest:
            largest, found.shown = area, picture
    if not (found.views or found.left_only or found.right_only):
        if found.pictures == 0:
            raise InputError("--board", "there are no pictures")
        reason = f"none of {found.pictures} pairs shows a {asked}"
        raise InputError("--board", reason + other_board(asked, found.without))
    return found


def printed_board(picture: Picture, board: Board) -> Board:
    """The board as it was printed: before OpenCV 4.6, a ChArUco board with an even number of rows started
    with a white square, not with a black one."""
    if not board.markers or board.rows % 2 or find_board(picture.left, board) is not None:
        return board
    older = replace(board, legacy=True)
    return board if find_board(picture.left, older) is None else older


def view_of(picture: Picture, board: Board) -> View | None:
    """None: not enough of the board is in both images."""
    left, right = find_board(picture.left, board), find_board(picture.right, board)
    return None if left is None or right is None else _common(picture.name, left, right, board)


def _common(name: str, left: Sighting, right: Sighting, board: Board) -> View | None:
    """The corners that both images show, if they are enough for a pose."""
    right = aligned(right, left, board)
    ids, in_left, in_right = np.intersect1d(left.ids, right.ids, return_indices=True)
    columns = board.grid[0]
    if len(ids) < MIN_CORNERS or len(set(ids // columns)) < 2 or len(set(ids % columns)) < 2:
        return None
    return View(name, ids, left.points_px[in_left], right.points_px[in_right])


# ---- choice ----


def spread_views(views: list[View], board: Board, size: tuple[int, int]) -> list[View]:
    """Chooses at most MAX_VIEWS, each as different as can be from those before it, in the order of the
    recording."""
    places = np.array([place_of(view, board, size) for view in views])
    chosen = [int(np.argmin(np.linalg.norm(places - places.mean(axis=0), axis=1)))]
    distance = np.linalg.norm(places - places[chosen[0]], axis=1)
    while len(chosen) < min(MAX_VIEWS, len(views)):
        farthest = int(np.argmax(distance))
        if distance[farthest] < MIN_APART:
            break
        chosen.append(farthest)
        distance = np.minimum(distance, np.linalg.norm(places - places[farthest], axis=1))
    return [views[index] for index in sorted(chosen)]


def place_of(view: View, board: Board, size: tuple[int, int]) -> Points:
    """The place of the board in the left image, its size and its tilt; each about 0 to 1."""
    H = board_homography(view, board, size)
    if H is None:
        return np.append(view.left_px.mean(axis=0) / size, [0.0, 0.0, 0.0])
    center = H[:2, 2]
    across, down = H[:2, 0] - center * H[2, 0], H[:2, 1] - center * H[2, 1]
    size_share = np.sqrt(abs(across[0] * down[1] - across[1] * down[0]))
    place = np.array([*center, 1.5 * size_share, H[2, 0], H[2, 1]], np.float64)
    return np.asarray(np.clip(place, -1.0, 2.0))


def board_homography(view: View, board: Board, size: tuple[int, int]) -> Points | None:
    """Maps the board, 1 wide and high with its middle at 0, to the left image, of width and height 1. The
    last entry is 1. None: the corners do not tell it."""
    plane = board.points_m[view.ids, :2] / np.array(board.extent_m) - 0.5
    found, _ = cv2.findHomography(plane, view.left_px / np.array(size))
    return None if found is None else np.asarray(found, np.float64) / found[2, 2]


# ---- nothing found ----


def other_board(board: Board, pictures: list[Picture]) -> str:
    """The end of a message that says what the pictures show in place of the board, if that is known."""
    images = [image for picture in pictures for image in (picture.left, picture.right)]
    return _other_charuco(board, images) if board.markers else _other_chessboard(board, images)


def _other_chessboard(board: Board, images: list[Grey]) -> str:
    """The chessboard that most images show, if it has another count of corners than the named one."""
    grids = Counter(grid for image in images if (grid := chessboard_grid(image)) is not None)
    if not grids or (seen := grids.most_common(1)[0][0]) == tuple(sorted(board.grid, reverse=True)):
        return ""
    columns, rows = seen
    option = f"--board chessboard:{columns}x{rows}:{1e3 * board.square_m:g}"
    return f", but a {replace(board, columns=columns, rows=rows)} is there, which is {option}"


def _other_charuco(board: Board, images: list[Grey]) -> str:
    mirrored = [np.ascontiguousarray(image[:, ::-1]) for image in images]
    if any(find_board(image, board) is not None for image in mirrored):
        return ": the images, or the print, are mirrored"
    if _markers(board.dictionary, images) >= MIN_CORNERS:
        return ", but markers of its dictionary: count columns and rows of squares"
    if _markers(board.dictionary, mirrored) >= MIN_CORNERS:
        return ": the images, or the print, are mirrored"
    for name in LARGEST_DICTIONARIES:
        if _markers(name, images) >= MIN_CORNERS:
            return f", but markers of the dictionary {name}, or of a smaller one of its kind"
    return ""


def _markers(dictionary: str, images: list[Grey]) -> int:
    """How many the image with most of them shows."""
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{dictionary}"))
    detector = cv2.aruco.ArucoDetector(known)
    return max((len(detector.detectMarkers(image)[0]) for image in images), default=0)
