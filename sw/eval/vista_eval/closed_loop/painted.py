"""What a detector without a map of space would tell the planner: its obstacles before a far wall.

The planner flies where space was seen to be free, so eyes that know obstacles alone have to say what lies
between them. Here it is all that is nearer than a wall at FAR_M and above level ground, whose height is
known. Obstacles are rectangles of their extent at their distance; of stereo alone, every cluster of matches
is one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict

import numpy as np
from vista.engine import INVALID, SCALE, EngineParameters, StereoEngine
from vista.geometry import Pose
from vista.history import FrameRecord

from vista_eval.baselines.stereo_alone import label_clusters, thresholded
from vista_eval.render.rig import Rig
from vista_eval.rivals import ALONE_THRESHOLD

FAR_M, NEAREST_M = 60.0, 0.3


def background_m(rig: Rig, pose: Pose) -> np.ndarray:
    """(H, W) depth of the wall and of the ground at a height of 0."""
    cx, cy = rig.center_px
    u, v = np.meshgrid(np.arange(rig.width_px), np.arange(rig.height_px))
    rays = np.stack([(u - cx) / rig.focal_px, (v - cy) / rig.focal_px, np.ones(u.shape)], -1)
    sinks = -(rays @ pose.rotation[2])
    with np.errstate(divide="ignore"):
        ground_m = np.where(sinks > 0, pose.translation_m[2] / sinks, FAR_M)
    return np.asarray(np.clip(ground_m, NEAREST_M, FAR_M))


def of_obstacles(rig: Rig, pose: Pose, record: FrameRecord) -> np.ndarray:
    """(H, W) disparities of the confirmed obstacles before the wall."""
    depth_m = background_m(rig, pose)
    cx, cy = rig.center_px
    for obstacle in [] if record.blind else record.obstacles:
        if not obstacle.confirmed or obstacle.kind not in ("thing", "too_near"):
            continue
        x, y, z = pose.rotation.T @ (obstacle.position_m - pose.translation_m)
        if z < NEAREST_M:
            continue
        (u, v), (wide, high) = (cx + rig.focal_px * x / z, cy + rig.focal_px * y / z), obstacle.extent_m
        aside, aloft = (max(rig.focal_px * size / 2 / z, 1.0) for size in (wide, high))
        rows = slice(max(0, int(v - aloft)), max(0, int(np.ceil(v + aloft))))
        columns = slice(max(0, int(u - aside)), max(0, int(np.ceil(u + aside))))
        depth_m[rows, columns] = np.minimum(depth_m[rows, columns], z)
    return np.asarray(rig.focal_px * rig.baseline_m / depth_m, np.float32)


def cluster_maker(rig: Rig, stereo: EngineParameters) -> Callable[[np.ndarray, np.ndarray, Pose], np.ndarray]:
    """Makes disparities of a pair: its clusters of matches before the wall."""
    at = ALONE_THRESHOLD
    engine = StereoEngine(**asdict(thresholded(stereo, at.texture, at.uniqueness)))

    def made(left: np.ndarray, right: np.ndarray, pose: Pose) -> np.ndarray:
        words, smin = engine.compute_with_smin(left, right)
        good = np.where(smin <= at.sad * stereo.block_size**2, words, np.int16(INVALID))
        wall_px = rig.focal_px * rig.baseline_m / background_m(rig, pose)
        clustered = label_clusters(good, at.pixels) >= 0
        return np.asarray(np.where(clustered, np.maximum(words / SCALE, wall_px), wall_px), np.float32)

    return made
