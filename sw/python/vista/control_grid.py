"""Rectification as hardware does it: by a control grid, to the bit of doc/design/engine-contract.md."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vista import native
from vista.errors import InputError
from vista.geometry import Array, CameraModel

Grid = NDArray[np.int16]  # rows and columns of control points, and (dx, dy) in 1/32 px
Filter = Callable[[NDArray[np.uint8]], NDArray[np.uint8]]

BUFFER_ROWS = (16, 32, 64, 128)  # of the line buffers that the hardware can be built with


@dataclass(frozen=True)
class GridPair:
    """The map of a pair of cameras: what hardware loads that rectifies."""

    left: Grid
    right: Grid
    size: tuple[int, int]  # width and height of the images, px
    buffer_rows: int  # of the line buffer that holds what the map needs


def control_grid(camera: CameraModel, R: Array, P: Array, source: str) -> Grid:
    """Samples the exact map at the control points, some beyond the image.

    R, P: of the rectified camera, as cv2.stereoRectify gives them.
    source: the file of the calibration. InputError when a source is too far away for the grid's numbers.
    """
    import cv2  # slow to load; not all who name a grid make one

    from vista.lens import rectifying_map

    _, lib = native.load("vista_engine")
    step = lib.VISTA_FRONTEND_GRID_STEP_PX
    sides = (lib.vista_frontend_grid_points(side) for side in (camera.width, camera.height))
    width, height = (step * (points - 1) + 1 for points in sides)
    source_px = rectifying_map(camera, R, P, (width, height), cv2.CV_32FC1)
    own_px = np.meshgrid(np.arange(0, width, step), np.arange(0, height, step))
    offsets_px = np.stack(source_px, -1)[::step, ::step].astype(np.float64) - np.stack(own_px, -1)
    offsets = np.rint(offsets_px * lib.VISTA_FRONTEND_GRID_SCALE)
    limits = np.iinfo(np.int16)
    if not ((offsets >= limits.min) & (offsets <= limits.max)).all():  # nan counts as too far
        farthest_px = -limits.min // lib.VISTA_FRONTEND_GRID_SCALE
        reason = f"cannot be rectified by a control grid: moves pixels by {farthest_px} px or more"
        raise InputError(source, reason)
    return np.asarray(offsets, np.int16)


def check_rows(grid: Grid, size: tuple[int, int], buffer_rows: int, culprit: str) -> None:
    """InputError when a line buffer of so many rows does not hold what the grid needs."""
    ffi, lib = native.load("vista_engine")
    points = ffi.from_buffer("vista_frontend_offset[]", grid)
    row = lib.vista_frontend_row_beyond(points, *size, buffer_rows)
    if row >= 0:
        dy = grid[row // lib.VISTA_FRONTEND_GRID_STEP_PX, :, 1]
        away_px = float(np.abs(dy).max()) / lib.VISTA_FRONTEND_GRID_SCALE
        raise InputError(
            culprit,
            f"cannot be rectified with a line buffer of {buffer_rows} rows: row {row} needs pixels "
            f"{away_px:.0f} rows away",
        )
