"""What a calibration is worth: row errors before and after rectification, coverage, tilt of the board."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vista.calibration.board import Board, Points
from vista.calibration.views import View
from vista.geometry import Array, Pose, RawCalibration
from vista.lens import rectified_points
from vista.rectify import rectified_cameras

COVERAGE_GRID = (8, 6)  # cells across and down the image


@dataclass(frozen=True)
class RowErrors:
    """How far the corners of the right image lie from the rows of the left one."""

    rms_px: float
    p95_px: float
    of_views_px: list[float]  # root mean square of each


def row_errors(views: list[View], raw: RawCalibration | None) -> RowErrors:
    """raw: rectifies the corners; None: as they are in the raw images."""
    errors = [np.asarray(view.right_px[:, 1] - view.left_px[:, 1]) for view in views]
    if raw is not None:
        left, right = rectified_cameras(raw)
        errors = [
            rectified_points(raw.right, view.right_px, *right)[:, 1]
            - rectified_points(raw.left, view.left_px, *left)[:, 1]
            for view in views
        ]
    every = np.concatenate(errors)
    return RowErrors(_rms(every), float(np.percentile(np.abs(every), 95)), [_rms(error) for error in errors])


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def coverage(points_px: Points, size: tuple[int, int], grid: tuple[int, int] = COVERAGE_GRID) -> Array:
    """(rows, columns): how many corners lie in each cell of the image."""
    counts, _, _ = np.histogram2d(
        points_px[:, 1], points_px[:, 0], bins=(grid[1], grid[0]), range=((0, size[1]), (0, size[0]))
    )
    return np.asarray(counts)


def normals(poses: list[Pose]) -> Array:
    """(views, 3) directions that the board faced in the frame of the left camera."""
    return np.array([pose.rotation[:, 2] for pose in poses])


def spread_deg(directions: Array) -> float:
    """The largest angle between two of the directions."""
    return float(np.degrees(np.arccos(np.clip(directions @ directions.T, -1.0, 1.0)).max()))


def distances_m(poses: list[Pose], board: Board) -> Array:
    """(views,) from the left camera to the middle of the board."""
    middle_m = board.points_m.mean(axis=0)
    return np.array([np.linalg.norm(pose.apply(middle_m)) for pose in poses])
