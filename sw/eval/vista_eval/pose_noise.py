"""Poses like those of a navigation filter: the exact ones with an error that drifts.

Position (each world axis) and attitude (each camera axis) err by a first-order Gauss-Markov process,
e' = -e / tau + white noise, stationary from the first frame on.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from vista.geometry import Pose

POSITION_SIGMA_M = 0.1
ATTITUDE_SIGMA_DEG = 0.3
CORRELATION_S = 10.0  # tau: slow beside a frame, short beside a flight


def noisy_poses(poses: list[Pose], times_ns: list[int], seed: int) -> list[Pose]:
    """world_from_camera of each frame, as the navigation filter says it."""
    random = np.random.default_rng(seed)
    sigma = np.repeat([POSITION_SIGMA_M, math.radians(ATTITUDE_SIGMA_DEG)], 3)
    error = sigma * random.standard_normal(6)
    noisy = []
    for k, pose in enumerate(poses):
        if k > 0:
            keep = math.exp(-(times_ns[k] - times_ns[k - 1]) / 1e9 / CORRELATION_S)
            error = keep * error + math.sqrt(1.0 - keep**2) * sigma * random.standard_normal(6)
        turn = cv2.Rodrigues(error[3:])[0]
        noisy.append(Pose(pose.rotation @ turn, pose.translation_m + error[:3]))
    return noisy
