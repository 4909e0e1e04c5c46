"""The checks, each a function of what it judges: a Finding where something is wrong, else None.

They judge what needs matched features, and the calibration. Everything else libvista judges itself
(sw/src/detector/findings.c, sw/src/health/health.h).

The limits lie between what real recordings show and what damaged ones show; sw/tests/test_health_real.py
measures both.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vista.geometry import CameraModel, RawCalibration
from vista.health.features import PairMatches
from vista.health.finding import Finding, Reason, State

# ---- of the calibration, once ----

BASELINE_M = (0.01, 5.0)
CENTER_OFFSET = 0.12  # of the principal point from the centre of the image, as a share of its side
FIELD_OF_VIEW_DEG = (15.0, 130.0)  # horizontal
FISHEYE_FIELD_OF_VIEW_DEG = (30.0, 240.0)


def check_baseline(calibration: RawCalibration) -> Finding | None:
    """Cameras on a vehicle are some centimetres to some metres apart."""
    baseline_m = float(np.linalg.norm(calibration.right_from_left.translation_m))
    lowest, highest = BASELINE_M
    if lowest <= baseline_m <= highest:
        return None
    question = ": is it in millimetres?" if baseline_m > highest else ""
    return Finding(
        Reason.BASELINE_IMPLAUSIBLE,
        State.DEGRADED,
        f"the baseline is {baseline_m:g} m, expected {lowest:g} to {highest:g} m{question}",
    )


def check_calibration(calibration: RawCalibration) -> Finding | None:
    """The principal point lies near the centre of the image, and the field of view is that of a lens."""
    for side, camera in (("left", calibration.left), ("right", calibration.right)):
        problem = _camera_problem(camera)
        if problem is not None:
            question = "does the calibration belong to images of another size?"
            return Finding(Reason.CALIBRATION_MISFIT, State.DEGRADED, f"{side} camera: {problem}: {question}")
    return None


def _camera_problem(camera: CameraModel) -> str | None:
    center_px = np.array([(camera.width - 1) / 2.0, (camera.height - 1) / 2.0])
    principal_px = camera.matrix[:2, 2]
    offset = np.abs(principal_px - center_px) / [camera.width, camera.height]
    if offset.max() > CENTER_OFFSET:
        cx, cy = principal_px
        return (
            f"principal point ({cx:.0f}, {cy:.0f}), far from the centre of {camera.width}x{camera.height} px"
        )
    half = 0.5 * camera.width / float(camera.matrix[0, 0])  # of the width, in focal lengths
    is_fisheye = camera.lens == "fisheye"
    view_deg = 2.0 * math.degrees(half if is_fisheye else math.atan(half))
    lowest, highest = FISHEYE_FIELD_OF_VIEW_DEG if is_fisheye else FIELD_OF_VIEW_DEG
    if not lowest <= view_deg <= highest:
        return f"field of view {view_deg:.0f} degrees wide"
    return None


# ---- of the matched features of a rectified pair ----

MIN_CANDIDATES = 40  # with fewer, nothing is said
MIN_AGREEING = 20
AGREEING_SHARE = 0.25  # of the candidates, whose surroundings agree
ROW_SPREAD_PX = 0.7  # median deviation of the row errors from their median
ROW_ERROR_PX = (1.0, 2.0)  # median row error: degraded, blind
NEGATIVE_PX = -1.0
NEGATIVE_SHARE = (0.5, 0.95)  # where the rows match, and where swapped images were rectified wrongly


def check_pair(matches: PairMatches) -> Finding | None:
    """Matching features lie on one row, with a disparity that is not negative."""
    rows = matches.near_rows()
    agreeing = len(rows)
    if matches.candidates < MIN_CANDIDATES:
        return None
    if agreeing < AGREEING_SHARE * matches.candidates:
        return _unrelated(f"only {agreeing} of {matches.candidates} matched features look alike")
    if agreeing < MIN_AGREEING:
        return None
    error_px = float(np.median(rows))
    spread_px = float(np.median(np.abs(rows - error_px)))
    negative = float(np.mean(matches.disparity_px < NEGATIVE_PX))
    in_rows = spread_px <= ROW_SPREAD_PX and abs(error_px) <= ROW_ERROR_PX[0]
    if negative > (NEGATIVE_SHARE[0] if in_rows else NEGATIVE_SHARE[1]):
        text = f"{100 * negative:.0f} % of the disparities of matched features are negative"
        return Finding(Reason.LEFT_RIGHT_SWAPPED, State.BLIND, f"{text}: are left and right swapped?")
    if spread_px > ROW_SPREAD_PX:
        return _unrelated(f"the row errors of matched features scatter by {spread_px:.1f} px")
    if abs(error_px) > ROW_ERROR_PX[0]:
        state = State.BLIND if abs(error_px) > ROW_ERROR_PX[1] else State.DEGRADED
        text = f"matching features lie {error_px:+.1f} px apart in rows: does the calibration fit?"
        return Finding(Reason.ROWS_MISALIGNED, state, text)
    return None


def _unrelated(text: str) -> Finding:
    question = "do left and right image, in this order, show one moment?"
    return Finding(Reason.MOMENTS_DIFFER, State.BLIND, f"{text}: {question}")


# ---- of the motion ----

MOVING_PX = 1.0  # median motion of the features from one frame to the next
MIN_FOLLOWED = 20


def check_image_motion(motion_px: NDArray[np.float64]) -> Finding | None:
    """motion_px: of features from one frame to the next, for which no pose is given."""
    if len(motion_px) < MIN_FOLLOWED or (median_px := float(np.median(motion_px))) <= MOVING_PX:
        return None
    text = f"the image moves by {median_px:.1f} px a frame, but no poses are given"
    advice = "tracks and warnings mean little; --poses odometry estimates poses from the images"
    return Finding(Reason.MOTION_UNKNOWN, State.DEGRADED, f"{text}: {advice}")
