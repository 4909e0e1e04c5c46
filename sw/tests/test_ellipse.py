"""The bounding ellipse against filled ellipses drawn pixel by pixel."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from random_seed import seeded
from stage_library import ffi, lib, status_name


def region_of(u: np.ndarray, v: np.ndarray):
    covariance = np.cov(u, v, ddof=0)
    region = ffi.new("vista_region *")
    region.mean_u_px, region.mean_v_px = u.mean(), v.mean()
    region.cov_uu_px2, region.cov_uv_px2, region.cov_vv_px2 = (
        covariance[0, 0],
        covariance[0, 1],
        covariance[1, 1],
    )
    return region


def ellipse_of(region):
    ellipse = ffi.new("vista_ellipse *")
    assert lib.vista_ellipse_from_region(region, ellipse) == lib.VISTA_OK
    return ellipse


def test_a_filled_ellipse_comes_back() -> None:
    random = seeded(1)
    v, u = np.mgrid[:200, :240]
    for _ in range(200):
        center = random.uniform(90, 110, 2)
        b, a = np.sort(random.uniform(20, 60, 2))
        angle = random.uniform(-90, 90)
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        along, across = (u - center[0]) * c + (v - center[1]) * s, (v - center[1]) * c - (u - center[0]) * s
        inside = (along / a) ** 2 + (across / b) ** 2 <= 1
        found = ellipse_of(region_of(u[inside], v[inside]))
        assert (found.center_u_px, found.center_v_px) == pytest.approx(tuple(center), abs=0.2)
        assert (found.axis_a_px, found.axis_b_px) == pytest.approx((a, b), abs=0.2)
        if a > 1.2 * b:
            assert abs((found.angle_deg - angle + 90) % 180 - 90) < 3.0


@pytest.mark.parametrize("angle", [-60, -20, 0, 30, 45, 89, 90])
def test_the_angle_turns_as_opencv_draws_it(angle: int) -> None:
    canvas = np.zeros((200, 200), np.uint8)
    cv2.ellipse(canvas, (100, 100), (60, 20), angle, 0, 360, 255, cv2.FILLED)
    found = ellipse_of(region_of(*np.nonzero(canvas)[::-1]))
    assert abs((found.angle_deg - angle + 90) % 180 - 90) < 1.0
    assert -90 < found.angle_deg <= 90


def test_one_pixel_and_a_row_of_pixels_have_an_area() -> None:
    one = ellipse_of(region_of(np.array([7.0]), np.array([9.0])))
    assert (one.axis_a_px, one.axis_b_px) == pytest.approx((2 / np.sqrt(12),) * 2)
    row = ellipse_of(region_of(np.arange(30.0), np.zeros(30)))
    assert row.axis_a_px == pytest.approx(2 * 30 / np.sqrt(12))  # a uniform line of 30 px
    assert row.axis_b_px == pytest.approx(2 / np.sqrt(12))
    assert row.angle_deg == pytest.approx(0.0)


def test_box_and_inside_agree_with_points_on_the_ellipse() -> None:
    random = seeded(2)
    t = np.linspace(0, 2 * np.pi, 20001)
    half = ffi.new("double[2]")
    for _ in range(50):
        b, a = np.sort(random.uniform(0.5, 50, 2))
        angle = random.uniform(-89, 90)
        ellipse = ffi.new("vista_ellipse *", [100, 80, a, b, angle])
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        du = a * np.cos(t) * c - b * np.sin(t) * s
        dv = a * np.cos(t) * s + b * np.sin(t) * c
        lib.vista_ellipse_half_box(ellipse, half, half + 1)
        assert list(half) == pytest.approx([du.max(), dv.max()], rel=1e-6)


@pytest.mark.parametrize(
    ("moments", "status"),
    [
        ((0, 0, float("nan"), 0, 1), "VISTA_ERROR_NUMBER"),
        ((float("inf"), 0, 1, 0, 1), "VISTA_ERROR_NUMBER"),
        ((0, 0, -1, 0, 1), "VISTA_ERROR_RANGE"),
        ((0, 0, 1, 2, 1), "VISTA_ERROR_RANGE"),
    ],
)
def test_what_is_no_covariance_is_refused(moments: tuple[float, ...], status: str) -> None:
    ellipse = ffi.new("vista_ellipse *", [1, 2, 3, 4, 5])
    assert status_name(lib.vista_ellipse_from_moments(*moments, ellipse)) == status
    assert ellipse.axis_a_px == 3
