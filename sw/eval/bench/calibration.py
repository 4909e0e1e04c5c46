"""What `vista calibrate` finds of rendered rigs whose lenses are exactly known.

usage: calibration.py OUT.json [SETS]

Each case is rendered SETS times (3 unless told otherwise) with other poses of the board and other noise;
rigs, boards and renderer are those of sw/tests/board_rig.py."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

from board_rig import (
    Conditions,
    board_poses,
    exact_row_errors_px,
    far_disparities_px,
    fisheye_rig,
    pinhole_rig,
    render_pairs,
    turn_deg,
)
from vista.calibration.board import parse_board
from vista.calibration.calibrate import calibrate
from vista.calibration.pictures import Picture
from vista.geometry import RawCalibration
from vista_eval.report.table import Table, span, write_measurement

PAIRS = 24
CHESSBOARD, CHARUCO = "chessboard:9x6:50", "charuco:9x6:60:44:5X5_250"
GOOD = Conditions()
DIM = Conditions(noise=4.0, blur_px=0.8, shade=0.85, contrast=0.6)


def strong_rig() -> RawCalibration:
    """A lens of its own: k3, wide, 848x480, and a camera that is turned by 2.5 degrees."""
    rig = pinhole_rig((848, 480))
    lenses = []
    for camera, k in (
        (rig.left, (-0.25, 0.09, 0.0003, 0.0005, -0.015)),
        (rig.right, (-0.24, 0.085, -0.0004, 0.0, -0.014)),
    ):
        matrix = camera.matrix.copy()
        matrix[0, 0] *= 0.72
        matrix[1, 1] *= 0.72
        lenses.append(replace(camera, matrix=matrix, distortion=k))
    turn = np.asarray(cv2.Rodrigues(np.radians([1.2, -1.5, 1.6]))[0], np.float64)
    motion = replace(rig.right_from_left, rotation=turn, translation_m=np.array([-0.2, 0.004, 0.006]))
    return replace(rig, left=lenses[0], right=lenses[1], right_from_left=motion)


@dataclass(frozen=True)
class Case:
    name: str
    rig: RawCalibration
    board: str
    lens: str
    fill: float = 0.32
    conditions: Conditions = GOOD


CASES = (
    Case("pinhole, chessboard", pinhole_rig(), CHESSBOARD, "pinhole"),
    Case("pinhole, parts of a ChArUco board", pinhole_rig(), CHARUCO, "pinhole", 0.7),
    Case("pinhole, chessboard in bad light", pinhole_rig(), CHESSBOARD, "pinhole", 0.32, DIM),
    Case("fisheye, chessboard", fisheye_rig(), CHESSBOARD, "fisheye", 0.4),
    Case("fisheye, parts of a ChArUco board", fisheye_rig(), CHARUCO, "fisheye", 0.7),
    Case("fisheye, ChArUco board in bad light", fisheye_rig(), CHARUCO, "fisheye", 0.7, DIM),
    Case("wide pinhole with k3, turned 2.5 degrees, 848x480", strong_rig(), CHESSBOARD, "pinhole5", 0.36),
    Case("the same, calibrated without k3", strong_rig(), CHESSBOARD, "pinhole", 0.36),
)


def measure(case: Case, seed: int) -> dict[str, float]:
    random = np.random.default_rng([seed, 14])
    board = parse_board(case.board)
    poses = board_poses(case.rig, board, PAIRS, random, fill=case.fill)
    pairs = render_pairs(case.rig, board, poses, random, lambda _: case.conditions)
    start = time.monotonic()
    made = calibrate([Picture(str(i), *pair) for i, pair in enumerate(pairs)], board, case.lens)
    seconds = time.monotonic() - start
    found, true = made.raw, case.rig
    cameras = [(found.left, true.left), (found.right, true.right)]
    focal = [abs(float(a.matrix[i, i] / b.matrix[i, i]) - 1.0) for a, b in cameras for i in (0, 1)]
    center_px = [np.linalg.norm(a.matrix[:2, 2] - b.matrix[:2, 2]) for a, b in cameras]
    baselines = [float(np.linalg.norm(raw.right_from_left.translation_m)) for raw in (found, true)]
    errors_px, far_px = exact_row_errors_px(found, true), far_disparities_px(found, true)
    return {
        "views": len(made.solution.views),
        "reprojection_px": made.solution.rms_px(),
        "focal_percent": 100.0 * max(focal),
        "center_px": float(max(center_px)),
        "baseline_percent": 100.0 * abs(baselines[0] / baselines[1] - 1.0),
        "turn_deg": turn_deg(found, true),
        "rows_before_px": made.before.rms_px,
        "rows_after_px": made.after.rms_px,
        "exact_rows_px": float(np.sqrt(np.mean(errors_px**2))),
        "exact_rows_worst_px": float(np.abs(errors_px).max()),
        "far_disparity_px": float(np.sqrt(np.mean(far_px**2))),
        "seconds": seconds,
    }


STATED = {  # in the documentation: what a calibration found against the truth
    "focal_percent": "focal length (%)",
    "center_px": "principal point (px)",
    "baseline_percent": "baseline (%)",
    "turn_deg": "turn (degrees)",
    "rows_before_px": "rows before (px)",
    "exact_rows_px": "rows after (px)",
    "exact_rows_worst_px": "worst (px)",
    "far_disparity_px": "disparity (px)",
}


def table_of(rows: list[dict[str, Any]]) -> Table:
    cells = [
        (row["case"], *(span([float(f"{value:.2g}") for value in row[key]]) for key in STATED))
        for row in rows
    ]
    return Table("calibration", ("case", *STATED.values()), cells)


def main(out: Path, sets: int) -> None:
    rows: list[dict[str, Any]] = []
    for case in CASES:
        found = [measure(case, seed) for seed in range(sets)]
        ranges = {key: [min(one[key] for one in found), max(one[key] for one in found)] for key in found[0]}
        rounded = {key: [float(f"{value:.3g}") for value in ends] for key, ends in ranges.items()}
        rows.append({"case": case.name, "sets": sets, "pairs": PAIRS, **rounded})
        print(rows[-1], flush=True)
    write_measurement(out, [table_of(rows)], {"rows": rows})


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 3)
