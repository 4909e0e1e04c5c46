"""The calibration of a pair from pictures of a board, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from vista.calibration.board import MIN_CORNERS, Board, Sighting, aligned
from vista.calibration.measure import RowErrors, normals, row_errors, spread_deg
from vista.calibration.pictures import Picture
from vista.calibration.solve import Solution, solve_pair
from vista.calibration.views import MIN_VIEWS, Found, View, find_views, other_board, spread_views
from vista.errors import InputError
from vista.geometry import RawCalibration
from vista.rectify import Rectifier

MIN_SPREAD_DEG = 10.0  # between the directions that the board faced; less leaves the focal length open
MAX_RMS_PX = 1.5  # of a pair 640 px wide; more is no calibration
SOURCE = "calibration"


@dataclass(frozen=True)
class Calibrated:
    """The calibration of a pair, and all that the report says about it."""

    board: Board
    found: Found
    solution: Solution
    left_out: dict[str, str]  # views that did not agree, and by how much
    raw: RawCalibration
    before: RowErrors
    after: RowErrors
    check: RowErrors | None  # of views that the calibration was not made with, if there are any

    def unused(self) -> list[str]:
        """Why pairs are not among the views that were used: a count and a reason each, every pair once."""
        found = self.found
        likes = len(found.views) - len(self.solution.views) - len(self.left_out)
        shown = len(found.views) + found.left_only + found.right_only + found.few_common
        counts = {
            "in disagreement with the others": len(self.left_out),
            "like others that were used": likes,
            "with the board in the left image only": found.left_only,
            "with the board in the right image only": found.right_only,
            f"with fewer than {MIN_CORNERS} corners in common": found.few_common,
            "with the board in neither image": found.pictures - shown,
        }
        return [f"{count} {reason}" for reason, count in counts.items() if count]


def calibrate(pictures: Iterable[Picture], board: Board, lens: str) -> Calibrated:
    """Raises InputError for what cannot be calibrated."""
    found = find_views(pictures, board)
    _check_enough(found, board)
    chosen = spread_views(found.views, board, found.size)
    if len(chosen) < MIN_VIEWS:
        reason = f"the {len(found.views)} that show the board in both images are nearly the same"
        raise InputError("views", f"{reason}; hold it in other places, nearer, farther and tilted")
    try:
        solution, left_out = solve_pair(chosen, board, found.size, lens)
    except InputError:
        _check_mirrored(chosen, board, found.size, lens)
        raise
    _check_orientations(solution)
    raw = RawCalibration(solution.left, solution.right, solution.right_from_left, SOURCE)
    _check_sides(raw)
    _check_fit(chosen, solution, board, lens)
    Rectifier(raw)  # raises InputError if this pair cannot be rectified
    names = {view.name for view in chosen}
    others = [view for view in found.views if view.name not in names]
    return Calibrated(
        board,
        found,
        solution,
        left_out,
        raw,
        row_errors(solution.views, None),
        row_errors(solution.views, raw),
        row_errors(others, raw) if others else None,
    )


def _check_enough(found: Found, board: Board) -> None:
    count = len(found.views)
    if count >= MIN_VIEWS:
        return
    if count == 0 and (found.left_only or found.right_only):
        seen = f"the left camera sees it in {found.left_only}, the right one in {found.right_only}"
        raise InputError(
            "views",
            f"no pair shows the board in both images ({seen} of {found.pictures} pairs)"
            f"{other_board(board, found.without)}",
        )
    raise InputError(
        "views",
        f"{count} of {found.pictures} pairs show at least {MIN_CORNERS} corners of the board in both images, "
        f"at least {MIN_VIEWS} are needed (left image only: "
        f"{found.left_only}, right image only: {found.right_only}){other_board(board, found.without)}",
    )


def _check_orientations(solution: Solution) -> None:
    spread = spread_deg(normals(solution.left_from_board))
    if spread < MIN_SPREAD_DEG:
        raise InputError(
            "views",
            f"the board faces one direction in all of them (within {spread:.0f} degrees), which leaves the "
            "focal length open; tilt it by 20 to 45 degrees to all sides",
        )


def _check_sides(raw: RawCalibration) -> None:
    x, y, z = raw.right_from_left.inverse().translation_m
    if x < 0.0 and abs(x) > max(abs(y), abs(z)):
        raise InputError(
            "views",
            f"the right camera lies {abs(x):.3g} m to the left of the left one: left and right are swapped, "
            "or the images are mirrored",
        )


def _check_fit(views: list[View], solution: Solution, board: Board, lens: str) -> None:
    size = (solution.left.width, solution.left.height)
    limit_px = MAX_RMS_PX * max(1.0, size[0] / 640.0)
    rms_px = solution.rms_px()
    if rms_px <= limit_px:
        return
    _check_mirrored(views, board, size, lens)
    raise InputError(
        "views",
        f"the corners lie {rms_px:.1f} px (rms) from where the cameras should see them, at most "
        f"{limit_px:.1f} is accepted: is --lens right, the board flat, and each pair taken at one moment?",
    )


def _check_mirrored(views: list[View], board: Board, size: tuple[int, int], lens: str) -> None:
    """A chessboard looks right in a mirror, but then only one image of a pair unmirrored fits the other."""
    if board.markers:
        return
    unmirrored = [_right_mirrored(view, board, size[0]) for view in views]
    try:
        solution, _ = solve_pair(unmirrored, board, size, lens)
    except InputError:
        return
    if solution.rms_px() < MAX_RMS_PX:
        raise InputError("views", "one camera sees the board as in a mirror: its images are mirrored")


def _right_mirrored(view: View, board: Board, width: int) -> View:
    columns, rows = board.grid
    points_px = view.right_px.copy()
    points_px[:, 0] = width - 1 - points_px[:, 0]
    net = points_px.reshape(rows, columns, 2)[:, ::-1]  # numbered as a board that is seen from its front
    right = aligned(Sighting(view.ids, net.reshape(-1, 2)), Sighting(view.ids, view.left_px), board)
    return replace(view, right_px=right.points_px)
