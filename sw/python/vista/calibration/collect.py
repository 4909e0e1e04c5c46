"""Pictures of a board from cameras that run: which to keep, and what to show next."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vista.calibration.advice import GOOD_DISTANCE_RATIO, GOOD_VIEWS, empty_zones, listed
from vista.calibration.board import Board, Points
from vista.calibration.pictures import Picture
from vista.calibration.views import (
    MAX_VIEWS,
    MIN_APART,
    View,
    board_homography,
    place_of,
    printed_board,
    view_of,
)

NEW_PLACE = 2 * MIN_APART  # distance of two views in the space of `place_of`: all that are kept can be used
STILL_PX = 1.0  # that corners may move between two pictures 640 px wide: a moving board is blurred, and
# two cameras see it at two moments
TILT = 0.25  # by what share the distance grows across a board as wide as the image; some 15 to 20 degrees
TILTS = (  # across or down the image, in which sense, and what to ask for
    (0, 1.0, "Tilt the board so that its right edge is farther away."),
    (0, -1.0, "Tilt the board so that its left edge is farther away."),
    (1, 1.0, "Tilt the board so that its lower edge is farther away."),
    (1, -1.0, "Tilt the board so that its upper edge is farther away."),
)


class Collector:
    """Keeps the pictures in which the board is held still in a place unlike those before."""

    def __init__(self, board: Board) -> None:
        self.kept: list[Picture] = []
        self._board, self._found_kind = board, False
        self._views: list[View] = []
        self._places: list[Points] = []
        self._tilts: list[Points] = []
        self._before: View | None = None

    def look(self, picture: Picture) -> bool:
        """Whether the picture is kept."""
        if not self._found_kind:
            self._board = printed_board(picture, self._board)
        view, before = view_of(picture, self._board), self._before
        self._before = view
        if view is None:
            return False
        self._found_kind = True
        if before is None or _moved_px(view, before) > STILL_PX * max(1.0, picture.size[0] / 640.0):
            return False
        place = place_of(view, self._board, picture.size)
        if any(np.linalg.norm(place - other) < NEW_PLACE for other in self._places):
            return False
        self.kept.append(picture)
        self._views.append(view)
        self._places.append(place)
        self._tilts.append(_tilt(view, self._board, picture.size))
        return True

    @property
    def full(self) -> bool:
        """Nothing is missing, or more would not be used."""
        return len(self.kept) >= MAX_VIEWS or next(self.missing(), None) is None

    def missing(self) -> Iterator[str]:
        """What to show next, as whole sentences, the most important first."""
        if not self.kept:
            yield "Show the board to both cameras, and hold it still."
            return
        size = self.kept[0].size
        for side in ("left", "right"):
            corners = np.concatenate(
                [view.left_px if side == "left" else view.right_px for view in self._views]
            )
            zones = empty_zones(corners, size)
            if zones:
                yield f"Show the board in the {listed(zones[:1])} of the {side} image."
        tilts = np.array(self._tilts)
        for axis, sense, sentence in TILTS:
            if np.max(sense * tilts[:, axis]) < TILT:
                yield sentence
        sizes = np.array(self._places)[:, 2]
        if sizes.max() < GOOD_DISTANCE_RATIO * sizes.min():
            yield "Hold the board nearer, and farther away."
        if len(self.kept) < GOOD_VIEWS:
            yield "Show the board in more places."


def _tilt(view: View, board: Board, size: tuple[int, int]) -> Points:
    """The share by which the distance of the board grows across and down the image, over the image's
    width."""
    H = board_homography(view, board, size)
    if H is None:
        return np.zeros(2)
    sides = H[:2, :2] - np.outer(H[:2, 2], H[2, :2])  # of the board, in the image
    growth = np.linalg.solve(sides.T, H[2, :2])
    return np.asarray(growth * np.array([1.0, size[0] / size[1]]))


def _moved_px(view: View, before: View) -> float:
    """How far the corners that both views show have moved at most; infinity if there are none."""
    _, now, then = np.intersect1d(view.ids, before.ids, return_indices=True)
    if len(now) == 0:
        return np.inf
    moves = (view.left_px[now] - before.left_px[then], view.right_px[now] - before.right_px[then])
    return float(max(np.linalg.norm(move, axis=1).max() for move in moves))
