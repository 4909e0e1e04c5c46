"""What to photograph next: what the views leave open, the worst first."""

from __future__ import annotations

import numpy as np

from vista.calibration.board import Points
from vista.calibration.calibrate import Calibrated
from vista.calibration.measure import coverage, distances_m, normals, spread_deg
from vista.geometry import Array

GOOD_VIEWS = 15
GOOD_SPREAD_DEG = 40.0
GOOD_DISTANCE_RATIO = 1.4
GOOD_RMS_PX = 0.5  # of an image 640 px wide
GOOD_ROW_ERROR_PX = 0.3
MANY_LEFT_OUT = 0.2
MIN_IN_ZONE = 4  # corners
ROWS, COLUMNS = ("top", "middle", "bottom"), ("left", "centre", "right")


def advice(made: Calibrated) -> list[str]:
    """Whole sentences; none if the views leave nothing open."""
    solution, scale = made.solution, max(1.0, made.found.size[0] / 640.0)
    poses = solution.left_from_board
    found = []
    if solution.rms_px() > GOOD_RMS_PX * scale:
        found.append(
            f"The corners fit to {solution.rms_px():.2f} px only: check that the board is flat and its "
            "squares have the stated size, that the images are sharp, and try another --lens."
        )
    elif made.after.rms_px > GOOD_ROW_ERROR_PX * scale:
        found.append(
            f"Rows differ by {made.after.rms_px:.2f} px after rectification: check that both images of "
            "a pair are taken at one moment."
        )
    total = len(made.left_out) + len(solution.views)
    if len(made.left_out) > MANY_LEFT_OUT * total:
        found.append(
            f"{len(made.left_out)} of {total} views did not agree with the others: hold the board still, "
            "and check that both images of a pair are taken at one moment."
        )
    for side in ("left", "right"):
        empty = empty_zones(corners(made, side), made.found.size)
        if empty:
            found.append(f"Show the board in the {listed(empty)} of the {side} image: no corners lie there.")
    spread = spread_deg(normals(poses))
    if spread < GOOD_SPREAD_DEG:
        found.append(
            f"Tilt the board more: the directions that it faced are within {spread:.0f} degrees; "
            "20 to 45 degrees to the left, right, up and down are good."
        )
    distances = distances_m(poses, made.board)
    if distances.max() < GOOD_DISTANCE_RATIO * distances.min():
        found.append(
            f"Hold the board nearer and farther: it was {distances.min():.2f} to {distances.max():.2f} m "
            "away in every view."
        )
    if len(solution.views) < GOOD_VIEWS:
        found.append(
            f"Take more pairs: {len(solution.views)} different views were used, {GOOD_VIEWS} or more are "
            "good."
        )
    return found


def corners(made: Calibrated, side: str) -> Array:
    """All corners of the views that were used in the images of one camera, px."""
    views = made.solution.views
    return np.concatenate([view.left_px if side == "left" else view.right_px for view in views])


def covered_share(made: Calibrated, side: str) -> float:
    return float(np.mean(coverage(corners(made, side), made.found.size) > 0))


def empty_zones(corners_px: Points, size: tuple[int, int]) -> list[str]:
    """Names those of the nine zones of an image in which hardly a corner lies."""
    counts = coverage(corners_px, size, (3, 3))
    return [
        f"{ROWS[row]} {COLUMNS[column]}"
        for row in range(3)
        for column in range(3)
        if counts[row, column] < MIN_IN_ZONE
    ]


def listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
