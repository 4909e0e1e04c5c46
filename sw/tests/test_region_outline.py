"""Regions that only their outline tells: a plain wall stands, what shows between things does not."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import GROUND, INVALID, SKY, Stages, camera, ffi, lib, plane_disparity, rays, words_of

CAMERA = camera()
SCALE = CAMERA.focal_px * CAMERA.baseline_m
GROUND_M, RANGE_M, BLOCK_PX = 3.0, 15.0, 5
WALL, PILLAR, TREES = 3, 4, 5
DRAWS = 5  # of noise: one in a hundred hides so much of a wall that it stays unknown in that frame
GREYS = {GROUND: 110, SKY: 230, WALL: 120, PILLAR: 60, TREES: 30}


def box(width_m: tuple[float, float], height_m: tuple[float, float], range_m: float = RANGE_M) -> np.ndarray:
    """Pixels of an upright rectangle: from .. to across, from .. to above the ground."""
    ray = rays(CAMERA)
    x, height = ray[..., 0] * range_m, GROUND_M - ray[..., 1] * range_m
    return (x >= width_m[0]) & (x <= width_m[1]) & (height >= height_m[0]) & (height <= height_m[1])


def landscape() -> tuple[np.ndarray, np.ndarray]:
    """Owner and disparity (-1: none) of textured ground up to 80 m and of empty sky."""
    ground = plane_disparity(CAMERA, (0, 1, 0), (0, GROUND_M, 0))
    seen = ground > SCALE / 80
    return np.where(seen, GROUND, SKY), np.where(seen, ground, -1.0)


def put(
    owner: np.ndarray, disparity: np.ndarray, kind: int, where: np.ndarray, range_m: float = RANGE_M
) -> None:
    owner[where], disparity[where] = kind, SCALE / range_m


def put_plain(
    owner: np.ndarray, disparity: np.ndarray, where: np.ndarray, surface: np.ndarray | float = SCALE / RANGE_M
) -> None:
    """Its left and right edges are matched, half a block to both sides; no other pixel is."""
    owner[where], disparity[where] = WALL, -1.0
    edges = np.zeros_like(where)
    edges[:, 1:] = where[:, 1:] != where[:, :-1]
    surface = np.broadcast_to(surface, where.shape)
    for shift in range(-BLOCK_PX, BLOCK_PX + 1):
        at = np.zeros_like(edges)
        at[:, BLOCK_PX:-BLOCK_PX] = np.roll(edges, shift, axis=1)[:, BLOCK_PX:-BLOCK_PX]
        disparity[at] = surface[at]


def regions_of(
    owner: np.ndarray, disparity: np.ndarray, seed: int, **changes: float
) -> tuple[Stages, list, np.ndarray]:
    random = seeded(seed)
    grey = np.vectorize(GREYS.get)(owner) + random.normal(0, 1.5, owner.shape)
    words = words_of(disparity, random, 0.1)
    words[(disparity < 0) & (random.random(owner.shape) < 0.02)] = 16 * 30  # chance matches
    assert words.min() == INVALID
    stages = Stages(CAMERA, changes)
    regions = stages.run(np.clip(grey, 0, 255).astype(np.uint8), words)
    return stages, regions, stages.label[stages.foveation.cell_of_pixel]


def verdicts_at(
    owner: np.ndarray, disparity: np.ndarray, seed: int, where: np.ndarray
) -> list[tuple[str, object]]:
    """Verdict and region at these pixels, in some draws of the noise."""
    found = []
    for draw in range(DRAWS):
        _, regions, labels = regions_of(owner, disparity, 100 * draw + seed)
        region = region_at(regions, labels, where)
        found.append((verdict(region), region))
    return found


def region_at(regions: list, labels: np.ndarray, where: np.ndarray):
    """The region that has most of these pixels."""
    inside = labels[where & (labels >= 0)]
    region = regions[np.bincount(inside).argmax()]
    assert np.mean(labels[where] == region.label) > 0.6
    return region


def verdict(region) -> str:
    return ffi.string(lib.vista_region_verdict_name(region.verdict)).decode()


def wall(foot_m: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    owner, disparity = landscape()
    where = box((-2.5, 2.5), (foot_m, foot_m + 4.0))
    put_plain(owner, disparity, where)
    return owner, disparity, where


def test_a_plain_wall_before_a_plain_sky_is_an_obstacle() -> None:
    owner, disparity, where = wall()
    _, regions, labels = regions_of(owner, disparity, 1)
    region = region_at(regions, labels, where)
    assert verdict(region) == "ACCEPTED" and region.plain
    assert region.disparity_px == pytest.approx(SCALE / RANGE_M, abs=0.2 + region.foot_sigma_px)
    v, u = np.nonzero(where)
    assert (region.mean_u_px, region.mean_v_px) == pytest.approx((u.mean(), v.mean()), abs=5)
    assert region.pixel_count == pytest.approx(u.size, rel=0.15)
    assert verdict(region_at(regions, labels, owner == SKY)) == "UNKNOWN"


def surface_px(region, where: np.ndarray) -> np.ndarray:
    """Disparities of the region's surface at these pixels."""
    v, u = np.nonzero(where)
    return (
        region.disparity_px
        + region.slope_u * (u - region.mean_u_px)
        + region.slope_v * (v - region.mean_v_px)
    )


@pytest.mark.parametrize("degrees", [-45, -20, 20, 45])
def test_a_plain_wall_may_stand_at_an_angle(degrees: int) -> None:
    owner, disparity = landscape()
    normal = np.array([np.sin(np.radians(degrees)), 0, -np.cos(np.radians(degrees))])
    surface = plane_disparity(CAMERA, normal, (0, 0, RANGE_M))
    ray = rays(CAMERA)
    point = ray * (SCALE / surface)[..., None]
    where = (np.abs(ray[..., 0]) < 0.17) & (point[..., 1] < GROUND_M) & (point[..., 1] > -1.0)
    put_plain(owner, disparity, where, surface)
    accepted = [region for name, region in verdicts_at(owner, disparity, 8, where) if name == "ACCEPTED"]
    assert len(accepted) > DRAWS / 2
    for region in accepted:
        assert region.plain
        error_px = surface_px(region, where) - surface[where]
        # 8 % of the range; facing, it would be 20 and more
        assert np.abs(error_px).max() < 0.08 * SCALE / RANGE_M


def test_the_foot_is_taken_to_be_half_a_block_below_where_words_of_the_ground_end() -> None:
    """They reach up into the wall. The true foot is anywhere from there to half a block lower."""
    owner, disparity = landscape()
    where = box((-2.5, 2.5), (0.0, 4.0))
    put_plain(owner, disparity, where)
    reached = where & np.roll(~where & (owner == GROUND), -BLOCK_PX, axis=0)
    disparity[reached] = SCALE / RANGE_M
    _, regions, labels = regions_of(owner, disparity, 12)
    found = region_at(regions, labels, where)
    assert verdict(found) == "ACCEPTED" and found.plain
    slope_px = CAMERA.baseline_m / GROUND_M  # of the ground's disparity, a row
    assert found.disparity_px == pytest.approx(SCALE / RANGE_M, abs=BLOCK_PX * slope_px / np.sqrt(3))
    assert found.foot_sigma_px == pytest.approx(BLOCK_PX * slope_px / np.sqrt(3), rel=0.1)


@pytest.mark.parametrize("side", [-1, 1])
def test_an_edge_outside_of_the_image_tells_nothing(side: int) -> None:
    owner, disparity = landscape()
    where = box((-2.0, 30.0) if side > 0 else (-30.0, 2.0), (0.0, 4.0))
    put_plain(owner, disparity, where)
    _, regions, labels = regions_of(owner, disparity, 9)
    region = region_at(regions, labels, where)
    assert verdict(region) == "ACCEPTED" and region.plain
    foot_px = BLOCK_PX * CAMERA.baseline_m / GROUND_M  # what the unknown foot leaves open
    assert np.abs(surface_px(region, where) - SCALE / RANGE_M).max() < 0.5 + foot_px


@pytest.mark.parametrize(("right_m", "expected"), [(2.5, "ACCEPTED"), (30.0, "UNKNOWN")])
def test_a_ragged_foot_needs_both_upright_edges(right_m: float, expected: str) -> None:
    """Two fifths of the foot are where words of the ground end by chance. The one edge in the image may be
    that of a tree which stands beside a field."""
    owner, disparity = landscape()
    where = box((-2.0, right_m), (0.0, 4.0))
    put_plain(owner, disparity, where)
    ragged = box((-2.0, right_m), (-1.0, 0.0)) & (np.arange(owner.shape[1]) % 60 < 27)
    owner[ragged], disparity[ragged] = WALL, -1.0
    verdicts = [name for name, _ in verdicts_at(owner, disparity, 13, where)]
    assert verdicts.count(expected) > DRAWS / 2


@pytest.mark.parametrize(
    ("kept", "whole_foot", "expected"),
    [(0.4, True, "ACCEPTED"), (0.4, False, "UNKNOWN"), (0.1, True, "UNKNOWN")],
)
def test_a_whole_foot_makes_up_for_an_edge_of_which_noise_left_little(
    kept: float, whole_foot: bool, expected: str
) -> None:
    """Words of the lower part of the one edge in the image are left; the other edge is outside of it."""
    owner, disparity = landscape()
    where = box((-2.0, 30.0), (0.0, 4.0))
    put_plain(owner, disparity, where)
    lost = box((-3.0, -1.0), (4.0 * kept, 5.0))
    disparity[lost] = -1.0
    if not whole_foot:
        ragged = box((-2.0, 30.0), (-1.0, 0.0)) & (np.arange(owner.shape[1]) % 60 < 18)
        owner[ragged], disparity[ragged] = WALL, -1.0
    _, regions, labels = regions_of(owner, disparity, 14)
    assert verdict(region_at(regions, labels, where)) == expected


def test_without_any_edge_nothing_tells_a_wall_from_haze() -> None:
    owner, disparity = landscape()
    where = box((-30.0, 30.0), (0.0, 4.0))
    put_plain(owner, disparity, where)
    _, regions, labels = regions_of(owner, disparity, 10)
    assert verdict(region_at(regions, labels, where)) == "UNKNOWN"


def test_a_plain_patch_of_the_ground_beside_a_post_is_no_wall() -> None:
    """A post stands at the corner of the patch: it is as far as the patch's near edge."""
    owner, disparity = landscape()
    ray = rays(CAMERA)
    ground = plane_disparity(CAMERA, (0, 1, 0), (0, GROUND_M, 0))
    at_m = SCALE / np.maximum(ground, 1e-3)
    patch = (owner == GROUND) & (at_m > 12) & (at_m < 30) & (np.abs(ray[..., 0] * at_m) < 3)
    owner[patch], disparity[patch] = WALL, -1.0
    put(owner, disparity, PILLAR, box((-3.4, -2.8), (0, 5), 12.0), 12.0)
    _, regions, labels = regions_of(owner, disparity, 11)
    assert verdict(region_at(regions, labels, patch & (owner == WALL))) != "ACCEPTED"


def test_a_plain_face_that_hangs_in_the_air_may_be_a_hole() -> None:
    owner, disparity, where = wall(foot_m=1.5)
    _, regions, labels = regions_of(owner, disparity, 2)
    assert verdict(region_at(regions, labels, where)) == "UNKNOWN"


@pytest.mark.parametrize("side", [-1, 1])
def test_one_edge_is_not_enough(side: int) -> None:
    owner, disparity, where = wall()
    beside = side * rays(CAMERA)[..., 0] > 0
    bare = np.where(where, -1.0, landscape()[1])
    disparity[beside] = bare[beside]
    _, regions, labels = regions_of(owner, disparity, 3)
    assert verdict(region_at(regions, labels, where)) == "UNKNOWN"


def test_sky_above_trees_and_between_pillars_is_no_obstacle() -> None:
    """It lies between two pillars of one range, above a row of trees: two edges agree, but it has no foot."""
    owner, disparity = landscape()
    put(owner, disparity, TREES, box((-40, 40), (0, 6), 60.0), 60.0)
    for x_m in (-3.0, 3.0):
        put(owner, disparity, PILLAR, box((x_m - 0.6, x_m + 0.6), (0, 6)))
    _, regions, labels = regions_of(owner, disparity, 4)
    assert verdict(region_at(regions, labels, owner == SKY)) == "UNKNOWN"
    assert not any(region.plain for region in regions)


def test_sky_in_a_frame_of_things_at_one_range_is_no_obstacle() -> None:
    """A window in a hedge: all its edges agree on the range, and yet it does not stand on the ground."""
    owner, disparity = landscape()
    put(owner, disparity, TREES, box((-5, 5), (0, 5.0)))
    window = box((-2, 2), (1.2, 4.2))
    owner[window], disparity[window] = SKY, -1.0
    _, regions, labels = regions_of(owner, disparity, 5)
    assert verdict(region_at(regions, labels, window)) == "UNKNOWN"


def test_a_plain_patch_of_the_ground_between_cars_is_no_obstacle() -> None:
    """Its foot is nearer than the cars beside it."""
    owner, disparity = landscape()
    patch = (owner == GROUND) & (np.abs(rays(CAMERA)[..., 0]) < 0.12) & (rays(CAMERA)[..., 1] < 0.27)
    owner[patch], disparity[patch] = WALL, -1.0
    for x_m in (-3.0, 3.0):
        put(owner, disparity, PILLAR, box((x_m - 1.2, x_m + 1.2), (0, 1.5)))
    _, regions, labels = regions_of(owner, disparity, 6)
    assert verdict(region_at(regions, labels, patch & (owner == WALL))) == "UNKNOWN"


def test_all_of_the_plain_region_is_in_the_collision_volume() -> None:
    owner, disparity, where = wall()
    stages, regions, labels = regions_of(owner, disparity, 7)
    region = region_at(regions, labels, where)
    volume = ffi.new(
        "vista_collision_volume *", {"radius_m": 1.0, "length_m": 100.0, "direction_camera": (0, 0, 1)}
    )
    words = np.full(owner.shape, INVALID, np.int16)  # nothing is asked of the words inside
    stages.see(words=words)
    lib.vista_collision_volume_count(stages.frame, volume, stages.cells, stages.regions)
    ray = rays(CAMERA)
    in_volume = np.hypot(ray[..., 0], ray[..., 1]) * SCALE / region.disparity_px <= 1.0
    expected = np.count_nonzero(in_volume & (labels == region.label))
    assert stages.regions.items[region.label].volume_pixels == pytest.approx(expected, rel=0.01)
    assert expected > 1000
