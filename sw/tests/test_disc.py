"""Distance of a disc from a segment against dense sampling."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from stage_library import ffi, lib


def random_case(random: np.random.Generator):
    turn = Rotation.random(random_state=int(random.integers(2**31))).as_matrix()
    direction = random.normal(size=3)
    disc = {
        "center_m": random.uniform(-3, 3, 3).tolist(),
        "axis_x": turn[0].tolist(),
        "axis_y": turn[1].tolist(),
        "half_x_m": float(10 ** random.uniform(-1.5, 0.8)),
        "half_y_m": float(10 ** random.uniform(-1.5, 0.7)),
    }
    segment = {
        "start_m": random.uniform(-2, 2, 3).tolist(),
        "direction": (direction / np.linalg.norm(direction)).tolist(),
        "length_m": float(random.uniform(0.1, 12)),
    }
    if random.random() < 0.2:  # the segment pierces the disc off its centre
        pierced = np.add(
            segment["start_m"], random.uniform(0, segment["length_m"]) * np.array(segment["direction"])
        )
        inside = random.uniform(-0.7, 0.7, 2) * [disc["half_x_m"], disc["half_y_m"]]
        disc["center_m"] = (pierced - inside @ turn[:2]).tolist()
    return disc, segment


def sampled_distance(disc: dict, segment: dict) -> tuple[float, float]:
    """Smallest distance of sample points of the disc from the segment, and how far apart the samples lie."""
    t, r = np.meshgrid(np.linspace(0, 2 * np.pi, 241), np.linspace(0, 1, 81))
    x, y = disc["half_x_m"] * r * np.cos(t), disc["half_y_m"] * r * np.sin(t)
    points = np.array(disc["center_m"]) + x[..., None] * disc["axis_x"] + y[..., None] * disc["axis_y"]
    offset = points - segment["start_m"]
    along = np.clip(offset @ segment["direction"], 0, segment["length_m"])
    gap = max(disc["half_x_m"], disc["half_y_m"]) * (1 / 80 + 2 * np.pi / 240) / 2
    return float(np.linalg.norm(offset - along[..., None] * segment["direction"], axis=-1).min()), gap


@pytest.mark.slow
@pytest.mark.same_c
def test_distances_are_those_of_dense_samples() -> None:
    random = seeded(1)
    touched = 0
    for _ in range(400):
        disc, segment = random_case(random)
        exact = lib.vista_disc_segment_distance(
            ffi.new("vista_disc *", disc), ffi.new("vista_line_segment *", segment)
        )
        sampled, gap = sampled_distance(disc, segment)
        assert sampled - gap <= exact <= sampled + 1e-6
        touched += exact < 1e-6
    assert touched > 40


def test_points_at_a_known_distance() -> None:
    """A point built from a boundary point, its normal and a height has a known distance."""
    random = seeded(2)
    for _ in range(500):
        disc, _ = random_case(random)
        a, b = disc["half_x_m"], disc["half_y_m"]
        t, out, height = random.uniform(0, 2 * np.pi), random.uniform(0, 10), random.uniform(-5, 5)
        normal = np.array([np.cos(t) / a, np.sin(t) / b])
        x, y = np.array([a * np.cos(t), b * np.sin(t)]) + out * normal / np.linalg.norm(normal)
        axes = np.array([disc["axis_x"], disc["axis_y"], np.cross(disc["axis_x"], disc["axis_y"])])
        point = disc["center_m"] + np.array([x, y, height]) @ axes
        found = lib.vista_disc_point_distance(
            ffi.new("vista_disc *", disc), ffi.new("double[3]", point.tolist())
        )
        assert found == pytest.approx(np.hypot(out, height), rel=1e-9, abs=1e-9)


def test_near_is_the_distance_against_the_radius() -> None:
    random = seeded(3)
    answers = set()
    for _ in range(500):
        disc, segment = random_case(random)
        pair = ffi.new("vista_disc *", disc), ffi.new("vista_line_segment *", segment)
        radius = random.uniform(0.1, 5)
        near = lib.vista_disc_near_segment(*pair, radius)
        assert near == (lib.vista_disc_segment_distance(*pair) <= radius)
        answers.add(near)
    assert answers == {True, False}
