"""Disparities as points in space, and the PLY files that hold them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vista.engine import SCALE
from vista.geometry import Calibration
from vista.output import write_atomically

SUFFIX = ".ply"
VERTEX = np.dtype([(axis, "<f4") for axis in "xyz"] + [(colour, "u1") for colour in ("red", "green", "blue")])


def points_of(words: NDArray[np.int16], left: NDArray[np.uint8], camera: Calibration) -> NDArray[np.void]:
    """A point for each pixel with a disparity above 0, in metres in the frame of the left camera (x to the
    right, y down, z forward), with the grey value of the pixel. words: (height, width), 1/16 px."""
    rows, columns = np.nonzero(words > 0)
    z_m = camera.focal_px * camera.baseline_m * SCALE / words[rows, columns]
    points = np.empty(len(rows), VERTEX)
    points["x"] = (columns - camera.cx) / camera.focal_px * z_m
    points["y"] = (rows - camera.cy) / camera.focal_px * z_m
    points["z"] = z_m
    for colour in ("red", "green", "blue"):
        points[colour] = left[rows, columns]
    return points


def write_ply(path: Path, points: NDArray[np.void]) -> None:
    """Binary, little-endian. The file is whole or absent. Raises InputError."""
    kinds = {"<f4": "float", "|u1": "uchar"}
    properties = [f"property {kinds[VERTEX[name].str]} {name}" for name in VERTEX.names or ()]
    head = ["ply", "format binary_little_endian 1.0", "comment metres; x right, y down, z forward"]
    lines = [*head, f"element vertex {len(points)}", *properties, "end_header", ""]
    write_atomically(path, "\n".join(lines).encode() + points.tobytes())
