"""The cameras that explain the views best: OpenCV's fits, and the views that do not agree left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from vista.calibration.board import Board, Points
from vista.calibration.views import MIN_VIEWS, View
from vista.errors import InputError
from vista.geometry import Array, CameraModel, Lens, Pose, camera_matrix
from vista.lens import project

ITERATIONS = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 200, 1e-9)
OUTLIER_FACTOR = 3.0  # of the median of the views' errors
OUTLIER_PX = 0.4  # what is below is never an outlier
MAX_ROUNDS = 6
Pair = tuple[Points, Points]  # of the left and the right image
LENSES = ("pinhole", "pinhole5", "fisheye")


@dataclass(frozen=True)
class Solution:
    """A pair of cameras, and how well they explain each view."""

    left: CameraModel
    right: CameraModel
    right_from_left: Pose
    views: list[View]
    left_from_board: list[Pose]  # of each view
    left_errors_px: list[float]  # root mean square of the distances, each view
    right_errors_px: list[float]

    def rms_px(self) -> float:
        """The error of all corners of both cameras."""
        return float(np.hypot(self.rms_of_px("left"), self.rms_of_px("right")) / np.sqrt(2.0))

    def rms_of_px(self, side: str) -> float:
        """The error of all corners of one camera."""
        errors_px = self.left_errors_px if side == "left" else self.right_errors_px
        corners = [len(view.ids) for view in self.views]
        return float(np.sqrt(np.average(np.square(errors_px), weights=corners)))


def solve_pair(
    views: list[View], board: Board, size: tuple[int, int], lens: str
) -> tuple[Solution, dict[str, str]]:
    """The solution, and why views were left out, by their names. Raises InputError if too few agree."""
    left_out: dict[str, str] = {}
    kept = views
    cameras = []
    for side in ("left", "right"):
        for _ in range(MAX_ROUNDS):
            camera, errors_px = _solve_camera(kept, side, board, size, lens)
            bad = _outliers(errors_px)
            if not bad.any():
                break
            kept = _without(kept, bad, errors_px, f"{side} camera", left_out, len(views))
        cameras.append(camera)
    for _ in range(MAX_ROUNDS):
        solution = _solve_both(kept, cameras[0], cameras[1], board, lens)
        errors_px = np.maximum(solution.left_errors_px, solution.right_errors_px)
        bad = _outliers(errors_px)
        if not bad.any():
            break
        kept = _without(kept, bad, errors_px, "both cameras together", left_out, len(views))
    return solution, left_out


def _outliers(errors_px: Array) -> Array:
    return np.asarray(errors_px > max(OUTLIER_PX, OUTLIER_FACTOR * float(np.median(errors_px))))


def _without(
    views: list[View], bad: Array, errors_px: Array, where: str, left_out: dict[str, str], total: int
) -> list[View]:
    for view, is_bad, error_px in zip(views, bad, errors_px, strict=True):
        if is_bad:
            left_out[view.name] = f"{error_px:.2f} px in {where}"
    kept = [view for view, is_bad in zip(views, bad, strict=True) if not is_bad]
    if len(kept) < MIN_VIEWS:
        name, reason = max(left_out.items(), key=lambda item: float(item[1].partition(" ")[0]))
        raise InputError(
            "views",
            f"only {len(kept)} of {total} agree with each other, at least {MIN_VIEWS} are needed "
            f"({name}: {reason}): was the board flat and still, and each pair taken at one moment?",
        )
    return kept


# ---- OpenCV ----


def _flag(name: str) -> int:
    """OpenCV 4 keeps the flags of fisheye lenses in a module of their own."""
    return int(getattr(cv2.fisheye, name, None) or getattr(cv2, name))


def _flags(lens: str) -> int:
    if lens == "fisheye":
        return _flag("CALIB_RECOMPUTE_EXTRINSIC") | _flag("CALIB_FIX_SKEW")
    return 0 if lens == "pinhole5" else cv2.CALIB_FIX_K3


def _solve_camera(
    views: list[View], side: str, board: Board, size: tuple[int, int], lens: str
) -> tuple[CameraModel, Array]:
    """One camera by itself, and the error of each view."""
    objects = [board.points_m[view.ids] for view in views]
    points_px = [view.left_px if side == "left" else view.right_px for view in views]
    try:
        if lens == "fisheye":
            fit = cv2.fisheye.calibrate(
                [p[np.newaxis] for p in objects],
                [p[np.newaxis] for p in points_px],
                size,
                _first_guess(size),
                np.zeros(4),
                flags=_flags(lens) | _flag("CALIB_USE_INTRINSIC_GUESS"),
                criteria=ITERATIONS,
            )
        else:
            empty = np.empty(0)
            fit = cv2.calibrateCamera(
                [p.astype(np.float32) for p in objects],
                [p.astype(np.float32) for p in points_px],
                size,
                empty,
                empty,
                flags=_flags(lens),
                criteria=ITERATIONS,
            )
    except cv2.error:
        raise _no_solution(f"{side} camera") from None
    _, K, D, rvecs, tvecs = fit
    camera = _camera(np.asarray(K), np.asarray(D), size, lens, f"{side} camera")
    poses = [_pose(r, t) for r, t in zip(rvecs, tvecs, strict=True)]
    errors = [_error_px(camera, pose, p, q) for pose, p, q in zip(poses, objects, points_px, strict=True)]
    return camera, np.array(errors)


def _first_guess(size: tuple[int, int]) -> Array:
    """A fisheye lens that sees 120 degrees across."""
    focal_px = size[0] / np.radians(120.0)
    return camera_matrix(focal_px, focal_px, (size[0] - 1) / 2.0, (size[1] - 1) / 2.0)


def _solve_both(
    views: list[View], left: CameraModel, right: CameraModel, board: Board, lens: str
) -> Solution:
    """Both cameras and the motion between them, from all that both see."""
    size = (left.width, left.height)
    objects = [board.points_m[view.ids] for view in views]
    pairs = [(view.left_px, view.right_px) for view in views]
    guess: list[Any] = [left.matrix.copy(), np.array(left.distortion)]
    guess += [right.matrix.copy(), np.array(right.distortion)]
    fit = _fit_fisheyes if lens == "fisheye" else _fit_pinholes
    try:
        K1, D1, K2, D2, R, T, rvecs, tvecs = fit(objects, pairs, guess, size, _flags(lens))
    except cv2.error:
        raise _no_solution("pair") from None
    left, right = (
        _camera(np.asarray(K), np.asarray(D), size, lens, f"{side} camera")
        for K, D, side in ((K1, D1, "left"), (K2, D2, "right"))
    )
    right_from_left = Pose(np.asarray(R, np.float64), np.asarray(T, np.float64).ravel())
    poses = [_pose(r, t) for r, t in zip(rvecs, tvecs, strict=True)]
    both = list(zip(poses, objects, pairs, strict=True))
    return Solution(
        left,
        right,
        right_from_left,
        views,
        poses,
        [_error_px(left, pose, p, q) for pose, p, (q, _) in both],
        [_error_px(right, right_from_left @ pose, p, q) for pose, p, (_, q) in both],
    )


def _fit_pinholes(
    objects: list[Points], pairs: list[Pair], guess: list[Any], size: tuple[int, int], flags: int
) -> tuple[Any, ...]:
    K1, D1, K2, D2 = guess
    fit = cv2.stereoCalibrateExtended(
        [p.astype(np.float32) for p in objects],
        [p.astype(np.float32) for p, _ in pairs],
        [p.astype(np.float32) for _, p in pairs],
        K1,
        D1,
        K2,
        D2,
        size,
        R=np.eye(3),
        T=np.zeros((3, 1)),
        flags=flags | cv2.CALIB_USE_INTRINSIC_GUESS,
        criteria=ITERATIONS,
    )
    return (*fit[1:7], *fit[9:11])


def _fit_fisheyes(
    objects: list[Points], pairs: list[Pair], guess: list[Any], size: tuple[int, int], flags: int
) -> tuple[Any, ...]:
    # OpenCV takes as many corners of each view: some count twice where boards are seen in part.
    most = max(map(len, objects))
    rows = [np.resize(np.arange(len(p)), most) for p in objects]
    K1, D1, K2, D2 = guess
    fit = cv2.fisheye.stereoCalibrate(
        [p[np.newaxis, row] for p, row in zip(objects, rows, strict=True)],
        [p[np.newaxis, row] for (p, _), row in zip(pairs, rows, strict=True)],
        [p[np.newaxis, row] for (_, p), row in zip(pairs, rows, strict=True)],
        K1,
        D1,
        K2,
        D2,
        size,
        flags=flags | _flag("CALIB_USE_INTRINSIC_GUESS"),
        criteria=ITERATIONS,
    )
    return tuple(fit[1:9])


def _camera(K: Array, D: Array, size: tuple[int, int], lens: str, name: str) -> CameraModel:
    count = 5 if lens == "pinhole5" else 4
    distortion = tuple(float(value) for value in D.ravel()[:count])
    model: Lens = "fisheye" if lens == "fisheye" else "pinhole"
    if not (np.isfinite(K).all() and np.isfinite(distortion).all() and K[0, 0] > 0.0 and K[1, 1] > 0.0):
        raise _no_solution(name)
    matrix = camera_matrix(*(float(K[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2))))
    return CameraModel(*size, matrix, distortion, model)


def _no_solution(name: str) -> InputError:
    return InputError("views", f"no {name} explains them: is --lens right, and is the board flat?")


def _pose(rvec: Any, tvec: Any) -> Pose:
    rotation = cv2.Rodrigues(np.asarray(rvec, np.float64))[0]
    return Pose(np.asarray(rotation, np.float64), np.asarray(tvec, np.float64).ravel())


def _error_px(camera: CameraModel, camera_from_board: Pose, points_m: Points, seen_px: Points) -> float:
    distances = project(camera, camera_from_board, points_m) - seen_px
    return float(np.sqrt(np.mean(np.sum(distances**2, axis=1))))
