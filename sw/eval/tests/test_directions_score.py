"""How far directions are called free, against views whose truth is known by hand."""

from __future__ import annotations

import numpy as np
import pytest
from vista.geometry import Calibration
from vista.pipeline import Directions
from vista_eval.metrics.free_directions import FreeDirections, free_directions, table, together

CAMERA = Calibration(640, 480, 500.0, 319.5, 239.5, 0.5)
AREA = slice(5, 475), slice(5, 635)
SEEN = 64  # columns of which the middle is in the area: 32.2 degrees to each side


def told(free_m: float, up=(0.0, -1.0, 0.0)) -> Directions:
    return Directions.made().but(
        free_m=np.full(Directions.COLUMNS, free_m, np.float32), up_camera=np.array(up)
    )


def wall(z_m: float) -> np.ndarray:
    """Lies on the left of the image; sky beside it."""
    disparity_px = np.zeros((480, 640), np.float32)
    disparity_px[:, :320] = CAMERA.focal_px * CAMERA.baseline_m / z_m
    return disparity_px


@pytest.mark.parametrize(
    ("free_m", "clear_free", "through"),
    [(0.0, 0, 0), (15.0, 0, 0), (39.9, 0, SEEN // 2), (96.0, SEEN // 2, SEEN // 2)],
)
def test_half_of_the_view_is_clear_and_half_is_not(free_m: float, clear_free: int, through: int) -> None:
    found = free_directions(told(free_m), CAMERA, wall(20.0), AREA)
    assert (found.clear, found.asked) == (SEEN // 2, SEEN // 2)
    assert (found.clear_free, found.through) == (clear_free, through)
    assert sum(found.told) == (SEEN if free_m > 0.0 else 0) and sum(found.nearer) == through


def test_measured_points_count_where_they_stand_and_directions_without_points_not_at_all() -> None:
    none, all_of_it = np.zeros((480, 640), np.bool_), np.ones((480, 640), np.bool_)
    ground = free_directions(told(96.0), CAMERA, wall(20.0), AREA, none)
    stands = free_directions(told(96.0), CAMERA, wall(20.0), AREA, all_of_it)
    assert (ground.clear, ground.asked, sum(ground.told)) == (SEEN // 2, 0, SEEN // 2)
    assert (stands.clear, stands.asked, stands.through) == (0, SEEN // 2, SEEN // 2)


def test_what_is_above_or_below_the_volume_is_in_no_direction() -> None:
    disparity_px = wall(20.0)
    disparity_px[150:330] = 0.0  # 3.6 m above and below the camera
    found = free_directions(told(96.0), CAMERA, disparity_px, AREA)
    assert (found.clear, found.asked) == (SEEN, 0)


def test_frames_add_up() -> None:
    one = FreeDirections(4, 3, 2, 1, (1, 2, 3, 4), (0, 1, 0, 1))
    assert together([one, one]) == FreeDirections(8, 6, 4, 2, (2, 4, 6, 8), (0, 2, 0, 2))
    row = table("family", [("one", one)]).rows[0]
    assert row == ("one", "0.750 of 4", "0.500 of 2", "0.000 of 1", "0.500 of 2", "0.000 of 3", "0.250 of 4")
