"""Maps of rectification for the benches: random control grids and their words."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from vista_model import grid_shape
from vista_model.rectify import reach

Grids = npt.NDArray[np.int16]  # camera, row and column of the control point, (dx, dy)


def random_grids(rng: np.random.Generator, buffer_rows: int, height: int, width: int) -> Grids:
    """Draws grids of both cameras: smooth, rough or extreme, at both ends of what the line buffer reaches."""
    shape = (2, *grid_shape(height, width), 2)
    lowest, highest = -32 * reach(buffer_rows), 32 * reach(buffer_rows) + 31
    grids = np.empty(shape, np.int16)
    kind = rng.integers(4)
    if kind == 0:
        grids[..., 0] = rng.integers(-32768, 32768, shape[:-1])
        grids[..., 1] = rng.integers(lowest, highest + 1, shape[:-1])
    elif kind == 1:
        grids[..., 0] = rng.choice([-32768, 32767, 0], shape[:-1])
        grids[..., 1] = rng.choice([lowest, highest], shape[:-1])
    elif kind == 2:
        grids[:] = rng.integers(-70, 71, shape)
    else:
        grids[..., 0] = rng.integers(-900, 901) + rng.integers(-20, 21, shape[:-1])
        grids[..., 1] = np.clip(
            rng.integers(lowest, highest) + rng.integers(-9, 10, shape[:-1]), lowest, highest
        )
    return grids


def words_of(grids: Grids) -> list[int]:
    """{dy, dx} row by row, the left camera first."""
    words = grids.view(np.uint16).astype(np.int64) @ np.array([1, 1 << 16])
    return [int(word) for word in words.ravel()]
