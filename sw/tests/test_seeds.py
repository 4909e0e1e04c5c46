"""Seeds against connected components: which cells surely belong together, by networkx."""

from __future__ import annotations

import networkx
import numpy as np
import pytest
from random_seed import seeded
from stage_library import Stages, camera

FRAMES = 30
STEP_SLOPE, REST_AFFINITY, REST_AREA_PX2 = 0.02, 0.7, 60.0  # of seed_step.h, seeds.c and scales.h
FAR_FROM_METRES = 1000.0  # a baseline before which half a metre is no step and two metres are no gap


def random_stages(random: np.random.Generator) -> Stages:
    """Patches of one disparity with steps around the limit, cells without disparity, and horizontal ones."""
    changes = {
        "foveation.sector_count": 32,
        "segmentation.seed_step_px": random.uniform(0.1, 1.0),
        "segmentation.seed_area_px2": 10 ** random.uniform(0, 3),
    }
    stages = Stages(camera(120, 90, baseline=FAR_FROM_METRES), changes)
    f = stages.foveation
    patch = (f.center_u // 20 + 6 * (f.center_v // 20)).astype(int)
    base = random.uniform(2, 30, 100)[patch]
    words = np.rint(16 * (base + random.normal(0, random.uniform(0, 0.5), f.node_count)))
    stages.disparity_px[:] = np.maximum(words, 0) / 16
    stages.disparity_px[random.random(f.node_count) < 0.15] = -1
    stages.intensity[:] = random.uniform(0, 255, 100)[patch] + random.normal(0, 5, f.node_count)
    stages.horizontal[:] = (random.random(100) < 0.2)[patch]
    stages.compare()
    return stages


def components(stages: Stages, nodes: np.ndarray, arcs: np.ndarray, smallest_px2: float) -> list[set[int]]:
    """Sets of nodes joined along the arcs, with at least this area; unordered."""
    f = stages.foveation
    graph = networkx.Graph()
    graph.add_nodes_from(nodes.tolist())
    graph.add_edges_from(zip(f.tail[arcs].tolist(), f.head[arcs].tolist(), strict=True))
    area = f.size_px.astype(float) ** 2
    return [set(c) for c in networkx.connected_components(graph) if area[list(c)].sum() >= smallest_px2]


def assert_numbered(stages: Stages, seeds: list[np.ndarray]) -> None:
    seed_of_node = np.full(stages.foveation.node_count, -1)
    for k, seed in enumerate(seeds):
        seed_of_node[seed] = k
    assert np.array_equal(stages.seed_of_node, seed_of_node)


def test_obstacle_seeds_are_the_components_without_a_step() -> None:
    random = seeded(1)
    found = 0
    for _ in range(FRAMES):
        stages = random_stages(random)
        f, p, d = stages.foveation, stages.parameters.segmentation, stages.disparity_px.astype(float)
        standing = (d > 0) & (stages.horizontal == 0)
        i, j = f.tail, f.head
        limit = p.seed_step_px + STEP_SLOPE * f.arc_distance_px
        joined = standing[i] & standing[j] & (np.abs(d[i] - d[j]) <= limit)
        expected = components(stages, np.flatnonzero(standing), joined, p.seed_area_px2)
        seeds = stages.find_obstacle_seeds()
        assert sorted(map(sorted, expected)) == sorted(sorted(seed.tolist()) for seed in seeds)
        assert_numbered(stages, seeds)
        found += len(seeds)
    assert found > FRAMES


def test_obstacle_seeds_come_nearest_first_and_know_their_range() -> None:
    random = seeded(2)
    for _ in range(FRAMES):
        stages = random_stages(random)
        seeds = stages.find_obstacle_seeds()
        nearest = [stages.disparity_px[seed].max() for seed in seeds]
        assert nearest == sorted(nearest, reverse=True)
        for k, seed in enumerate(seeds):
            d = stages.disparity_px[seed]
            assert np.all(np.diff(d) <= 0)  # members run from near to far
            assert stages.seeds.max_disparity_px[k] == np.percentile(d, 95, method="higher")
            assert stages.seeds.min_disparity_px[k] == np.percentile(d, 5, method="lower")


FAR, NEAR, UNKNOWN = 3.0, 30.0, -1.0
AT_10_M = 20.0  # f B = 200 px m: a metre is 40 px wide there


def two_posts(gap_px: float, second_px: float, between_px: float) -> list[np.ndarray]:
    """Seeds of two posts, each 20 px wide, the first at 10 m, with this between them and around."""
    stages = Stages(camera())
    u = stages.foveation.center_u
    stages.disparity_px[:] = between_px
    stages.disparity_px[(u > 100) & (u < 120)] = AT_10_M
    stages.disparity_px[(u > 120 + gap_px) & (u < 140 + gap_px)] = second_px
    stages.horizontal[:] = 0
    stages.horizontal[stages.disparity_px == FAR] = 1  # what lies behind is ground, and no seed
    return stages.find_obstacle_seeds()


@pytest.mark.parametrize(
    ("gap_px", "second_px", "between_px", "seeds"),
    [
        (20, AT_10_M, UNKNOWN, 1),
        (60, AT_10_M, UNKNOWN, 1),
        (100, AT_10_M, UNKNOWN, 2),  # 2 m are 80 px
        (20, AT_10_M + 8, UNKNOWN, 2),  # 2.9 m nearer
        (20, AT_10_M, FAR, 2),  # one sees between them
    ],
)
def test_parts_of_one_thing_are_one_seed(
    gap_px: float, second_px: float, between_px: float, seeds: int
) -> None:
    assert len(two_posts(gap_px, second_px, between_px)) == seeds


def board_before(around_px: float, half_width_px: float) -> tuple[Stages, np.ndarray]:
    """Every member's distance from the edges of a board at 10 m; inside positive."""
    stages = Stages(camera())
    f = stages.foveation
    inside_px = half_width_px - np.maximum(np.abs(f.center_u - 159.5), np.abs(f.center_v - 119.5))
    stages.disparity_px[:] = np.where(inside_px > 0, AT_10_M, around_px)
    stages.horizontal[:] = 0
    stages.find_obstacle_seeds()
    return stages, inside_px


@pytest.mark.parametrize("around_px", [UNKNOWN, FAR])
def test_members_near_an_edge_of_depth_are_the_shell(around_px: float) -> None:
    stages, inside_px = board_before(around_px, 60.0)
    size = stages.foveation.size_px
    member = inside_px > 0
    assert stages.shell[member & (inside_px < 6 - 1.5 * size)].all()
    assert not stages.shell[inside_px > 6 + 1.5 * size].any()
    if around_px == UNKNOWN:
        assert not stages.shell[~member].any()


def test_what_is_in_front_takes_no_shell_from_what_it_hides() -> None:
    stages, inside_px = board_before(NEAR, 60.0)
    assert not stages.shell[inside_px > 0].any()
    assert stages.shell[inside_px < 0].any()  # the front has an edge of depth


def test_thin_things_have_no_shell() -> None:
    stages, inside_px = board_before(UNKNOWN, 4.0)
    assert np.count_nonzero(inside_px > 0) > 20
    assert not stages.shell.any()


def test_seeds_of_the_rest_are_the_components_of_high_affinity() -> None:
    random = seeded(3)
    found = 0
    for _ in range(FRAMES):
        stages = random_stages(random)
        f = stages.foveation
        label = np.where(random.random(f.node_count) < 0.2, random.integers(0, 5, f.node_count), -1)
        i, j = f.tail, f.head
        joined = (label[i] < 0) & (label[j] < 0) & (stages.horizontal[i] == stages.horizontal[j])
        joined &= stages.weight >= np.float32(REST_AFFINITY)
        expected = components(stages, np.flatnonzero(label < 0), joined, REST_AREA_PX2)
        seeds = stages.find_rest_seeds(label)
        assert sorted(map(sorted, expected)) == sorted(sorted(seed.tolist()) for seed in seeds)
        assert_numbered(stages, seeds)
        first = [seed.min() for seed in seeds]
        assert first == sorted(first)  # from the centre outwards
        assert all(stages.seeds.max_disparity_px[k] < 0 for k in range(len(seeds)))
        assert not stages.shell.any()
        found += len(seeds)
    assert found > FRAMES


@pytest.mark.parametrize(
    ("disparity_px", "step_px", "beyond"),
    [
        (25.0, 25 - 200 / (200 / 25 + 0.48), 1.02),
        (100.0, 100 - 200 / 2.12, 1.02),
        (4.0, 0.3, 1.3),
    ],  # at 2 m: 6 % of the range
)
def test_a_step_is_metres_nearby_and_pixels_far_away(
    disparity_px: float, step_px: float, beyond: float
) -> None:
    """f B = 200 px m. Half a metre behind 8 m (25 px) is 1.47 px; at 2 m it is 6 % of the range.
    Behind 50 m (4 px) it is 0.04 px, and 0.02 px a pixel between the cells are added to the 0.3."""
    stages = Stages(camera(64, 48), {"segmentation.seed_step_px": 0.3})
    stages.horizontal[:] = 0
    for share, seeds in ((0.98, 1), (beyond, 2)):
        behind_px = disparity_px - share * step_px
        stages.disparity_px[:] = np.where(stages.foveation.center_u < 32, disparity_px, behind_px)
        assert len(stages.find_obstacle_seeds()) == seeds


def test_without_disparity_there_is_no_obstacle_seed() -> None:
    stages = random_stages(seeded(4))
    for nothing in (-1.0, 0.0):
        stages.disparity_px[:] = nothing
        assert stages.find_obstacle_seeds() == []
    stages.disparity_px[:] = 9.0
    stages.horizontal[:] = 1
    assert stages.find_obstacle_seeds() == []
