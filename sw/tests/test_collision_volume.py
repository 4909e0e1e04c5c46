"""Pixels of a region in the collision volume, by triangulating every one of them in numpy."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from region_cases import box, measure
from stage_library import Stages, camera, ffi, lib, plane_disparity, rays, words_of

RADIUS_M, LENGTH_M = 2.0, 30.0


def count(stages: Stages, words: np.ndarray, direction=(0.0, 0.0, 1.0), **changes) -> list[int]:
    volume = ffi.new(
        "vista_collision_volume *",
        {"direction_camera": list(direction), "radius_m": RADIUS_M, "length_m": LENGTH_M} | changes,
    )
    stages.see(words=words)
    lib.vista_collision_volume_count(stages.frame, volume, stages.cells, stages.regions)
    return [stages.regions.items[k].volume_pixels for k in range(stages.regions.count)]


def own_points(stages: Stages, words: np.ndarray, region) -> tuple[np.ndarray, np.ndarray]:
    """Which pixels are the region's own, near its surface; where all of them are, in camera coordinates."""
    v, u = np.mgrid[: words.shape[0], : words.shape[1]]
    surface = (
        region.disparity_px
        + region.slope_u * (u - region.mean_u_px)
        + region.slope_v * (v - region.mean_v_px)
    )
    own = (words > 0) & (np.abs(words / 16 - surface) <= 1.0)
    own &= (stages.label == region.label)[stages.foveation.cell_of_pixel]
    scale = stages.camera.focal_px * stages.camera.baseline_m
    return own, rays(stages.camera) * (scale * 16 / np.maximum(words, 1))[..., None]


def expected(stages: Stages, words: np.ndarray, region, direction, slack_m: float) -> int:
    """slack_m widens the volume, or narrows it."""
    own, points = own_points(stages, words, region)
    along = points @ np.asarray(direction)
    across = np.linalg.norm(points - along[..., None] * np.asarray(direction), axis=-1)
    inside = (across <= RADIUS_M + slack_m) & (along > 0) & (along <= LENGTH_M + slack_m)
    return int(np.count_nonzero(own & inside))


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.1, -0.05, 1.0), (-0.3, 0.0, 1.0)])
def test_pixels_are_counted_where_they_are(direction: tuple[float, float, float]) -> None:
    """Boards at several ranges and a wall along the way, on both sides of the volume's surface."""
    random, unit = seeded(1), np.array(direction) / np.linalg.norm(direction)
    stages = Stages(camera())
    masks = [box((60, 120), 40, 60), box((160, 100), 30, 40), box((260, 140), 45, 90)]
    disparity = np.full((240, 320), -1.0)
    disparity[masks[0]], disparity[masks[1]] = 12.0, 8.0  # f B = 200 px m: 17 and 25 m
    disparity[masks[2]] = plane_disparity(stages.camera, (1, 0, 0.2), (2.5, 0, 2))[masks[2]]
    words = words_of(disparity, random, 0.1)
    regions = measure(stages, words, masks)
    assert stages.regions.accepted_count == 3
    for region, found in zip(regions, count(stages, words, unit), strict=True):
        low, high = (expected(stages, words, region, unit, slack) for slack in (-0.01, 0.01))
        assert low <= found <= high


@pytest.mark.parametrize("radius_m", [20.0, 60.0, 1e6])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_arc_is_followed(radius_m: float, side: float) -> None:
    """Pixel by pixel against the distance from the circle; hardly bent, as straight."""
    random, stages = seeded(3), Stages(camera())
    masks = [box((60, 120), 40, 60), box((160, 100), 30, 40), box((260, 140), 45, 90)]
    disparity = np.full((240, 320), -1.0)
    disparity[masks[0]], disparity[masks[1]] = 12.0, 8.0
    disparity[masks[2]] = plane_disparity(stages.camera, (1, 0, 0.2), (2.5, 0, 2))[masks[2]]
    words = words_of(disparity, random, 0.1)
    regions = measure(stages, words, masks)
    arc = {"normal_camera": [side, 0.0, 0.0], "curvature_1_m": 1.0 / radius_m}
    found = count(stages, words, **arc)
    for region, pixels in zip(regions, found, strict=True):
        low, high = (on_arc(stages, words, region, side * radius_m, slack) for slack in (-0.01, 0.01))
        assert low <= pixels <= high
    assert any(found)
    if radius_m == 1e6:
        assert found == pytest.approx(count(stages, words), abs=5)


def on_arc(stages: Stages, words: np.ndarray, region, radius_m: float, slack_m: float) -> int:
    """Own pixels near a circle around (radius_m, 0, 0)."""
    own, points = own_points(stages, words, region)
    x, y, z = np.moveaxis(points, -1, 0)
    aside = np.hypot(x - radius_m, z) - abs(radius_m)
    along = np.arctan2(z, abs(radius_m) - np.sign(radius_m) * x) * abs(radius_m)
    inside = np.hypot(aside, y) <= RADIUS_M + slack_m
    return int(np.count_nonzero(own & inside & (z > 0) & (along <= LENGTH_M + slack_m)))


@pytest.mark.parametrize(("lean", "direction"), [(0.0, (0, 0, 1)), (0.7, (0, 0, 1)), (-1.0, (0.1, 0, 1))])
def test_a_wall_is_met_where_a_ball_on_the_path_touches_it(lean: float, direction: tuple) -> None:
    """Facing the camera or seen at an angle, 18 m ahead: the middle of the wall is several metres off."""
    random, unit = seeded(4), np.array(direction) / np.linalg.norm(direction)
    stages = Stages(camera())
    normal = np.array([lean, 0.0, 1.0]) / np.hypot(lean, 1.0)
    disparity = plane_disparity(stages.camera, normal, (0, 0, 18.0))
    wall = box((150, 110), 120, 90) & (disparity > 4.0)
    words = words_of(np.where(wall, disparity, -1.0), random, 0.25)
    measure(stages, words, [wall])
    assert count(stages, words, unit)[0] > 100
    region = stages.regions.items[0]
    assert region.met
    center_m = (18.0 * normal[2] - RADIUS_M) / (unit @ normal)
    touched = center_m * unit + RADIUS_M * normal
    met = np.array(list(region.met_camera_m))
    assert abs(np.linalg.norm(met) - np.linalg.norm(touched)) < 0.7
    middle = disparity[int(region.mean_v_px), int(region.mean_u_px)]
    if lean:
        assert abs(200 / middle - touched[2]) > 0.5
    words = words_of(np.where(wall, disparity, -1.0))
    measure(stages, words, [wall])
    count(stages, words, (-0.9, 0, np.sqrt(1 - 0.81)))
    assert not stages.regions.items[0].met


def test_a_tree_is_met_at_its_front() -> None:
    """A crown: each block at a depth of its own, from 14 to 19 m. Its boundary, from 16 m on, lies behind."""
    random, stages = seeded(5), Stages(camera())
    mask, inside = box((160, 120), 80, 80), box((160, 120), 64, 64)
    near, far = (np.kron(random.uniform(m, 19.0, (30, 40)), np.ones((8, 8))) for m in (14.0, 16.0))
    depth = np.where(inside, near, far)
    words = words_of(np.where(mask, 200.0 / depth, -1.0), random, 0.1)
    measure(stages, words, [mask])
    assert count(stages, words)[0] > 100
    region = stages.regions.items[0]
    assert region.met
    # What noise of a quarter of a pixel would make nearer is taken off: 0.45 px, some 0.5 m here.
    front_m, middle_m = np.quantile(depth[mask], 0.05), 200 / region.disparity_px
    assert middle_m - front_m > 1.2
    assert -0.3 < region.met_camera_m[2] - front_m < 0.65 * (middle_m - front_m)


@pytest.mark.parametrize("disparity_px", [8.0, 12.0])
def test_the_range_at_which_a_thing_is_met_is_as_good_as_its_sigma_says(disparity_px: float) -> None:
    """Boards with noise of 0.1 to 0.2 px, and crowns before them, 6 m wide and 1.2 m deep, with leaves. What
    is met is the mean of the 20 pixels that a ball on the path touches first."""
    random, half_m = seeded(6), 3.0
    stages = Stages(camera())
    depth_m = 200.0 / disparity_px
    v, u = np.mgrid[:240, :320]
    across_m = (np.stack([u, v]) - np.reshape([160, 120], (2, 1, 1))) * depth_m / stages.camera.focal_px
    aside_m = np.linalg.norm(across_m, axis=0)
    disc = aside_m <= half_m
    nees: dict[str, list[float]] = {"board": [], "crown": []}
    for _ in range(6):
        leaves_m = np.kron(random.uniform(0.0, 0.3, (60, 80)), np.ones((4, 4)))
        crown_m = 1.2 * np.sqrt(np.maximum(1.0 - (aside_m / half_m) ** 2, 0.0)) - leaves_m
        for name, front_m in (("board", np.zeros_like(crown_m)), ("crown", crown_m)):
            surface_m = depth_m - front_m
            words = words_of(np.where(disc, 200.0 / surface_m, -1.0), random, random.uniform(0.1, 0.2))
            measure(stages, words, [disc])
            assert count(stages, words, length_m=60.0)[0] > 100
            region, inside = stages.regions.items[0], disc & (aside_m <= RADIUS_M)
            touches_m = (surface_m - np.sqrt(np.maximum(RADIUS_M**2 - aside_m**2, 0.0)))[inside]
            true_m = surface_m[inside][np.argsort(touches_m)[:20]].mean()
            nees[name].append(((region.met_camera_m[2] - true_m) / region.met_sigma_m) ** 2)
    for name, values in nees.items():
        assert np.mean(values) < 3.0 and max(values) < 9.0, (name, values)


def test_what_is_met_is_never_behind_the_camera() -> None:
    """Words of a quarter of a pixel, 800 m away, before a surface beyond infinity, within the noise."""
    stages = Stages(camera())
    mask = box((160, 120), 80, 80)
    words = words_of(np.where(mask, 0.25, -1.0))
    measure(stages, words, [mask])
    region = stages.regions.items[0]
    region.verdict = lib.VISTA_REGION_ACCEPTED
    region.disparity_px, region.slope_u, region.slope_v = -0.05, 0.0, 0.0
    region.disparity_sigma_px = 0.2
    assert count(stages, words, radius_m=20.0, length_m=1000.0)[0] > 100
    assert not region.met


def test_things_are_as_much_narrower_as_matching_widens_them() -> None:
    """A post from 1.6 m to 2.0 m beside the way, at 20 m."""
    stages = Stages(camera())
    mask = box((160 + 36, 120), 4, 60)
    words = words_of(np.where(mask, 10.0, -1.0))
    measure(stages, words, [mask])
    counts = [count(stages, words, outline_px=outline)[0] for outline in (0.0, 2.0, 9.0)]
    assert counts[0] > counts[1] > counts[2] == 0


def test_far_ahead_the_volume_is_narrower_by_what_is_uncertain_of_the_path() -> None:
    """A board 16 m wide at 20 m. What is left of the volume's cross-section is the square of what is left of
    its radius, and no less than a quarter; of an arc the curvature is uncertain, too."""
    stages = Stages(camera())
    mask = box((160, 120), 80, 80)
    words = words_of(np.where(mask, 10.0, -1.0))
    measure(stages, words, [mask])
    (whole,) = count(stages, words, path_sigmas=0.0, sigma_rad=0.02)
    for sigmas, sigma_rad, left in ((1.0, 0.02, 0.8), (2.0, 0.02, 0.6), (0.5, 0.04, 0.8), (3.0, 0.2, 0.5)):
        (found,) = count(stages, words, path_sigmas=sigmas, sigma_rad=sigma_rad)
        assert found / whole == pytest.approx(left**2, rel=0.1)
    arc = {"normal_camera": [1.0, 0.0, 0.0], "curvature_1_m": 0.01}
    (whole,) = count(stages, words, **arc)
    (found,) = count(stages, words, path_sigmas=1.0, sigma_rad=0.02, **arc)
    left_m = RADIUS_M - np.hypot(20.0 * 0.02, 0.25 * 0.01 * 20.0**2 / 2.0)
    assert found / whole == pytest.approx((left_m / RADIUS_M) ** 2, rel=0.1)


def test_a_wall_beside_the_way_is_out_though_its_middle_would_reach_in() -> None:
    """3 m to the right, from 6 m to 30 m ahead: as a disc of its size it would be in the way."""
    stages = Stages(camera())
    disparity = plane_disparity(stages.camera, (1, 0, 0), (3, 0, 0))
    wall = (disparity > 200 / 30) & (disparity < 200 / 6)
    words = words_of(np.where(wall, disparity, -1.0))
    (region,) = measure(stages, words, [wall])
    assert region.verdict == lib.VISTA_REGION_ACCEPTED
    assert count(stages, words) == [0]
    assert count(stages, words, (0.2, 0.0, np.sqrt(0.96)))[0] > 1000


def test_what_is_no_obstacle_is_not_counted() -> None:
    stages = Stages(camera(), {"region.min_disparity_px": 25.0})
    mask = box((160, 120), 30, 30)
    words = words_of(np.where(mask, 20.0, -1.0))
    measure(stages, words, [mask])
    assert count(stages, words) == [0]
