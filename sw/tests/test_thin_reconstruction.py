"""Thin lines become detections nearest to the flight path, and bands of matched blocks give way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from random_seed import seeded
from stage_library import default_parameters, ffi, frame_view, lib, status_name
from thin_cases import BASELINE_M, CAMERA, CENTER, FOCAL_PX, HEIGHT, Wire, wire_at

RADIUS_M = 2.0


def line_of(wire: Wire, **changes: float):
    """What the search would find of a wire: the rows in which it is in view."""
    point, along = wire.line_px
    slope = along[0] / along[1]
    ends = np.array([0.0, HEIGHT - 1.0])
    d = wire.disparity_px(point[0] + slope * (ends - point[1]), ends)
    values = {
        "u_px": point[0] + slope * (240.0 - point[1]),
        "v_px": 240.0,
        "slope": slope,
        "first_px": 0,
        "last_px": HEIGHT - 1,
        "disparity_px": float(d[0] + (d[1] - d[0]) * 240.0 / (HEIGHT - 1)),
        "disparity_slope": float(d[1] - d[0]) / (HEIGHT - 1),
        "disparity_sigma_px": 0.2,
        "disparity_slope_sigma": 0.0005,
    }
    return ffi.new("vista_thin_line *", values | changes)


def volume_along(direction=(0.0, 0.0, 1.0), normal=(1.0, 0.0, 0.0), curvature_1_m: float = 0.0):
    return ffi.new("vista_collision_volume *", [direction, RADIUS_M, 60.0, normal, 3.5, curvature_1_m])


def reconstruct(lines: list, volume=None, before: list | None = None, capacity: int = 8) -> tuple[str, list]:
    parameters = default_parameters()
    items = ffi.new("vista_thin_line[]", [line[0] for line in lines])
    detections = ffi.new("vista_detection[]", max(1, capacity))
    for k, detection in enumerate(before or []):
        detections[k] = detection[0]
    found = ffi.new("vista_detections *", [detections, len(before or []), capacity])
    listed = ffi.new("vista_thin_lines *", [items, len(lines)])
    frame = frame_view(parameters, CAMERA)
    status = lib.vista_thin_reconstruct(frame, listed, volume or volume_along(), 100, found)
    return status_name(status), [ffi.new("vista_detection *", detections[k]) for k in range(found.count)]


def nearest_to_axis(wire: Wire) -> np.ndarray:
    """The point of the wire nearest to the optical axis: both are straight."""
    m, d = wire.middle_m, wire.direction
    return m - d * (m[:2] @ d[:2]) / (d[:2] @ d[:2])


def test_the_point_nearest_to_the_path_stands_for_the_line() -> None:
    random = seeded(1)
    direction = np.array([random.uniform(-1.0, 1.0), 1.0, random.uniform(-0.3, 0.3)])
    middle = np.array([random.uniform(-1.5, 1.5), 0.0, random.uniform(12.0, 30.0)])
    wire = Wire(middle, direction / np.linalg.norm(direction), 0.02)
    status, [found] = reconstruct([line_of(wire)])
    assert status == "VISTA_OK" and found.label == 100
    # A pixel, and what a straight line in disparity is off from one in space, is allowed for.
    assert np.linalg.norm(np.array(list(found.position_camera_m)) - nearest_to_axis(wire)) < 0.15
    assert found.disparity_px == pytest.approx(FOCAL_PX * BASELINE_M / found.position_camera_m[2])


def test_volume_pixels_are_those_within_the_radius() -> None:
    """A vertical wire at 20 m that passes the path 1.2 m aside: a chord of 3.2 m, 160 px."""
    status, [found] = reconstruct([line_of(wire_at(90.0, 20.0, 0.02, x_m=1.2))])
    assert status == "VISTA_OK"
    assert found.volume_pixels == pytest.approx(160, abs=3)
    assert found.extent_m[1] == pytest.approx(2 * RADIUS_M, abs=0.1) and found.extent_m[0] < 0.1
    assert found.ellipse.angle_deg == pytest.approx(90.0, abs=0.1)
    assert found.line and not found.met


@pytest.mark.parametrize(
    ("aside_m", "detected", "inside"), [(1.9, 1, True), (2.1, 1, False), (4.2, 0, False)]
)
def test_far_from_the_path_nothing_is_told(aside_m: float, detected: int, inside: bool) -> None:
    _, found = reconstruct([line_of(wire_at(90.0, 20.0, 0.02, x_m=aside_m))])
    assert len(found) == detected
    assert all((each.volume_pixels > 0) == inside for each in found)


def test_the_arc_that_is_flown_counts() -> None:
    """A bend to the right with a radius of 40 m leaves the axis by 4.5 m in 20 m of travel."""
    volume = volume_along(curvature_1_m=1 / 40)
    straight_on, on_arc = wire_at(90.0, 19.2, 0.02), wire_at(90.0, 19.2, 0.02, x_m=4.9)
    _, found = reconstruct([line_of(straight_on), line_of(on_arc)], volume)
    assert [each.label for each in found if each.volume_pixels > 0] == [101]


def test_the_covariance_is_long_along_the_line_and_along_the_sight() -> None:
    random = seeded(2)
    angle = random.uniform(35.0, 145.0)
    _, [found] = reconstruct([line_of(wire_at(angle, 20.0, 0.02))])
    covariance = np.array(list(found.covariance_camera_m2)).reshape(3, 3)
    assert np.all(np.linalg.eigvalsh(covariance) > 0)
    metre_per_px = 20.0 / FOCAL_PX
    assert found.sigma_u_px == pytest.approx(math.hypot(0.7, 10 * math.cos(math.radians(angle))), abs=0.05)
    assert found.sigma_v_px == pytest.approx(math.hypot(0.7, 10 * math.sin(math.radians(angle))), abs=0.05)
    assert math.sqrt(covariance[0, 0]) == pytest.approx(found.sigma_u_px * metre_per_px, rel=0.02)
    assert math.sqrt(covariance[2, 2]) == pytest.approx(20.0**2 / (FOCAL_PX * BASELINE_M) * 0.2, rel=0.05)


def test_where_the_line_is_uncertain_it_says_nothing() -> None:
    """Its words are at the bottom of the view; at the height of the path their slope is a guess."""
    line = line_of(wire_at(90.0, 20.0, 0.02), v_px=470.0, disparity_slope_sigma=0.02)
    _, found = reconstruct([line])
    assert all(each.v_px > 350 for each in found)


def band(wire: Wire, u_px: float | None = None, **changes: float):
    """The detection of a region that matching has made of a wire: as long as the view, 14 px wide."""
    point, along = wire.line_px
    u = point[0] + along[0] / along[1] * (200.0 - point[1]) if u_px is None else u_px
    d = FOCAL_PX * BASELINE_M / wire.middle_m[2]
    angle_deg = math.degrees(math.atan2(along[1], along[0]))
    angle_deg -= 180.0 * round(angle_deg / 180.0) if abs(angle_deg) > 90.0 else 0.0
    values = {"label": 3, "u_px": u, "v_px": 200.0, "disparity_px": d, "volume_pixels": 50}
    shape = {
        "center_u_px": u,
        "center_v_px": 200.0,
        "axis_a_px": 240.0,
        "axis_b_px": 8.0,
        "angle_deg": angle_deg,
    }
    return ffi.new("vista_detection *", values | {"ellipse": shape} | changes)


@pytest.mark.parametrize("angle_deg", [35.0, 90.0, 120.0])
def test_a_band_of_blocks_gives_way_to_its_line(angle_deg: float) -> None:
    wire = wire_at(angle_deg, 20.0, 0.02)
    other = band(wire, u_px=CENTER[0] + 90.0)
    _, found = reconstruct([line_of(wire)], before=[band(wire), other])
    assert [each.label for each in found] == [3, 100]
    assert found[0].u_px == other.u_px


@pytest.mark.parametrize(
    "change",
    [{"disparity_px": 19.0}, {"ellipse": {"axis_a_px": 200.0, "axis_b_px": 40.0, "angle_deg": 90.0}}],
)
def test_what_is_farther_away_or_wider_stays(change: dict) -> None:
    wire = wire_at(90.0, 20.0, 0.02)
    _, found = reconstruct([line_of(wire)], before=[band(wire, **change)])
    assert [each.label for each in found] == [3, 100]


def test_beside_the_volume_the_region_is_kept() -> None:
    wire = wire_at(90.0, 20.0, 0.02, x_m=2.5)
    _, found = reconstruct([line_of(wire)], before=[band(wire)])
    assert [each.label for each in found] == [3]


def test_more_than_fit_are_refused() -> None:
    line = line_of(wire_at(90.0, 20.0, 0.02))
    assert reconstruct([line, line], capacity=1)[0] == "VISTA_OK"  # the second takes the place of the first
    crossing = line_of(wire_at(60.0, 20.0, 0.02))
    status, found = reconstruct([line, crossing], capacity=1)
    assert status == "VISTA_ERROR_CAPACITY" and [each.label for each in found] == [100]
