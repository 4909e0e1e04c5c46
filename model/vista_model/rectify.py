"""Rectification by a control grid, as doc/design/engine-contract.md puts it.

A grid holds, for every 16th column and row of the output, how far away its pixel is taken from: (dx, dy) in
1/32 px. It is an int16 array of ceil(H/16)+1 rows, ceil(W/16)+1 columns and these two.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vista_model.engine import Image, Ints

STEP_PX = 16  # from one control point to the next
SCALE = 32  # of offsets: units a pixel
BUFFER_ROWS = (16, 32, 64, 128)  # what a line buffer can be built with
SPARE_ROWS = 2  # of the line buffer: one that is being written, one that keeps both sides from waiting

Grid = npt.NDArray[np.int16]


def grid_shape(height: int, width: int) -> tuple[int, int]:
    """Rows and columns of control points; the last ones lie on or beyond the image's far edges."""
    return -(-height // STEP_PX) + 1, -(-width // STEP_PX) + 1


def offsets(grid: Grid, height: int, width: int) -> Ints:
    """The offset of every pixel, height x width x 2: bilinear, and half rounded up once."""
    points = grid.astype(np.int32)
    (row, j), (column, i) = (divmod(np.arange(side, dtype=np.int32), STEP_PX) for side in (height, width))
    j, i = j[:, None, None], i[None, :, None]
    between_rows = (STEP_PX - j) * points[row] + j * points[row + 1]
    between = (STEP_PX - i) * between_rows[:, column] + i * between_rows[:, column + 1]
    return (between + 128) >> 8


def sources(grid: Grid, height: int, width: int) -> tuple[Ints, Ints]:
    """Places that the pixels are taken from, X and Y in 1/32 px, inside the image."""
    offset = offsets(grid, height, width)
    x = np.arange(width, dtype=np.int32)[None, :] * SCALE + offset[..., 0]
    y = np.arange(height, dtype=np.int32)[:, None] * SCALE + offset[..., 1]
    return x.clip(0, (width - 1) * SCALE), y.clip(0, (height - 1) * SCALE)


def rectify(image: Image, grid: Grid) -> Image:
    """The pixels of the output, interpolated between the four around their sources."""
    height, width = image.shape
    x, y = sources(grid, height, width)
    (column, fx), (row, fy) = divmod(x, SCALE), divmod(y, SCALE)
    right, below = np.minimum(column + 1, width - 1), np.minimum(row + 1, height - 1)
    pixels = image.astype(np.int32)
    above = (SCALE - fx) * pixels[row, column] + fx * pixels[row, right]
    under = (SCALE - fx) * pixels[below, column] + fx * pixels[below, right]
    return (((SCALE - fy) * above + fy * under + 512) >> 10).astype(np.uint8)


def reach(buffer_rows: int) -> int:
    """How many rows above its own, and below, a line buffer of so many rows lets a pixel be taken from: it
    holds the rows from that many above to one more than that many below, and the spare ones."""
    return (buffer_rows - SPARE_ROWS) // 2 - 1


def row_beyond(grid: Grid, buffer_rows: int) -> int | None:
    """The first row of the output with a control point that such a line buffer does not reach, if any.

    Offsets between control points lie between theirs, so no pixel needs more than they do."""
    rows = grid[..., 1].astype(np.int32) // SCALE
    beyond = np.flatnonzero((np.abs(rows) > reach(buffer_rows)).any(axis=1))
    return int(beyond[0]) * STEP_PX if len(beyond) else None
