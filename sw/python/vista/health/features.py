"""Features of one image that are found again in another: what the checks of a pair and of motion measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.uint8]

SMOOTHING_PX = 1.2  # sigma; keeps the noise of the sensor from making features and from hiding agreement
PATCH_RADIUS_PX = 7
SEARCH_PX = 4  # around the place that the descriptors give
MIN_CORRELATION = 0.9
ROW_LIMIT_PX = 20.0  # matches that lie further apart in rows are taken for false ones
FLOW_FEATURES = 200
FLOW_WINDOW_PX = 21
FLOW_LEVELS = 3
FLOW_CLOSURE_PX = 0.5  # a feature that is followed there and back has to arrive where it started


@dataclass(frozen=True)
class PairMatches:
    """Features of the left image that were found in the right one.

    The alignment (vista/alignment.h) matches features as well, of pairs whose cameras are nearly aligned: at
    disparities from 0 on, near their rows. It cannot tell swapped images from another moment or from a large
    turn. These features are looked for in the whole image, where the alignment knows no rows or is off.
    """

    candidates: int  # pairs of descriptors that are each other's best match
    disparity_px: NDArray[np.float64]  # u_left - u_right of those candidates whose surroundings agree
    row_error_px: NDArray[np.float64]  # v_right - v_left of the same

    def near_rows(self) -> NDArray[np.float64]:
        """Row errors without those above ROW_LIMIT_PX."""
        return self.row_error_px[np.abs(self.row_error_px) <= ROW_LIMIT_PX]


def match_pair(left: Grey, right: Grey, features: int) -> PairMatches:
    """Matches at most so many ORB features both ways. The surroundings of the left feature are then
    correlated with those of the right one; a parabola gives the fraction of a pixel.
    """
    left, right = _smoothed(left), _smoothed(right)
    orb = cv2.ORB.create(features)
    left_points, left_words = orb.detectAndCompute(left, None)
    right_points, right_words = orb.detectAndCompute(right, None)
    if not left_points or not right_points:
        return PairMatches(0, np.empty(0), np.empty(0))
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(left_words, right_words)
    shifts = np.array(
        [
            shift
            for match in matches
            if (
                shift := _refine(left, right, left_points[match.queryIdx].pt, right_points[match.trainIdx].pt)
            )
        ]
    ).reshape(-1, 2)
    return PairMatches(len(matches), -shifts[:, 0], shifts[:, 1])


def _smoothed(image: Grey) -> Grey:
    return np.asarray(cv2.GaussianBlur(image, (0, 0), SMOOTHING_PX), np.uint8)


def _refine(
    left: Grey, right: Grey, left_px: Sequence[float], right_px: Sequence[float]
) -> tuple[float, float] | None:
    """(u, v) of the right feature minus those of the left one; None where the surroundings do not agree."""
    (u, v), (x, y) = np.rint([left_px, right_px]).astype(int)
    patch = _square(left, u, v, PATCH_RADIUS_PX)
    window = _square(right, x, y, PATCH_RADIUS_PX + SEARCH_PX)
    if patch is None or window is None:
        return None
    scores = cv2.matchTemplate(window, patch, cv2.TM_CCOEFF_NORMED)
    _, best, _, (column, row) = cv2.minMaxLoc(scores)
    if best <= MIN_CORRELATION or not (0 < row < 2 * SEARCH_PX and 0 < column < 2 * SEARCH_PX):
        return None
    du = _peak(scores[row, column - 1], best, scores[row, column + 1])
    dv = _peak(scores[row - 1, column], best, scores[row + 1, column])
    return x + column - SEARCH_PX + du - u, y + row - SEARCH_PX + dv - v


def _square(image: Grey, u: int, v: int, radius: int) -> Grey | None:
    if not (radius <= v < image.shape[0] - radius and radius <= u < image.shape[1] - radius):
        return None
    return image[v - radius : v + radius + 1, u - radius : u + radius + 1]


def _peak(before: float, best: float, after: float) -> float:
    """The place of the maximum of the parabola through three values, from the middle one."""
    return 0.5 * float(before - after) / float(before - 2.0 * best + after)


def image_motion_px(before: Grey, after: Grey) -> NDArray[np.float64]:
    """How far each feature that can be followed from one image to the next has moved."""
    corners = cv2.goodFeaturesToTrack(before, FLOW_FEATURES, 0.01, 8)
    if corners is None:
        return np.empty(0)
    points = np.asarray(corners, np.float32).reshape(-1, 2)
    moved, sure = follow(before, after, points, FLOW_LEVELS)
    return np.asarray(np.linalg.norm(moved - points, axis=1)[sure], np.float64)


def follow(
    before: Grey, after: Grey, points: NDArray[np.float32], levels: int
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Follows points (n, 2) by optical flow (Lucas-Kanade, with so many levels above the image), and
    says of which that is sure: followed back, they arrive where they started."""
    way = partial(
        cv2.calcOpticalFlowPyrLK,
        nextPts=None,
        winSize=(FLOW_WINDOW_PX, FLOW_WINDOW_PX),
        maxLevel=levels,
    )
    there, found, _ = way(before, after, points)
    back, found_back, _ = way(after, before, there)
    closes = np.linalg.norm(back - points, axis=1) < FLOW_CLOSURE_PX
    return np.asarray(there, np.float32), (found.ravel() == 1) & (found_back.ravel() == 1) & closes
