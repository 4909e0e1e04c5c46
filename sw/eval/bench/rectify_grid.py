"""Rectification by a control grid beside OpenCV's with the exact map, on calibrations of real cameras.

usage: rectify_grid.py OUT.json

For each camera: how far the sources of the pixels lie from those of the exact map, how far the pixels lie
from those of cv2.remap with it, and the share of the pixels whose sources a line buffer of each depth holds.
The recordings are EuRoC V1_01 and the Bumblebee2 pairs of the shared data."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "model"))

from real_pairs import make_bumblebee2
from shared_data import SHARED_DATA
from vista.control_grid import BUFFER_ROWS, control_grid
from vista.geometry import Array, CameraModel
from vista.rectify import by_table, rectified_cameras
from vista.sequence import Sequence, open_sequence
from vista_eval.report.table import Table, write_measurement
from vista_model import row_beyond, sources
from vista_model.rectify import SCALE, Grid, reach

MAX_PAIRS = 20  # of a recording, evenly spread
SCENES = ["garden01", "garden02", "lantern01", "stones01", "sundial01", "wall01"]


def exact_sources_px(camera: CameraModel, R: Array, P: Array) -> NDArray[np.float32]:
    source = cv2.initUndistortRectifyMap(
        camera.matrix, np.array(camera.distortion), R, P, (camera.width, camera.height), cv2.CV_32FC1
    )
    return np.stack(source, -1)


def summary(errors: NDArray[np.float64], digits: int) -> dict[str, float]:
    found = {"mean": errors.mean(), "p99": np.percentile(errors, 99), "max": errors.max()}
    return {name: round(float(value), digits) for name, value in found.items()}


def served(grid: Grid, height: int, width: int) -> dict[str, dict[str, float | bool]]:
    """The service of line buffers, by their rows: the share of pixels that it serves, and whether it takes
    the whole grid."""
    y = sources(grid, height, width)[1] // SCALE - np.arange(height)[:, None]
    return {
        str(rows): {
            "share": round(float((np.abs(y) <= reach(rows)).mean()), 4),
            "accepted": row_beyond(grid, rows) is None,
        }
        for rows in BUFFER_ROWS
    }


def measure(name: str, sequence: Sequence) -> Iterator[dict[str, Any]]:
    raw = sequence.calibration
    count = min(MAX_PAIRS, len(sequence.frames))
    chosen = [sequence.frames[i * len(sequence.frames) // count] for i in range(count)]
    pairs = [sequence.read(files) for files in chosen]
    for side, (R, P) in zip(("left", "right"), rectified_cameras(raw), strict=True):
        camera: CameraModel = getattr(raw, side)
        grid = control_grid(camera, R, P, raw.source)
        exact_px = exact_sources_px(camera, R, P)
        x, y = sources(grid, camera.height, camera.width)
        away_px = np.hypot(*np.moveaxis(np.stack([x, y], -1) / SCALE - exact_px, -1, 0))
        rectify = by_table(grid)
        images = [getattr(pair, side) for pair in pairs]
        exact = [
            cv2.remap(image, exact_px, np.empty(0), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            for image in images
        ]
        grey = np.abs(np.stack([rectify(image) for image in images]).astype(np.int16) - np.stack(exact))
        dy = grid[..., 1] / SCALE
        yield {
            "camera": f"{name}, {side}",
            "size": [camera.width, camera.height],
            "images": count,
            "rows_away": [round(float(dy.min()), 1), round(float(dy.max()), 1)],
            "error_px": summary(away_px, 4),
            "error_grey": summary(grey, 3),
            "buffer_rows": served(grid, camera.height, camera.width),
        }


def table_of(cameras: list[dict[str, Any]]) -> Table:
    """Errors of a control grid against the exact map, and what line buffers of each depth serve."""

    def errors(found: dict[str, float], digits: int) -> str:
        return ", ".join(f"{found[key]:.{digits}f}" for key in ("mean", "p99", "max"))

    def share(found: dict[str, Any]) -> str:
        return f"{100 * found['share']:.1f} %" + ("" if found["accepted"] else ", refused")

    depths = list(cameras[0]["buffer_rows"])
    rows = [
        (
            one["camera"],
            errors(one["error_px"], 3),
            errors(one["error_grey"], 2),
            f"{one['rows_away'][0]:g} to {one['rows_away'][1]:g}",
            *(share(one["buffer_rows"][depth]) for depth in depths),
        )
        for one in cameras
    ]
    heads = ("camera", "error, px: mean, p99, max", "grey levels: mean, p99, max", "rows away")
    return Table("rectification-grid", (*heads, *(f"{depth} rows" for depth in depths)), rows)


def main(out: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        recordings = {
            "EuRoC V1_01": SHARED_DATA / "euroc_v101",
            "Bumblebee2": make_bumblebee2(Path(folder), SCENES),
        }
        rows = [row for name, place in recordings.items() for row in measure(name, open_sequence(place))]
    write_measurement(out, [table_of(rows)], {"cameras": rows})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
