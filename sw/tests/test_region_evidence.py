"""Evidence for and against a region: numpy over the same pixels, and what it makes of drawn things."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import INVALID, Stages, camera, ffi, lib, plane_disparity, rays, words_of

GREY = np.full((240, 320), 90, np.uint8)
GROUND_M = 2.0
SCALE = camera().focal_px * camera().baseline_m
HORIZONTAL_DEG, TOP_M = 55.0, 0.8  # of surface.h and region_evidence.c
ODDS = {"region.min_inlier_fraction": 0.35, "region.odds_prior": -2.0}


def verdict(region) -> str:
    return ffi.string(lib.vista_region_verdict_name(region.verdict)).decode()


def road() -> np.ndarray:
    """Disparity of level ground; not above 0 over the horizon."""
    return plane_disparity(camera(), (0, 1, 0), (0, GROUND_M, 0))


def box(u: tuple[float, float], v: tuple[float, float]) -> np.ndarray:
    row, column = np.mgrid[:240, :320]
    return (column >= u[0]) & (column < u[1]) & (row >= v[0]) & (row < v[1])


def weigh(words: np.ndarray, mask: np.ndarray, changes: dict[str, float] | None = None, seeds: int = 1):
    """The region of the cells that lie in the mask for the most part, and the stages that measured it."""
    stages = Stages(camera(), ODDS | (changes or {}))
    f = stages.foveation
    stages.foveate(GREY, words)
    stages.find_surfaces()
    inside = np.bincount(f.cell_of_pixel.ravel(), mask.ravel(), f.node_count)
    stages.label[:] = np.where(2 * inside > f.pixel_count, 0, -1)
    stages.segmentation.region_count, stages.segmentation.obstacle_count = 1, seeds
    (region,) = stages.measure_regions(words)
    return region, stages


def height_above_ground_m(stages: Stages, disparity_px: np.ndarray) -> np.ndarray:
    """The height of what is seen at each pixel above the plane found: two points on the pixel's ray."""
    s, c = stages.surfaces, stages.camera
    assert s.ground_found
    normal = np.array([s.ground.slope_u, s.ground.slope_v, s.ground.offset / c.focal_px]) / c.baseline_m
    depth_m = SCALE / np.maximum(disparity_px, 1e-9)
    return (1 - depth_m * (rays(c) @ normal)) / np.linalg.norm(normal)


@pytest.mark.parametrize("seeds", [0, 1])
def test_each_piece_of_evidence_is_what_numpy_makes_of_the_words(seeds: int) -> None:
    random = seeded(1)
    tops = []
    for _ in range(25):
        disparity = np.maximum(road(), 0.5)
        left, upper = random.uniform(20, 200), random.uniform(40, 150)
        mask = box((left, left + random.uniform(30, 100)), (upper, upper + random.uniform(30, 80)))
        mask &= random.random() < 0.5 or ~box((left + 10, left + 25), (0, 240))
        thing_px = SCALE / random.uniform(6, 15)
        disparity[mask] = np.where(
            random.random(np.count_nonzero(mask)) < random.uniform(0.6, 1), thing_px, 4.0
        )
        words = words_of(disparity, random, 0.1)
        words[random.random(words.shape) < random.uniform(0.0, 0.5)] = INVALID
        region, stages = weigh(words, mask, seeds=seeds)
        p, e = stages.parameters.region, region.evidence
        if e.sum == 0.0:
            continue  # an unknown one, judged by its outline
        drawn = (stages.label == 0)[stages.foveation.cell_of_pixel]
        valid = drawn & (words > 0)
        height_m = height_above_ground_m(stages, words / 16)[valid]
        low_m = min(p.min_height_m, 0.06 * SCALE / region.disparity_px)
        top_m = TOP_M * low_m / p.min_height_m
        assert region.valid_fraction == pytest.approx(valid.sum() / drawn.sum())
        assert region.standing_fraction == pytest.approx(np.mean(height_m >= low_m), abs=0.005)
        assert region.top_fraction == pytest.approx(np.mean(height_m >= top_m), abs=0.005)
        tops.append(region.top_fraction)

        consistent = region.boundary_inliers / region.boundary_valid
        size_m = np.sqrt(drawn.sum()) * stages.camera.baseline_m / region.disparity_px
        lean_deg = 0.0 if np.isnan(region.inclination_deg) else region.inclination_deg
        lean = np.clip((lean_deg - HORIZONTAL_DEG) / 15.0, 0, 1)
        assert e.height == pytest.approx(2.2 * region.standing_fraction + 1.4 * region.top_fraction)
        assert e.boundary == pytest.approx(-4.0 * (1 - min(consistent / 0.35, 1)))
        assert e.support == pytest.approx(0.4 * region.boundary_valid / region.boundary_pixels)
        assert e.size == pytest.approx(0.4 * np.log10(max(size_m, 0.05)), abs=0.02)
        assert e.lean == pytest.approx(-lean)
        assert e.origin == (0.0 if seeds else pytest.approx(-0.4))
        pieces = e.height + e.boundary + e.support + e.size + e.lean + e.origin
        assert e.sum == pytest.approx(-2.0 + pieces)
    assert len(tops) > 10 and np.ptp(tops) > 0.2


def test_words_by_chance_are_inconsistent() -> None:
    random = seeded(2)
    disparity, mask = np.maximum(road(), 0.5), box((120, 200), (90, 150))
    disparity[mask] = random.uniform(2, 60, np.count_nonzero(mask))
    words = words_of(disparity)
    region, _ = weigh(words, mask)
    assert verdict(region) == "INCONSISTENT"
    assert region.evidence.boundary < -2.0
    assert region.evidence.sum - region.evidence.boundary > 0  # it is the boundary that speaks against it


def test_a_hedge_along_the_way_is_an_obstacle() -> None:
    """2 m high, from 5 to 25 m beside the path, with 0.3 m of relief."""
    random = seeded(3)
    beside = plane_disparity(camera(), (1, 0, 0), (-1.8, 0, 0))
    ray, depth_m = rays(camera()), SCALE / np.where(beside > 0, beside, 1.0)
    mask = (beside > SCALE / 25) & (beside < SCALE / 5) & (GROUND_M - ray[..., 1] * depth_m < 2.0)
    mask &= ray[..., 1] * depth_m < GROUND_M
    relief_m = random.uniform(-0.15, 0.15, (30, 40)).repeat(8, 0).repeat(8, 1)
    hedge = plane_disparity(camera(), (1, 0, 0), (-1.8, 0, 0)) * (1 + relief_m / 1.8)
    words = words_of(np.where(mask, hedge, np.maximum(road(), 0.5)), random, 0.15)
    region, stages = weigh(words, mask)
    assert np.ptp(words[mask]) > 16 * 20
    assert stages.surfaces.ground_found
    assert verdict(region) == "ACCEPTED"
    assert region.standing_fraction > 0.7


def test_a_slab_of_road_is_horizontal() -> None:
    random = seeded(4)
    for _ in range(10):
        left, upper = random.uniform(10, 200), random.uniform(150, 190)
        mask = box((left, left + random.uniform(40, 100)), (upper, upper + 40))
        region, _ = weigh(words_of(road(), random, 0.1), mask)
        assert verdict(region) == "HORIZONTAL"
        assert region.standing_fraction < 0.05


def test_a_region_without_a_word_is_unknown() -> None:
    words, mask = words_of(road()), box((100, 200), (60, 160))
    words[box((80, 220), (40, 180))] = INVALID
    for seeds in (0, 1):
        assert verdict(weigh(words, mask, seeds=seeds)[0]) == "UNKNOWN"
    assert verdict(weigh(words, np.zeros_like(mask))[0]) == "UNKNOWN"
