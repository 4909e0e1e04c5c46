"""Upright surfaces as lines of the plan: what is put in is found, whatever the attitude and the outliers."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import camera, ffi, lib, plane_disparity

CAMERA = camera()


def rotation(roll_deg: float, pitch_deg: float) -> np.ndarray:
    """Turns from the world (x right, y down, z ahead) to the camera."""
    r, p = np.radians([roll_deg, pitch_deg])
    roll = np.array([[np.cos(r), np.sin(r), 0], [-np.sin(r), np.cos(r), 0], [0, 0, 1]])
    pitch = np.array([[1, 0, 0], [0, np.cos(p), np.sin(p)], [0, -np.sin(p), np.cos(p)]])
    return roll @ pitch


def plan_of(up: np.ndarray):
    plan = ffi.new("vista_plan *")
    return plan if lib.vista_plan_of(CAMERA, ffi.new("double[3]", up.tolist()), plan) else None


def fit(plan, u: np.ndarray, v: np.ndarray, disparity_px: np.ndarray):
    points = ffi.new("vista_plan_point[]", u.size)
    for k in range(u.size):
        assert lib.vista_plan_place(
            plan, float(u[k]), float(v[k]), float(disparity_px[k]), ffi.addressof(points, k)
        )
    line = ffi.new("vista_plan_line *")
    return line if lib.vista_plan_fit(points, u.size, 1.0, line) else None


@pytest.mark.parametrize(("roll_deg", "pitch_deg"), [(0, 0), (20, 0), (-45, 10), (30, -25)])
def test_an_upright_surface_is_found_among_outliers(roll_deg: float, pitch_deg: float) -> None:
    random = seeded(1)
    to_camera = rotation(roll_deg, pitch_deg)
    azimuth = np.radians(random.uniform(-50, 50))
    normal = to_camera @ np.array([np.sin(azimuth), 0, -np.cos(azimuth)])
    truth = plane_disparity(CAMERA, normal, to_camera @ np.array([0, 0, 20.0]))
    u, v = random.integers(0, CAMERA.width_px, 60), random.integers(0, CAMERA.height_px, 60)
    disparity = truth[v, u] + random.normal(0, 0.1, 60)
    disparity[::4] += random.uniform(3, 8, 15)  # nearer things before it
    plan = plan_of(to_camera @ np.array([0, -1.0, 0]))
    line = fit(plan, u, v, disparity)
    assert line.count == 45
    surface = lib.vista_plan_surface(plan, line)
    rows, columns = np.mgrid[: CAMERA.height_px, : CAMERA.width_px]
    found = surface.offset + surface.slope_u * columns + surface.slope_v * rows
    # 45 points of 0.1 px; at the corners, beyond all of them, some 0.05
    assert np.abs(found - truth).max() < 0.5


def test_points_of_one_azimuth_tell_no_line() -> None:
    plan = plan_of(np.array([0, -1.0, 0]))
    assert fit(plan, np.full(8, 100.0), np.linspace(10, 200, 8), np.full(8, 10.0)) is None


def test_a_camera_that_looks_down_has_no_plan() -> None:
    assert plan_of(np.array([0, -0.1, -0.995])) is None
