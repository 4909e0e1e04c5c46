"""The cuts of a real frame as flow problems: the host's own cells, affinities, surfaces and seeds."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from graph_cases import SEED_CAPACITY, FlowCase
from stage_library import Stages, camera
from vista import StereoEngine


def isolating_cuts(left_path: Path, right_path: Path, focal_px: float, baseline_m: float) -> list[FlowCase]:
    """One problem an obstacle seed, nearest first, over the whole graph: S is tied to the seed, T to all
    others and softly to the cells without disparity and on horizontal surfaces."""
    left, right = (cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in (left_path, right_path))
    stages = Stages(camera(left.shape[1], left.shape[0], focal_px, baseline_m))
    stages.foveate(left, StereoEngine(num_disparities=64).compute(left, right))
    stages.find_surfaces()
    stages.compare()
    seeds = stages.find_obstacle_seeds()
    f = stages.foveation
    forward = np.flatnonzero(f.tail < f.head)
    edges = np.stack([f.tail[forward], f.head[forward]], axis=1).astype(np.int32)
    capacity = stages.capacity[forward].copy()
    soft = np.where(stages.disparity_px < 0.0, 300, 0) + np.where(stages.horizontal == 1, 20000, 0)
    cases = []
    for number, members in enumerate(seeds):
        source, sink = np.zeros(f.node_count, np.int32), soft.astype(np.int32)
        sink[stages.seed_of_node >= 0] = SEED_CAPACITY // 2
        source[members], sink[members] = SEED_CAPACITY // 2, 0
        name = f"seed {number} of {left_path.parent.name}/{left_path.name}"
        cases.append(FlowCase(name, f.node_count, edges, capacity, capacity, source, sink))
    return cases
