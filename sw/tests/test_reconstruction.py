"""Triangulation against OpenCV, its covariance against Monte Carlo."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from random_seed import seeded
from stage_library import ffi, frame_view, lib, status_name
from track_library import BASELINE, CENTER, FOCAL, camera, matched, parameters_with

SIZE = 12.0  # standard deviation of the region's pixels along u; half of that along v


def region_at(u: float, v: float, d: float, **changes: float):
    values = {
        "label": 5,
        "mean_u_px": u,
        "mean_v_px": v,
        "cov_uu_px2": SIZE**2 - 1 / 12,
        "cov_vv_px2": SIZE**2 / 4 - 1 / 12,
        "min_u_px": int(u - 20),
        "max_u_px": int(u + 20),
        "min_v_px": int(v - 10),
        "max_v_px": int(v + 10),
        "boundary_inliers": 110,
        "disparity_px": d,
        "disparity_sigma_px": 0.4,
    }
    return ffi.new("vista_region *", values | changes)


def frame():
    return frame_view(parameters_with("reconstruction"), camera(), matched=matched())


def reconstruct(region):
    result = ffi.new("vista_detection *")
    return status_name(lib.vista_reconstruct_region(frame(), region, result)), result


@pytest.mark.slow
def test_positions_are_those_of_opencv() -> None:
    random = seeded(1)
    left = np.array([[FOCAL, 0, CENTER[0], 0], [0, FOCAL, CENTER[1], 0], [0, 0, 1, 0]])
    right = left.copy()
    right[0, 3] = -FOCAL * BASELINE
    q = np.array(
        [[1, 0, 0, -CENTER[0]], [0, 1, 0, -CENTER[1]], [0, 0, 0, FOCAL], [0, 0, 1 / BASELINE, 0]], np.float64
    )
    for _ in range(300):
        u, v, d = (
            float(x) for x in (random.integers(60, 600), random.integers(30, 440), random.uniform(1.5, 31))
        )
        status, found = reconstruct(region_at(u, v, d))
        assert status == "VISTA_OK"
        homogeneous = cv2.triangulatePoints(left, right, np.array([[u], [v]]), np.array([[u - d], [v]]))[:, 0]
        assert list(found.position_camera_m) == pytest.approx(
            homogeneous[:3] / homogeneous[3], rel=1e-6, abs=1e-6
        )
        image = np.zeros((480, 640), np.float32)
        image[int(v), int(u)] = d
        point = cv2.reprojectImageTo3D(image, q)[int(v), int(u)]
        assert list(found.position_camera_m) == pytest.approx(point, rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("d", [6.0, 12.0, 30.0])
def test_the_covariance_is_that_of_noisy_measurements(d: float) -> None:
    random = seeded(2)
    _, found = reconstruct(region_at(450.0, 150.0, d))
    sigmas = found.sigma_u_px, found.sigma_v_px, found.sigma_disparity_px
    u, v, noisy = (np.array([450.0, 150.0, d]) + random.normal(size=(200_000, 3)) * np.divide(sigmas, 4)).T
    points = np.stack([(u - CENTER[0]), (v - CENTER[1]), np.full_like(u, FOCAL)]) * BASELINE / noisy
    sampled = np.cov(points) * 16  # a quarter of the noise: inside the range where the Jacobian holds
    expected = np.array(list(found.covariance_camera_m2)).reshape(3, 3)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.abs(sampled - expected).max() < 0.03 * scale.max()
    assert np.abs((sampled - expected) / scale).max() < 0.03
    assert (expected == expected.T).all()


def test_noise_is_floor_and_spread_together() -> None:
    settings = parameters_with("reconstruction").reconstruction
    _, found = reconstruct(region_at(300, 200, 10.0))
    independent = 110 / 60
    assert found.sigma_disparity_px == pytest.approx(
        np.hypot(settings.disparity_sigma_px, 0.4 / np.sqrt(independent))
    )
    assert found.sigma_u_px == pytest.approx(np.hypot(1.0, 0.1 * 2 * SIZE))
    assert found.sigma_v_px == pytest.approx(np.hypot(1.0, 0.1 * SIZE))


def test_extent_is_metric_and_known_from_any_range() -> None:
    width, height = 2.0, 1.0
    for z in (15.0, 40.0, 90.0):
        half = 0.5 * np.array([width, height]) * FOCAL / z
        covariance = (half / 2) ** 2 - 1 / 12
        region = region_at(300, 200, FOCAL * BASELINE / z, cov_uu_px2=covariance[0], cov_vv_px2=covariance[1])
        _, found = reconstruct(region)
        assert list(found.extent_m) == pytest.approx([width, height])
        assert (found.ellipse.axis_a_px, found.ellipse.axis_b_px) == pytest.approx(tuple(half))


@pytest.mark.parametrize(
    ("box", "cut"),
    [
        ({"min_u_px": 37}, (False, False)),
        ({"min_u_px": 36}, (True, False)),
        ({"max_u_px": 634}, (True, False)),
        ({"max_u_px": 633}, (False, False)),
        ({"min_v_px": 5}, (False, True)),
        ({"max_v_px": 474, "min_u_px": 0}, (True, True)),
    ],
)
def test_a_region_cut_by_the_border_has_an_uncertain_centre(
    box: dict[str, int], cut: tuple[bool, bool]
) -> None:
    _, free = reconstruct(region_at(300, 200, 10.0))
    _, found = reconstruct(region_at(300, 200, 10.0, **box))
    assert (found.cut_u, found.cut_v) == cut
    assert found.sigma_u_px == pytest.approx(np.hypot(free.sigma_u_px, 2 * SIZE * cut[0]))
    assert found.sigma_v_px == pytest.approx(np.hypot(free.sigma_v_px, SIZE * cut[1]))


def test_only_accepted_regions_become_detections() -> None:
    items = [
        region_at(300, 200, 10.0, label=1),
        region_at(300, 200, 10.0, label=2, verdict=lib.VISTA_REGION_HORIZONTAL),
        region_at(300, 200, 0.9, label=3),
        region_at(310, 210, 20.0, label=4),
    ]
    regions = ffi.new("vista_region[]", [item[0] for item in items])
    found = ffi.new("vista_detection[4]")
    detections = ffi.new("vista_detections *", [found, 0, 4])
    assert lib.vista_reconstruct_regions(frame(), regions, 4, detections) == lib.VISTA_OK
    assert [found[i].label for i in range(detections.count)] == [1, 4]
    detections.capacity = 1
    status = lib.vista_reconstruct_regions(frame(), regions, 4, detections)
    assert (status_name(status), detections.count) == ("VISTA_ERROR_CAPACITY", 1)
    assert found[0].label == 4  # the nearest


def test_bad_input_is_refused_and_nothing_written() -> None:
    nan = float("nan")
    for changes, status in [
        ({"disparity_px": nan}, "VISTA_ERROR_NUMBER"),
        ({"disparity_px": 0.5}, "VISTA_ERROR_RANGE"),
        ({"mean_u_px": nan}, "VISTA_ERROR_NUMBER"),
        ({"cov_uu_px2": -5.0}, "VISTA_ERROR_RANGE"),
    ]:
        found, result = reconstruct(region_at(300, 200, 10.0, **changes))
        assert (found, result.disparity_px) == (status, 0.0)
