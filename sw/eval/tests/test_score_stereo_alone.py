"""Stereo alone: its cylinder against points one by one, its clusters against scipy's, its counts by hand."""

from __future__ import annotations

from pathlib import Path

import flight_on_disk as disk
import numpy as np
import pytest
from random_seed import seeded
from scipy import sparse
from vista.geometry import Pose
from vista_eval.baselines.stereo_alone import (
    PIXELS,
    Outcome,
    Threshold,
    clusters,
    flight_outcomes,
    least_word,
    misses_and_alarms,
    sweep,
)
from vista_eval.dataset.truth import FlightTruth
from vista_eval.metrics.comparison import Comparison, Point
from vista_eval.metrics.flight_path import CYLINDER_LENGTH_M, CYLINDER_RADIUS_M


def truth_of_the_rig() -> FlightTruth:
    rig = (disk.FOCAL_PX, disk.BASELINE_M, (disk.CU, disk.CV))
    return FlightTruth(Path(), "", "", "test", *rig, 10.0, 10.0, {}, (), ())


def test_the_cylinder_pixel_by_pixel() -> None:
    """A word is in the cylinder exactly if the point that it triangulates to is."""
    random = seeded(1)
    truth = truth_of_the_rig()
    angle = 0.05
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    pose = Pose(disk.WORLD_FROM_CAMERA @ turn, np.array([3.0, -2.0, 5.0]))
    direction = np.array([0.995, 0.1, 0.0]) / np.hypot(0.995, 0.1)
    least = least_word(truth, pose, direction, (disk.HEIGHT, disk.WIDTH))
    inside_count = 0
    for _ in range(3000):
        u, v, word = random.integers(0, disk.WIDTH), random.integers(0, disk.HEIGHT), random.integers(1, 1000)
        depth_m = 16.0 * disk.FOCAL_PX * disk.BASELINE_M / word
        ray = np.array([(u - disk.CU) / disk.FOCAL_PX, (v - disk.CV) / disk.FOCAL_PX, 1.0])
        offset_m = pose.rotation @ (depth_m * ray)
        along_m = offset_m @ direction
        aside_m = np.linalg.norm(offset_m - along_m * direction)
        inside = aside_m <= CYLINDER_RADIUS_M and 0.0 < along_m <= CYLINDER_LENGTH_M
        assert (word >= least[v, u]) == inside
        inside_count += inside
    assert 100 < inside_count < 2900


def test_clusters_against_a_graph() -> None:
    """Components of pixels that adjoin and differ by at most 16 words, by scipy."""
    random = seeded(2)
    for _ in range(20):
        words = (random.integers(1, 5, (30, 40)) * 12).astype(np.int16)
        words[random.random(words.shape) < 0.4] = -1
        number = np.arange(words.size).reshape(words.shape)
        edges = []
        for a, b in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
            linked = (words[a] >= 0) & (words[b] >= 0) & (abs(words[a] - words[b]) <= 16)
            edges.append(np.stack([number[a][linked], number[b][linked]]))
        i, j = np.concatenate(edges, axis=1)
        graph = sparse.coo_array((np.ones(len(i)), (i, j)), shape=(words.size, words.size))
        _, component = sparse.csgraph.connected_components(graph, directed=False)
        sizes = np.bincount(component[words.ravel() >= 0])
        expected = sorted(sizes[sizes >= 5], reverse=True)
        assert [cluster.pixels for cluster in clusters(truth_of_the_rig(), words, 5)] == expected


def test_a_cluster_says_where_it_is() -> None:
    words = np.full((disk.HEIGHT, disk.WIDTH), -1, np.int16)
    words[100:111, 200:221] = 160
    (cluster,) = clusters(truth_of_the_rig(), words, 10)
    place = cluster.place
    assert (cluster.pixels, place.u_px, place.v_px) == (231, 210.0, 105.0)
    assert (place.half_u_px, place.half_v_px) == (10.0, 5.0)
    depth_m = disk.FOCAL_PX * disk.BASELINE_M / 10.0
    x, y = (210.0 - disk.CU) / disk.FOCAL_PX, (105.0 - disk.CV) / disk.FOCAL_PX
    assert place.range_m == pytest.approx(depth_m * np.sqrt(1 + x * x + y * y))


def test_counts_by_hand() -> None:
    outcomes = [
        Outcome(10, 15, 6.0, seen_px=(0, 25, 400), false_px=(0, 0, 12, 90)),
        Outcome(10, 15, 6.0, seen_px=(39,), false_px=(40, 0)),
    ]
    assert misses_and_alarms(outcomes, 40) == (3, 2)
    assert misses_and_alarms(outcomes, 10) == (1, 3)
    points = sweep([[outcomes[0]], [outcomes[1]]])
    assert points[Threshold(10, 15, 6.0, 40)] == (3, 2)
    assert len(points) == len(PIXELS)


def test_who_beats_whom() -> None:
    ours = Point(None, missed=5, alarms=3)
    others = tuple(Point(None, *counts) for counts in ((4, 2), (4, 3), (5, 3), (9, 0), (0, 9), (3, 1)))
    comparison = Comparison(1, 50, 50, ours, others)
    assert [(p.missed, p.alarms) for p in comparison.beating] == [(4, 2), (3, 1)]
    assert [(p.missed, p.alarms) for p in comparison.equalling] == [(4, 2), (4, 3), (5, 3), (3, 1)]


def test_a_board_is_seen_and_the_sky_is_matched(tmp_path: Path) -> None:
    """Strict thresholds show the sign in every frame and nothing else; without any, the even sky matches as
    well."""
    from vista import parameters

    folder = disk.write_flight(tmp_path / "sign", frames=3, last_range_m=20.0)
    outcomes = {(o.texture, o.uniqueness, o.sad): o for o in flight_outcomes(folder, parameters.defaults())}
    strict, permissive = outcomes[100, 15, 6.0], outcomes[0, 0, 62.0]
    assert min(strict.seen_px) >= 80
    assert max(strict.false_px) < 80
    assert min(permissive.false_px) >= 320
