"""How far level directions are called free, against true disparities of the same frame.

direction   a column of one degree that libvista tells of, whose middle is in the matched part of the image;
            of measured pairs, if LEAST_POINTS of its points were measured
nearest     level distance of the nearest true point of a direction, no higher above nor farther below the
            camera than RIM of the collision volume's radius; of measured pairs, of what stands on the road
clear       nothing within that radius is nearer than CLEAR_M. Asked is that FREE_M are called free
through     something is within ASKED_M, and the direction is called free THROUGH_M and the depth of one
            disparity beyond it, or farther
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from vista.geometry import Array, Calibration
from vista.pipeline import Directions

from vista_eval.metrics.flight_path import CYLINDER_RADIUS_M
from vista_eval.report.table import Table

CLEAR_M, FREE_M = 45.0, 40.0
ASKED_M, THROUGH_M = 60.0, 2.0
RIM = 0.8
LEAST_POINTS = 10
TOLD_M = (0.0, 10.0, 20.0, 40.0, np.inf)  # directions by how far they are called free


@dataclass(frozen=True)
class FreeDirections:
    """Directions of one frame, or of many."""

    clear: int = 0
    clear_free: int = 0
    asked: int = 0
    through: int = 0
    told: tuple[int, ...] = (0,) * (len(TOLD_M) - 1)  # by TOLD_M
    nearer: tuple[int, ...] = (0,) * (len(TOLD_M) - 1)  # of these, called free through something


NO_DIRECTIONS = FreeDirections()


def free_directions(
    told: Directions,
    camera: Calibration,
    disparity_px: NDArray[np.float32],
    area: tuple[slice, slice],
    counts: NDArray[np.bool_] | None = None,
) -> FreeDirections:
    """disparity_px: 0 where none is known. counts: the pixels of what is in the way, where the truth has only
    some of all pixels; None: it has all of them, and every surface is."""
    v, u = np.nonzero(disparity_px > 0.0)
    depth_m = camera.focal_px * camera.baseline_m / disparity_px[v, u].astype(np.float64)
    points_m = depth_m[:, None] * np.column_stack(
        [(u - camera.cx) / camera.focal_px, (v - camera.cy) / camera.focal_px, np.ones(len(u))]
    )
    up = np.array(told.up_camera, np.float64)
    ahead = np.array([0.0, 0.0, 1.0]) - up[2] * up
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, up)
    column = np.floor(np.degrees(np.arctan2(points_m @ right, points_m @ ahead))).astype(np.int64)
    column -= Directions.FIRST_DEG
    level_m, above_m = np.hypot(points_m @ right, points_m @ ahead), np.abs(points_m @ up)
    stands = np.ones(len(u), np.bool_) if counts is None else counts[v, u]
    known = in_area(camera, area, ahead, right)
    if counts is not None:
        known &= np.bincount(column, minlength=Directions.COLUMNS) >= LEAST_POINTS
    within_m, nearest_m = (
        nearest(column, level_m, stands & (above_m <= share * CYLINDER_RADIUS_M)) for share in (1.0, RIM)
    )
    dz_m = nearest_m**2 / (camera.focal_px * camera.baseline_m)
    free_m = np.array(list(told.free_m), np.float64)
    with np.errstate(invalid="ignore"):
        through = known & (free_m >= nearest_m + np.maximum(THROUGH_M, dz_m))
    clear, asked = known & (within_m > CLEAR_M), known & (nearest_m <= ASKED_M)
    band = np.searchsorted(TOLD_M, free_m, side="left") - 1  # -1: not called free at all
    bands = range(len(TOLD_M) - 1)
    return FreeDirections(
        int(clear.sum()),
        int((clear & (free_m >= FREE_M)).sum()),
        int(asked.sum()),
        int((asked & through).sum()),
        tuple(int((known & (band == k)).sum()) for k in bands),
        tuple(int((through & (band == k)).sum()) for k in bands),
    )


def nearest(column: NDArray[np.int64], level_m: Array, chosen: NDArray[np.bool_]) -> Array:
    found = np.full(Directions.COLUMNS, np.inf)
    np.minimum.at(found, column[chosen], level_m[chosen])
    return found


def in_area(camera: Calibration, area: tuple[slice, slice], ahead: Array, right: Array) -> NDArray[np.bool_]:
    """Whether the middle of each column, level and far away, is in this part of the image."""
    azimuth = np.radians(Directions.FIRST_DEG + np.arange(Directions.COLUMNS) + 0.5)
    ray = np.cos(azimuth)[:, None] * ahead + np.sin(azimuth)[:, None] * right
    before = ray[:, 2] > 0.0
    depth = np.where(before, ray[:, 2], 1.0)
    u = camera.cx + camera.focal_px * ray[:, 0] / depth
    v = camera.cy + camera.focal_px * ray[:, 1] / depth
    rows, columns = area
    inside = (u >= columns.start) & (u < columns.stop) & (v >= rows.start) & (v < rows.stop)
    return np.asarray(before & inside)


def together(frames: Iterable[FreeDirections]) -> FreeDirections:
    total = NO_DIRECTIONS
    for one in frames:
        total = FreeDirections(
            total.clear + one.clear,
            total.clear_free + one.clear_free,
            total.asked + one.asked,
            total.through + one.through,
            tuple(a + b for a, b in zip(total.told, one.told, strict=True)),
            tuple(a + b for a, b in zip(total.nearer, one.nearer, strict=True)),
        )
    return total


def share(part: int, whole: int) -> str:
    return f"{part / whole:.3f} of {whole}" if whole else ""


def table(of: str, rows: Sequence[tuple[str, FreeDirections]]) -> Table:
    """A row for each: a family, or a half of measured pairs."""
    names = [f"to {high:g} m" if np.isfinite(high) else f"over {low:g} m" for low, high in pairwise(TOLD_M)]
    return Table(
        "directions",
        (of, f"clear, free {FREE_M:g} m", "free through", *(f"{name}: nearer" for name in names)),
        [
            (
                name,
                share(one.clear_free, one.clear),
                share(one.through, one.asked),
                *(share(near, told) for near, told in zip(one.nearer, one.told, strict=True)),
            )
            for name, one in rows
        ],
        "Shares of directions, of one degree each. In the columns are: called free for "
        f"{FREE_M:g} m, of those with nothing in them for {CLEAR_M:g} m; called free {THROUGH_M:g} m "
        "and the depth of one disparity beyond something, of those with something in them within "
        f"{ASKED_M:g} m; and the same of those that are called free up to a distance.",
        "How far directions are free",
    )
