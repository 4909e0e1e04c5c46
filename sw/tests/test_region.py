"""Statistics and verdicts of the regions: numpy over the same pixels, and a drawn case for every verdict."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from random_seed import seeded
from region_cases import GREY, box, measure, verdict
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from stage_library import (
    INVALID,
    Stages,
    camera,
    ffi,
    lib,
    plane_disparity,
    words_of,
)


def boundary_pixels(stages: Stages, k: int) -> np.ndarray:
    """Pixels under cells of region k up to 5 px along the graph from one that has a neighbour outside."""
    f, inside = stages.foveation, stages.label == k
    within = inside[f.tail] & inside[f.head]
    arcs = (f.arc_distance_px[within].astype(float), (f.tail[within], f.head[within]))
    leaving = np.unique(f.tail[inside[f.tail] & ~inside[f.head]])
    distance = dijkstra(csr_matrix(arcs, shape=(f.node_count,) * 2), indices=leaving, min_only=True)
    return (distance <= 5.0)[f.cell_of_pixel]


# ---- statistics ----


def test_a_region_facing_the_camera_is_measured_like_numpy_does() -> None:
    """Noise, holes, a cell-sized hole and a far background in a tenth of the pixels."""
    random = seeded(1)
    for _ in range(20):
        stages = Stages(camera())
        center, half = random.uniform((60, 50), (260, 190)), random.uniform(15, 50, 2)
        mask = box(center, *half)
        true_px = random.uniform(5, 40)
        words = words_of(np.where(mask, true_px, 1.0), random, 0.2)
        words[random.random(words.shape) < 0.1] = 16
        words[random.random(words.shape) < 0.2] = INVALID
        words[box(center, 6, 6)] = INVALID
        (region,) = measure(stages, words, [mask])
        assert verdict(region) == "ACCEPTED"
        assert (region.label, region.node_count) == (0, np.count_nonzero(stages.label == 0))

        boundary = boundary_pixels(stages, 0)
        valid = boundary & (words >= 0)
        inliers = words[valid & (np.abs(words / 16 - true_px) < 2)] / 16  # 0.2 px of noise, the rest far off
        assert region.boundary_pixels == pytest.approx(np.count_nonzero(boundary), rel=0.03)
        assert region.boundary_valid == pytest.approx(np.count_nonzero(valid), rel=0.03)
        assert region.boundary_inliers == pytest.approx(inliers.size, rel=0.03)
        assert (region.slope_u, region.slope_v) == (0, 0)
        assert np.isnan(region.inclination_deg)  # noise makes no slope
        assert region.disparity_px == pytest.approx(inliers.mean(), abs=0.01)
        assert region.disparity_sigma_px == pytest.approx(inliers.std(), abs=0.01)


def test_a_board_is_where_its_pixels_are() -> None:
    for center, half in (((160, 120), 40), ((220, 90), 25)):
        mask = box(center, half, half)
        (region,) = measure(Stages(camera()), words_of(np.where(mask, 20.0, 1.0)), [mask])
        assert (region.mean_u_px, region.mean_v_px) == pytest.approx(center, abs=1.0)
        assert region.pixel_count == pytest.approx(np.count_nonzero(mask), rel=0.15)
        assert (region.cov_uu_px2, region.cov_vv_px2) == pytest.approx((half**2 / 3,) * 2, rel=0.2)
        assert region.cov_uv_px2 == pytest.approx(0.0, abs=0.05 * half**2)
        bounds = (region.min_u_px, region.max_u_px, region.min_v_px, region.max_v_px)
        assert bounds == pytest.approx([c + s * half for c in center for s in (-1, 1)], abs=6)


def test_a_wall_at_an_angle_is_measured_along_its_plane() -> None:
    """Its disparity spans many pixels, all of them inliers of the plane."""
    random = seeded(2)
    for turn in (0.8, -1.0, 1.2):
        stages = Stages(camera())
        normal, point = (np.sin(turn), 0, np.cos(turn)), (0.1 * np.sign(turn), 0, 8)
        disparity = plane_disparity(stages.camera, normal, point)
        mask = box((160 + 50 * np.sign(turn), 120), 60, 50)
        slope_u = float(np.diff(disparity, axis=1).mean())
        words = words_of(np.where(mask, disparity, 1.0), random, 0.1)
        (region,) = measure(stages, words, [mask])
        assert np.ptp(words[mask]) > 16 * 3
        assert verdict(region) == "ACCEPTED"
        assert (region.slope_u, region.slope_v) == pytest.approx((slope_u, 0.0), abs=0.01)
        assert region.inclination_deg == pytest.approx(0.0, abs=3.0)
        middle = disparity[round(region.mean_v_px), round(region.mean_u_px)]
        assert region.disparity_px == pytest.approx(middle, abs=0.2)
        assert region.disparity_sigma_px == pytest.approx(np.hypot(0.1, 1 / 16 / np.sqrt(12)), abs=0.08)
        valid = boundary_pixels(stages, 0) & (words >= 0)
        on_wall = valid & (np.abs(words / 16 - disparity) <= 1.0)
        assert region.boundary_valid == pytest.approx(np.count_nonzero(valid), rel=0.03)
        assert region.boundary_inliers == pytest.approx(np.count_nonzero(on_wall), rel=0.03)


def test_a_gap_between_two_things_is_no_surface_from_one_to_the_other() -> None:
    """Words at both of its edges, half a block of what stands on either side, and none between them. A wall
    at an angle with as few words in all, spread over it, is one."""
    random = seeded(3)
    for _ in range(10):
        half, near_px, far_px = int(random.integers(18, 30)), random.uniform(16, 24), random.uniform(6, 10)
        mask = box((160, 120), half, 40)
        u = np.arange(320)[None, :]
        edges = np.abs(u - 160) > half - 7
        two = words_of(np.where(mask & edges, np.where(u < 160, far_px, near_px), -1.0), random, 0.1)
        slanted_px = far_px + (near_px - far_px) * (u - 160 + half) / (2 * half)
        seen = random.permuted(np.tile(edges[0, 160 - half : 161 + half], (240, 1)), axis=1)
        spread = np.zeros_like(mask)
        spread[:, 160 - half : 161 + half] = seen
        wall = words_of(np.where(mask & spread, slanted_px, -1.0), random, 0.1)
        stages = Stages(camera())
        (gap,) = measure(stages, two, [mask])
        assert gap.slope_u == 0.0
        (region,) = measure(stages, wall, [mask])
        assert region.slope_u == pytest.approx((near_px - far_px) / (2 * half), rel=0.2)


def test_the_plane_is_refined_by_the_mean_of_the_boundary() -> None:
    """Skewed noise: the cells' medians stay on the wall, three tenths of the pixels lie 0.8 px nearer."""
    random = seeded(14)
    stages = Stages(camera())
    disparity = plane_disparity(stages.camera, (np.sin(0.8), 0, np.cos(0.8)), (0.1, 0, 8))
    mask = box((210, 120), 60, 50)
    skewed = disparity + 0.8 * (random.random(disparity.shape) < 0.3)
    (region,) = measure(stages, words_of(np.where(mask, skewed, -1.0)), [mask])
    middle = disparity[round(region.mean_v_px), round(region.mean_u_px)]
    assert region.disparity_px == pytest.approx(middle + 0.24, abs=0.08)


def test_the_mode_wins_over_a_polluted_mean() -> None:
    """A third of the boundary shows the background."""
    random = seeded(3)
    stages = Stages(camera())
    mask = box((160, 120), 40, 40)
    words = words_of(np.where(mask, 20.0, 3.0), random, 0.1)
    words[(random.random(words.shape) < 0.33) & mask] = 48
    (region,) = measure(stages, words, [mask])
    assert region.disparity_px == pytest.approx(20.0, abs=0.05)


def test_metric_tolerance_takes_relief_in() -> None:
    """f B = 200 px m; at 5 m a relief of 0.3 m is 2.3 px to either side; it is a pixel far away."""
    random = seeded(4)
    mask = box((160, 120), 40, 40)
    disparity = np.where(mask, random.choice([38.5, 40.0, 41.5], mask.shape), -1.0)
    words = words_of(disparity)
    found = []
    for baseline_m in (1000.0, 0.5):
        (region,) = measure(Stages(camera(baseline=baseline_m)), words, [mask])
        found.append(region.boundary_inliers / region.boundary_valid)
    assert found[0] < 0.75 and found[1] > 0.95


def test_a_mast_that_matching_has_widened_hardly_moves_the_centre() -> None:
    """A panel of 51 x 61 px on a mast of one pixel, both 5 px wider at each side: the mast has 1300 px."""
    mask = box((200, 60), 30, 30) | box((200, 150), 5, 60)
    words = words_of(np.where(mask, 20.0, 1.0), seeded(15), 0.1)
    (region,) = measure(Stages(camera()), words, [mask])
    assert np.nonzero(mask)[0].mean() > 80
    assert region.mean_v_px == pytest.approx(60 + 0.04 * 90, abs=3)
    assert region.mean_u_px == pytest.approx(200, abs=1)


def test_every_region_counts_alone() -> None:
    """Three regions at once give the same numbers as each of them alone."""
    random = seeded(5)
    masks = [box((60, 120), 30, 60), box((160, 100), 20, 20), box((260, 140), 25, 50)]
    disparity = np.ones(GREY.shape)
    for mask, d in zip(masks, (30.0, 12.0, 20.0), strict=True):
        disparity[mask] = d
    words = words_of(disparity, random, 0.1)
    together = Stages(camera())
    regions = measure(together, words, masks)
    assert together.regions.accepted_count == 3
    assert [region.label for region in regions] == [0, 1, 2]
    for region, mask in zip(regions, masks, strict=True):
        alone = Stages(camera())
        (single,) = measure(alone, words, [mask])
        for field in ("pixel_count", "mean_u_px", "boundary_inliers", "disparity_px", "verdict"):
            assert getattr(region, field) == getattr(single, field)


# ---- verdicts ----


def board(d: float = 20.0, half: tuple[float, float] = (30, 30), sigma: float = 0.1):
    """Words of a board before a far background, and where it is."""
    mask = box((200, 110), *half)
    return words_of(np.where(mask, d, 1.0), seeded(6), sigma), mask


def verdict_of(words: np.ndarray, mask: np.ndarray, **changes: float) -> str:
    stages = Stages(camera(), {f"region.{name}": value for name, value in changes.items()})
    (region,) = measure(stages, words, [mask])
    assert stages.regions.accepted_count == (verdict(region) == "ACCEPTED")
    return verdict(region)


def test_a_board_is_accepted() -> None:
    assert verdict_of(*board()) == "ACCEPTED"


def test_the_background_does_not_own_the_edge_of_what_stands_before_it() -> None:
    """Empty sky around a board that matching has widened: all its few disparities are the board's."""
    words, mask = board(half=(60, 60))
    words[~mask] = INVALID
    widened = cv2.dilate(words, np.ones((17, 17)))
    stages = Stages(camera())
    measure(stages, widened, [mask, ~mask])
    stages.segmentation.obstacle_count = 1  # the sky grew from no disparity of its own
    assert [verdict(region) for region in stages.measure_regions(widened)] == ["ACCEPTED", "UNKNOWN"]


def test_few_inliers_are_too_few() -> None:
    words, mask = board(half=(3, 3))
    assert verdict_of(words, mask, min_size_m=100.0) == "TOO_FEW_PIXELS"


def test_a_far_thing_needs_no_more_inliers_than_the_smallest_one_has_pixels() -> None:
    """A thing of s metres is s d / B pixels wide. More than 60 pixels are never asked for."""
    words, mask = board(d=20.0, half=(3, 3))
    (region,) = measure(Stages(camera()), words, [mask])
    assert region.boundary_inliers < 55
    side_m = np.sqrt(region.boundary_inliers) * 0.5 / 20.0
    for share, expected in ((1.05, "TOO_FEW_PIXELS"), (0.95, "ACCEPTED")):
        assert verdict_of(words, mask, min_size_m=share * side_m) == expected


def test_a_region_with_hardly_any_match_is_unknown() -> None:
    words, mask = board()
    shown = seeded(7).random(words.shape)
    for share, expected in ((0.0, "UNKNOWN"), (0.1, "UNKNOWN"), (0.25, "ACCEPTED")):
        assert verdict_of(np.where(shown < share, words, INVALID), mask) == expected


def test_random_disparity_is_inconsistent() -> None:
    words, mask = board(half=(60, 60))
    words[mask] = seeded(8).integers(16 * 2, 16 * 60, np.count_nonzero(mask))
    assert verdict_of(words, mask, min_inlier_fraction=0.5) == "INCONSISTENT"


def ground(height_m: float = 3.0) -> np.ndarray:
    return plane_disparity(camera(), (0, 1, 0), (0, height_m, 0))


@pytest.mark.parametrize("roll_deg", [0, 30])
def test_the_ground_is_horizontal(roll_deg: float) -> None:
    angle = np.radians(roll_deg)
    up = np.array([np.sin(angle), -np.cos(angle), 0.0])
    disparity = plane_disparity(camera(), up, -3 * up)
    words = words_of(disparity, seeded(9), 0.05)
    stages = Stages(camera())  # by its inclination alone
    (region,) = measure(stages, words, [box((160, 180), 60, 40)], up)
    assert verdict(region) == "HORIZONTAL"
    assert region.inclination_deg == pytest.approx(90, abs=3)


def test_a_patch_flat_on_the_ground_is_horizontal_however_it_seems_to_lean() -> None:
    """A strip of one disparity, 11 px high, as matching makes of a stain: within 0.3 m of the ground."""
    disparity = np.maximum(ground(), 1.0)
    strip = box((160, 180), 40, 5)
    disparity[strip] = ground()[180, 0]
    words = words_of(disparity)
    stages = Stages(camera(), {"region.min_height_m": 0.4})
    (region,) = measure(stages, words, [strip])
    assert not region.inclination_deg > 55.0
    assert region.standing_fraction < 0.05
    assert verdict(region) == "HORIZONTAL"


def test_what_stands_on_the_ground_is_accepted() -> None:
    disparity = np.maximum(ground(), 1.0)
    standing = box((160, 150), 20, 30)  # its foot on the ground at row 180
    disparity[standing] = ground()[180, 0]
    words = words_of(disparity)
    stages = Stages(camera(), {"region.min_height_m": 0.3})
    (region,) = measure(stages, words, [standing])
    assert verdict(region) == "ACCEPTED"
    on_ground = (stages.foveation.center_v > 130) & (stages.label < 0)
    stages.horizontal[:] = on_ground  # as it is, and not as found around the foot
    (region,) = stages.measure_regions(words)
    # of its 60 rows, all but those less than 0.3 m (6 px) above the foot
    assert region.standing_fraction == pytest.approx(0.9, abs=0.05)


def test_what_is_far_is_too_far() -> None:
    words, mask = board(d=4.0)
    words[~mask] = 0
    assert verdict_of(words, mask, min_disparity_px=4.5) == "TOO_FAR"
    assert verdict_of(words, mask, min_disparity_px=3.5) == "ACCEPTED"


def test_what_is_small_is_too_small() -> None:
    """41 px at 20 m (f = 400) are 2 m."""
    words, mask = board(d=10.0, half=(20, 20), sigma=0.0)
    limit_m = 0.06 * 20  # the limit in metres is at most 6 % of the range
    assert verdict_of(words, mask, min_size_m=limit_m) == "ACCEPTED"
    words, mask = board(d=10.0, half=(6, 7), sigma=0.0)
    assert verdict_of(words, mask, min_size_m=limit_m) == "TOO_SMALL"
    assert verdict_of(words, mask, min_size_m=0.3) == "ACCEPTED"


def test_the_first_reason_counts() -> None:
    words, mask = board(half=(9, 9))
    words[seeded(12).random(words.shape) < 0.1] = INVALID
    words[seeded(13).random(words.shape) < 0.1] = 0
    remedies = {
        "INCONSISTENT": ("odds_prior", -50.0, -2.0),
        "TOO_FAR": ("min_disparity_px", 200.0, 1.0),
        "TOO_SMALL": ("min_size_m", 10.0, 0.1),
    }
    changes = {name: strict for name, strict, _ in remedies.values()}
    for reason, (name, _, mild) in remedies.items():
        assert verdict_of(words, mask, **changes) == reason
        changes[name] = mild
    assert verdict_of(words, mask, **changes) == "ACCEPTED"


def test_an_empty_region_and_one_without_boundary_are_no_obstacles() -> None:
    stages = Stages(camera())
    words = np.full(GREY.shape, 160, np.int16)
    everywhere, nowhere = np.ones(GREY.shape, bool), np.zeros(GREY.shape, bool)
    regions = measure(stages, words, [nowhere, everywhere])
    assert [verdict(region) for region in regions] == ["UNKNOWN"] * 2
    assert regions[0].node_count == 0 and regions[1].boundary_pixels == 0
    assert stages.regions.accepted_count == 0
    assert measure(stages, words, []) == []


# ---- the chain so far, and errors ----


def test_the_same_frame_gives_the_same_regions() -> None:
    random = seeded(10)
    words, _ = board()
    image = random.integers(0, 256, GREY.shape, np.uint8)
    noise = random.integers(-200, 1000, GREY.shape).astype(np.int16)
    first, second = Stages(camera()), Stages(camera())
    second.run(image, noise)  # must leave nothing behind
    found = [[bytes(ffi.buffer(r)) for r in s.run(image, words)] for s in (first, second)]
    assert found[0] == found[1] and len(found[0]) > 0


def test_noise_is_measured_without_harm() -> None:
    random = seeded(11)
    for width, height in ((16, 16), (100, 75)):
        stages = Stages(camera(width, height), {"segmentation.seed_area_px2": 1.0})
        for _ in range(5):
            image = random.integers(0, 256, (height, width), np.uint8)
            limit = random.choice([100, 4096, 2**15])  # the last: no engine's words, from a bad file
            words = random.integers(-(2**15), limit, (height, width)).astype(np.int16)
            for region in stages.run(image, words):
                assert 0 <= region.boundary_inliers <= region.boundary_valid <= region.boundary_pixels
                if verdict(region) == "ACCEPTED":
                    assert 0 <= region.min_u_px <= region.mean_u_px <= region.max_u_px < width
                    assert 0 <= region.min_v_px <= region.mean_v_px <= region.max_v_px < height
                    assert region.cov_uu_px2 * region.cov_vv_px2 >= region.cov_uv_px2**2 - 1e-3


def test_verdicts_have_names() -> None:
    names = [ffi.string(lib.vista_region_verdict_name(k)).decode() for k in range(20)]
    known = names[: lib.VISTA_REGION_VERDICT_COUNT]
    assert known[0] == "ACCEPTED" and len(set(known)) == len(known) and "INVALID" not in known
    assert {*names} - {*known} == {"INVALID"}


def test_own_pixels_are_those_that_the_image_gives_to_the_region() -> None:
    """A board at 10 m before nothing; words of something nearer are not its own, nor what the image takes."""
    stages = Stages(camera())
    u, v = np.meshgrid(np.arange(320), np.arange(240))
    board = (np.abs(u - 160) <= 40) & (np.abs(v - 120) <= 30)
    words = np.where(board, 20 * 16, INVALID).astype(np.int16)
    image = np.where(board, 60, 200).astype(np.uint8)
    stages.partition(image, words)
    whole = stages.measure_regions(words)[0]
    assert abs(whole.min_u_px - 120) <= 1 and abs(whole.max_u_px - 200) <= 1
    elsewhere = board & (u % 4 == 0) & (v % 4 == 0)
    fewer = stages.measure_regions(np.where(elsewhere, 24 * 16, words).astype(np.int16))[0]
    assert fewer.pixel_count == pytest.approx(whole.pixel_count - elsewhere.sum(), abs=40)
    stages.region_of_pixel[:, 180:] = -1
    narrower = stages.compute_regions(words)[0]
    assert narrower.max_u_px == 179 and narrower.min_u_px == whole.min_u_px
    assert narrower.pixel_count < whole.pixel_count and narrower.mean_u_px < whole.mean_u_px - 5
