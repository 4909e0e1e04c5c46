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


class PoseError:
    """The error of one flight, from frame to frame."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self._sigma = np.repeat([POSITION_SIGMA_M, math.radians(ATTITUDE_SIGMA_DEG)], 3)
        self._error = self._sigma * self._random.standard_normal(6)
        self._t_ns: int | None = None

    @property
    def position_m(self) -> np.ndarray:
        return self._error[:3]

    def on(self, pose: Pose, t_ns: int) -> Pose:
        """world_from_camera of the next frame, as the navigation filter says it."""
        if self._t_ns is not None:
            keep = math.exp(-(t_ns - self._t_ns) / 1e9 / CORRELATION_S)
            change = math.sqrt(1.0 - keep**2) * self._sigma * self._random.standard_normal(6)
            self._error = keep * self._error + change
        self._t_ns = t_ns
        turn = cv2.Rodrigues(self._error[3:])[0]
        return Pose(pose.rotation @ turn, pose.translation_m + self._error[:3])


def noisy_poses(poses: list[Pose], times_ns: list[int], seed: int) -> list[Pose]:
    """world_from_camera of each frame, as the navigation filter says it."""
    error = PoseError(seed)
    return [error.on(pose, t_ns) for pose, t_ns in zip(poses, times_ns, strict=True)]
