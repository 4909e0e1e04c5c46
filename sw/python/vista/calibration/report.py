"""report.html of a calibration: one page with everything in it."""

from __future__ import annotations

import base64
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.calibration.advice import advice, corners, covered_share
from vista.calibration.calibrate import Calibrated
from vista.calibration.measure import distances_m, normals, row_errors, spread_deg
from vista.calibration.pictures import Picture
from vista.geometry import CameraModel
from vista.rectify import Rectifier
from vista.report.page import fill_template
from vista.report.palette import YELLOW
from vista.sequence.types import Frame

Data = dict[str, Any]

PICTURE_WIDTH_PX = 1280  # of both images together
LINES = 16  # across a pair of images
SHOWN_CORNERS = 3000  # in the drawing of the coverage


def render_report(made: Calibrated, title: str) -> str:
    raw_pair = _pair_picture(made.found.shown, None)
    return fill_template(
        "calibration_report.html.j2",
        title=title,
        made=made,
        facts=_facts(made),
        cards=_cards(made),
        advice=advice(made),
        cameras=[_camera("left", made.solution.left, made), _camera("right", made.solution.right, made)],
        pictures=[
            ("before rectification", raw_pair),
            ("after rectification", _pair_picture(made.found.shown, made)),
        ],
        views=_views(made),
        left_out=sorted(made.left_out.items()),
    )


def _facts(made: Calibrated) -> str:
    found, used = made.found, len(made.solution.views)
    poses = made.solution.left_from_board
    distances = distances_m(poses, made.board)
    return (
        f"{made.board.describe()}; {found.pictures} pairs of {found.size[0]}x{found.size[1]} px, of which "
        f"{'; '.join([f'{used} were used', *made.unused()])}; the board was {distances.min():.2f} to "
        f"{distances.max():.2f} m away and faced directions within {spread_deg(normals(poses)):.0f} degrees"
    )


def _cards(made: Calibrated) -> list[tuple[str, str, str]]:
    """(value, name, remark)."""
    before, after = made.before, made.after
    baseline_m = float(np.linalg.norm(made.solution.right_from_left.translation_m))
    check = "" if made.check is None else f"; {made.check.rms_px:.2f} px in views that were not used"
    return [
        (f"{made.solution.rms_px():.2f} px", "reprojection error", "root mean square of both cameras"),
        (
            f"{after.rms_px:.2f} px",
            "row error after rectification",
            f"95 % below {after.p95_px:.2f} px{check}",
        ),
        (f"{before.rms_px:.1f} px", "row error before", f"95 % below {before.p95_px:.1f} px"),
        (f"{1e3 * baseline_m:.2f} mm", "baseline", f"turned by {_turn_deg(made):.2f} degrees"),
    ]


def _turn_deg(made: Calibrated) -> float:
    return float(np.degrees(np.linalg.norm(cv2.Rodrigues(made.solution.right_from_left.rotation)[0])))


def _camera(side: str, camera: CameraModel, made: Calibrated) -> Data:
    K = camera.matrix
    solution = made.solution
    points_px = corners(made, side)
    step = max(1, len(points_px) // SHOWN_CORNERS)
    return {
        "name": side,
        "width": camera.width,
        "height": camera.height,
        "points": [(round(float(u), 1), round(float(v), 1)) for u, v in points_px[::step]],
        "covered": f"{100 * covered_share(made, side):.0f}",
        "rms": f"{solution.rms_of_px(side):.3f}",
        "focal": f"{K[0, 0]:.2f}, {K[1, 1]:.2f}",
        "center": f"{K[0, 2]:.2f}, {K[1, 2]:.2f}",
        "lens": camera.lens,
        "distortion": ", ".join(f"{value:.5g}" for value in camera.distortion),
    }


def _views(made: Calibrated) -> list[Data]:
    solution = made.solution
    rows = zip(
        solution.views,
        solution.left_errors_px,
        solution.right_errors_px,
        row_errors(solution.views, None).of_views_px,
        made.after.of_views_px,
        distances_m(solution.left_from_board, made.board),
        strict=True,
    )
    names = ("left", "right", "before", "after", "distance")
    return [
        {"name": view.name, "corners": len(view.ids), **dict(zip(names, figures, strict=True))}
        for view, *figures in rows
    ]


def _pair_picture(shown: Picture | None, made: Calibrated | None) -> str:
    """Both images side by side with lines along the rows, as a data URI; made: rectifies them."""
    assert shown is not None  # there is a view, so there is a picture of it
    left, right = shown.left, shown.right
    if made is not None:
        frame = Rectifier(made.raw).rectify(Frame(0, 0, left, right, None))
        left, right = frame.left, frame.right
    both = cv2.cvtColor(np.hstack([left, right]), cv2.COLOR_GRAY2BGR)
    scale = min(1.0, PICTURE_WIDTH_PX / both.shape[1])
    both = cv2.resize(both, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    for row in np.linspace(0, both.shape[0] - 1, LINES + 2)[1:-1].round().astype(int):
        both[row] = YELLOW
    return _data_uri(np.asarray(both, np.uint8))


def _data_uri(picture: NDArray[np.uint8]) -> str:
    jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 85])[1].tobytes()
    return "data:image/jpeg;base64," + base64.b64encode(jpeg).decode()
