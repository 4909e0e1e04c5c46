"""The cuts: each equals scipy's minimum cut of the network that the data term describes; on drawn scenes the
regions are the things in them."""

from __future__ import annotations

from collections import deque

import numpy as np
import pytest
from random_seed import seeded
from scipy.ndimage import binary_dilation
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow
from stage_library import (
    FIRST_THING,
    GROUND,
    INVALID,
    SKY,
    Board,
    Stages,
    camera,
    street,
)

TIED = 1 << 29
UNKNOWN_LINK, MISMATCH_LINK, FLOW_SCALE = 0.03, 0.5, 10000.0  # of segmentation.c and affinity.h
NEVER_MERGE = {"segmentation.merge_ratio": 0.0}


# ---- the recursion against scipy ----


def steps_from(stages: Stages, seed: np.ndarray, passable: np.ndarray) -> np.ndarray:
    """Steps from the seed to every node over passable ones."""
    f = stages.foveation
    steps = np.full(f.node_count, f.node_count)
    steps[seed] = 0
    front = seed
    while front.size:
        arcs = np.isin(f.tail, front)
        front = np.unique(f.head[arcs])
        front = front[steps[front] == f.node_count]
        steps[front] = steps[np.unique(f.tail[arcs])[0]] + 1
        front = front[passable[front]]
    return steps


def data_term(stages: Stages, seeds, seed: int) -> np.ndarray:
    """Capacity of every free cell's link to T."""
    p, d = stages.parameters.segmentation, stages.disparity_px.astype(float)
    low, high = seeds.min_disparity_px[seed], seeds.max_disparity_px[seed]
    if high < 0:
        return np.zeros(d.size)
    beyond = np.clip(np.maximum(d - high, low - d), 0, 4)
    link = np.where(d < 0, UNKNOWN_LINK, MISMATCH_LINK * beyond)
    link = np.where(stages.horizontal != 0, p.horizontal_link, link)
    return np.floor(link * FLOW_SCALE + 1e-6)


def source_side(stages: Stages, nodes: np.ndarray, source: np.ndarray, sink: np.ndarray) -> np.ndarray:
    """Nodes that S reaches in the residual graph of scipy's maximum flow over these nodes; at a shell only
    intensities count."""
    f, count = stages.foveation, stages.foveation.node_count
    uncertain = (stages.shell[f.tail] | stages.shell[f.head]) != 0
    arc_capacity = np.where(uncertain, stages.intensity_capacity, stages.capacity)
    arcs = np.isin(f.tail, nodes) & np.isin(f.head, nodes)
    tail = np.concatenate([f.tail[arcs], np.full(nodes.size, count), nodes])
    head = np.concatenate([f.head[arcs], nodes, np.full(nodes.size, count + 1)])
    capacity = np.concatenate([arc_capacity[arcs], source[nodes], sink[nodes]]).astype(np.int32)
    network = csr_matrix((capacity, (tail, head)), shape=(count + 2,) * 2)
    residual = (network - maximum_flow(network, count, count + 1).flow).tocsr()
    residual.data = (residual.data > 0).astype(np.int32)
    residual.eliminate_zeros()
    reached = breadth_first_order(residual, count, return_predecessors=False)
    return reached[reached < count]


def cut_out_all(stages: Stages, seeds: list[np.ndarray], label: np.ndarray, first_label: int) -> int:
    """Cuts every seed out of the unlabelled nodes, in order; the next free label."""
    count = stages.foveation.node_count
    seed_of_node = np.full(count, -1)
    for k, seed in enumerate(seeds):
        seed_of_node[seed] = k
    for k, seed in enumerate(seeds):
        free = (label < 0) & (seed_of_node == -1)
        steps = steps_from(stages, seed, free)
        others = (seed_of_node >= 0) & (seed_of_node != k)
        far = steps >= stages.parameters.segmentation.reach
        source = np.where((seed_of_node == k) & (stages.shell == 0), TIED, 0)
        sink = np.where(others | far, TIED, data_term(stages, stages.seeds, k))
        sink[seed] = 0
        label[source_side(stages, np.flatnonzero(label < 0), source, sink)] = first_label + k
    return first_label + len(seeds)


def without_ground(stages: Stages, label: np.ndarray) -> np.ndarray:
    """The labels after the ground has left: cells that lie, unless they touch one of their region
    that stands; and where the ground's plane is known, cells without a disparity that are seen below the foot
    of the nearest cell of their region that has one, or that hang together with no known one."""
    f, d = stages.foveation, stages.disparity_px.astype(float)
    lies = stages.horizontal != 0
    same = label[f.tail] == label[f.head]
    at_foot = np.zeros(f.node_count, bool)
    at_foot[f.tail[same & (d > 0)[f.head] & ~lies[f.head]]] = True
    left = np.where(lies & ~at_foot, -1, label)
    s = stages.surfaces
    if not s.ground_found:
        return left
    nearest_px = np.where((left >= 0) & (d >= 0), d, -1.0)
    queue = deque(np.flatnonzero(nearest_px >= 0))
    first = np.searchsorted(f.tail, np.arange(f.node_count + 1))
    while queue:
        node = queue.popleft()
        for other in f.head[first[node] : first[node + 1]]:
            if nearest_px[other] < 0 and left[other] == left[node]:
                nearest_px[other] = nearest_px[node]
                queue.append(other)
    u, v = f.center_u - stages.camera.center_u_px, f.center_v - stages.camera.center_v_px
    ground_px = s.ground.offset + s.ground.slope_u * u.astype(float) + s.ground.slope_v * v.astype(float)
    below = ground_px > nearest_px + np.maximum(1.0, 0.05 * ground_px)
    return np.where((d < 0) & (below | (nearest_px < 0)), -1, left)


def random_scene(random: np.random.Generator, changes: dict[str, float]) -> Stages:
    stages = Stages(camera(64, 48), {"foveation.sector_count": 24} | changes)
    f = stages.foveation
    patch = (f.center_u // 12 + 8 * (f.center_v // 12)).astype(int)
    base = random.choice([3.0, 4.0, 6.0, 20.0], 100)[patch]
    words = np.rint(16 * (base + random.normal(0, random.choice([0.0, 0.1, 0.6]), f.node_count)))
    stages.disparity_px[:] = np.maximum(words, 0) / 16
    stages.disparity_px[random.random(f.node_count) < random.choice([0.01, 0.01, 0.1, 0.5, 0.8])] = -1
    stages.intensity[:] = random.uniform(0, 255, 100)[patch] + random.normal(0, 6, f.node_count)
    stages.horizontal[:] = (random.random(100) < random.choice([0.1, 0.3]))[patch]
    s = stages.surfaces
    s.ground_found = random.random() < 0.5
    s.ground.offset, s.ground.slope_u, s.ground.slope_v = random.uniform((-2, -0.1, 0.1), (4, 0.1, 0.8))
    stages.compare()
    return stages


@pytest.mark.slow
@pytest.mark.parametrize(
    "reach", [1, *(pytest.param(reach, marks=pytest.mark.same_c) for reach in (3, 1000))]
)
def test_the_labels_are_those_of_minimum_cuts_by_scipy(reach: int) -> None:
    random = seeded(reach)
    regions = taken = shells = ground = below = 0
    for _ in range(60):
        stages = random_scene(
            random,
            NEVER_MERGE
            | {
                "segmentation.reach": reach,
                "segmentation.seed_area_px2": random.choice([2.0, 30.0]),
                "segmentation.horizontal_link": random.choice([0.0, random.uniform(0, 3)]),
            },
        )
        expected = np.full(stages.foveation.node_count, -1)
        seeds = stages.find_obstacle_seeds()
        obstacles = cut_out_all(stages, seeds, expected, 0)
        in_seeds = sum(seed.size for seed in seeds)
        shells += np.count_nonzero(stages.shell)
        taken += np.count_nonzero(expected >= 0) - in_seeds
        before, expected = expected, without_ground(stages, expected)
        left = (before >= 0) & (expected < 0)
        ground += np.count_nonzero(left & (stages.horizontal != 0))
        below += np.count_nonzero(left & (stages.disparity_px < 0))
        count = cut_out_all(stages, stages.find_rest_seeds(expected), expected, obstacles)
        stages.segment()
        s = stages.segmentation
        if s.obstacle_count < obstacles:
            continue  # merged: a region of a cell or two, of one disparity with all around it
        assert np.array_equal(stages.label, expected)
        assert (s.obstacle_count, s.region_count, s.cut_count) == (obstacles, count, count)
        regions += obstacles
    assert regions > 20
    assert shells > 20
    assert taken > 50 or reach == 1  # the cuts gave free cells to seeds
    assert (ground > 5 and below > 5) or reach == 1


# ---- merging ----


def halves(stages: Stages, left_px: float, right_px: float) -> None:
    """A wall in two parts, each of one grey, with a step in disparity between them."""
    f = stages.foveation
    stages.disparity_px[:] = np.where(f.center_u < 30, left_px, right_px)
    stages.intensity[:] = np.where(f.center_u < 30, 60, 120)
    stages.horizontal[:] = 0
    stages.compare()


UNSCALED = camera(64, 48, baseline=1000.0)  # half a metre is no step there
FINE = {
    "foveation.sector_count": 48,
    "segmentation.seed_step_px": 0.125,
    "segmentation.seed_area_px2": 20.0,
}


def test_regions_without_a_jump_between_them_are_joined() -> None:
    """Steps of 0.25 px: two seeds, but the merging allows four times a seed's step."""
    merging = Stages(UNSCALED, FINE | {"segmentation.merge_ratio": 4.0})
    strict = Stages(UNSCALED, FINE | {"segmentation.merge_ratio": 1.0})
    for stages, regions in ((merging, 1), (strict, 2)):
        halves(stages, 20.0, 20.25)
        assert len(stages.find_obstacle_seeds()) == 2
        stages.segment()
        assert stages.segmentation.obstacle_count == regions
        assert stages.segmentation.region_count == regions
        assert np.array_equal(np.unique(stages.label), np.arange(regions))


def test_regions_with_a_jump_between_them_stay_apart() -> None:
    stages = Stages(UNSCALED, FINE | {"segmentation.merge_ratio": 4.0})
    halves(stages, 20.0, 26.0)
    stages.segment()
    assert stages.segmentation.obstacle_count == 2
    left = stages.foveation.center_u < 30
    assert np.all(stages.label[left] == 1) and np.all(stages.label[~left] == 0)  # the nearer one first


def test_a_short_contact_does_not_join() -> None:
    """Nothing is known along most of the border; a contact of a third of it joins, one of a 24th does not."""
    f = Stages(UNSCALED, FINE).foveation
    for contact, regions in ((16, 1), (2, 2)):
        stages = Stages(UNSCALED, FINE | {"segmentation.merge_ratio": 4.0})
        halves(stages, 20.0, 20.25)
        stages.disparity_px[(f.center_v >= contact) & (f.center_u >= 27) & (f.center_u < 33)] = -1
        stages.compare()
        stages.segment()
        assert stages.segmentation.obstacle_count == regions


@pytest.mark.parametrize(("first_row", "regions"), [(0, 2), (36, 1)])
def test_most_of_the_border_decides(first_row: int, regions: int) -> None:
    """The right part comes nearer from that row on, until the step is a jump (more than 0.5 px)."""
    merging = {"segmentation.merge_ratio": 4.0}
    stages = Stages(UNSCALED, FINE | merging)
    f = stages.foveation
    halves(stages, 20.0, 20.25)
    right = f.center_u >= 30
    stages.disparity_px[right] += 0.03 * np.maximum(f.center_v[right] - first_row, 0)
    stages.compare()
    assert len(stages.find_obstacle_seeds()) == 2
    stages.segment()
    assert stages.segmentation.obstacle_count == regions


def test_a_small_region_needs_a_share_of_its_own_border_only() -> None:
    """The patch touches the wall, whose border is many times as long as its own, on one side alone."""
    stages = Stages(UNSCALED, FINE | {"segmentation.merge_ratio": 4.0})
    halves(stages, 20.0, 20.25)
    f = stages.foveation
    patch = (f.center_u >= 30) & (f.center_u < 42) & (f.center_v >= 32) & (f.center_v < 36)
    stages.disparity_px[(f.center_u >= 30) & ~patch] = -1
    stages.compare()
    stages.segment()
    assert stages.segmentation.obstacle_count == 1


@pytest.mark.parametrize("slope", [0.0, 0.06])
def test_each_border_is_judged_by_its_own_edges(slope: float) -> None:
    """The middle of three strips is joined with its left neighbour, and stays beyond a jump to its right one,
    whichever of these is nearer on the whole and so is looked at first."""
    stages = Stages(UNSCALED, FINE | {"segmentation.merge_ratio": 4.0})
    u = stages.foveation.center_u
    halves(stages, 20.25, 20.0)
    stages.disparity_px[:] += np.where(u < 30, slope * (30 - u), 0.0)
    stages.disparity_px[u >= 45] = 20.8
    stages.compare()
    assert len(stages.find_obstacle_seeds()) == 3
    stages.segment()
    assert stages.segmentation.obstacle_count == 2


# ---- the ground leaves ----


@pytest.mark.parametrize("ground_known", [False, True])
def test_a_thing_cut_out_with_the_road_before_it_loses_the_road(ground_known: bool) -> None:
    """A board from the top of the image down to row 24, the road below it in the same grey, and no link
    that keeps the cut off the road. To the right both are bare: there the ground's plane alone tells."""
    no_links = {"segmentation.horizontal_link": 0.0}
    stages = Stages(
        camera(64, 48), no_links | {"segmentation.reach": 1000, "segmentation.seed_area_px2": 20.0}
    )
    f, s, foot_v, board_px = stages.foveation, stages.surfaces, 24.0, 10.0
    road = f.center_v > foot_v
    bare = (f.center_u > 40) & (f.center_v > 16)
    patch = (f.center_u < 20) & (f.center_v > 36)  # bare, with known road all around it
    bare |= patch
    ground_px = board_px + 0.5 * (f.center_v - foot_v)
    stages.disparity_px[:] = np.where(bare, -1.0, np.where(road, ground_px, board_px))
    stages.intensity[:] = 90
    stages.horizontal[:] = 0
    flat_px = np.where(bare, -1.0, board_px)
    known_px = stages.disparity_px.copy()
    stages.disparity_px[:] = flat_px
    stages.compare()
    stages.segment()
    assert np.all(stages.label == 0)  # one surface, as far as the cut can tell
    stages.disparity_px[:] = known_px
    stages.horizontal[:] = road & ~bare
    s.ground_found = ground_known
    s.ground.slope_v, s.ground.offset = 0.5, board_px + 0.5 * (stages.camera.center_v_px - foot_v)
    stages.compare()
    stages.segment()
    assert np.all(stages.label[~road] == 0)
    touching = np.zeros(f.node_count, bool)
    touching[f.tail[~road[f.head]]] = True
    known_road = road & ~bare
    assert np.all(stages.label[known_road & touching] == 0)  # its foot
    assert not np.any(stages.label[known_road & ~touching] == 0)
    below = bare & (ground_px > ground_px[known_road & touching].max() + 1.0)  # 1 px below the foot
    assert np.count_nonzero(below) > 20 and np.count_nonzero(below & patch) > 5
    assert np.all((stages.label[below] == 0) != ground_known)


# ---- drawn scenes ----


def overlap(labels: np.ndarray, thing: np.ndarray) -> tuple[int, float]:
    """The label that covers most of the thing, with its intersection over union."""
    inside = labels[thing]
    label = np.bincount(inside[inside >= 0]).argmax()
    both = np.count_nonzero(thing & (labels == label))
    return int(label), both / np.count_nonzero(thing | (labels == label))


def assert_dense(stages: Stages) -> None:
    s = stages.segmentation
    assert 0 <= s.obstacle_count <= s.region_count
    labels = np.unique(stages.label)
    assert np.array_equal(labels[labels >= 0], np.arange(s.region_count))
    assert labels[0] >= -1


BOARDS = [
    Board(-2.2, -1.0, 10.0, 2.5, 3.0, grey=40, rim_px=14.0),
    Board(1.0, -0.5, 14.0, 2.0, 3.5, grey=200, rim_px=14.0),
    Board(6.0, -1.0, 22.0, 3.0, 5.0, grey=60),
]


def test_boards_before_far_houses_become_regions() -> None:
    """Near and middle one without disparity inside: the cut closes over what the engine cannot match."""
    random = seeded(10)
    stages = Stages(camera())
    image, words, owner = street(stages.camera, BOARDS, random)
    labels = stages.partition(image, words)
    assert_dense(stages)
    found = []
    for k in range(len(BOARDS)):
        label, iou = overlap(labels, owner == FIRST_THING + k)
        assert iou > 0.8, k
        found.append(label)
    assert found == sorted(set(found))  # one each, nearest first
    assert found[-1] < stages.segmentation.obstacle_count


def test_a_thing_fattened_by_matching_is_cut_at_its_contrast() -> None:
    """Block matching gives the sky around a dark board the board's disparity, 5 px wide."""
    random = seeded(15)
    dark = Board(0.3, -2.5, 10.0, 3.0, 3.0, grey=40)
    stages = Stages(camera(), {"foveation.sector_count": 128})
    image, words, owner = street(stages.camera, [dark], random)
    board = owner == FIRST_THING
    fattened = binary_dilation(board, np.ones((11, 11)))
    words = np.where(fattened, np.median(words[board]), words).astype(np.int16)
    assert board.sum() / fattened.sum() < 0.88  # what the words alone would have
    assert overlap(stages.partition(image, words), board)[1] > 0.88


def test_sky_and_ground_belong_to_no_obstacle() -> None:
    random = seeded(11)
    stages = Stages(camera())
    image, words, owner = street(stages.camera, BOARDS, random)
    labels = stages.partition(image, words)
    obstacle = (labels >= 0) & (labels < stages.segmentation.obstacle_count)
    assert np.mean(obstacle[owner == SKY]) < 0.1
    # far ground is flat in disparity and touches the houses: what is clearly below the horizon counts
    near_ground = (owner == GROUND) & (words > 16 * 5)
    assert np.mean(obstacle[near_ground]) < 0.1
    assert np.mean(labels[owner == SKY] >= 0) > 0.9  # a region of the rest


def test_without_any_disparity_there_is_no_obstacle() -> None:
    stages = Stages(camera())
    image = np.full((240, 320), 128, np.uint8)
    for word in (INVALID, 0):  # 0: matched, but infinitely far
        stages.partition(image, np.full(image.shape, word, np.int16))
        assert stages.segmentation.obstacle_count == 0
        assert_dense(stages)


def test_one_disparity_everywhere_is_one_obstacle() -> None:
    stages = Stages(camera())
    image = seeded(14).integers(0, 256, (240, 320), np.uint8)
    stages.partition(image, np.full(image.shape, 16 * 12, np.int16))
    assert stages.segmentation.obstacle_count == 1
    assert np.all(stages.label == 0)
