"""Poses at given times out of a sampled trajectory, and what a frame gets of it."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass

import numpy as np

from vista.errors import InputError
from vista.geometry import Array, Pose, rotation_from_quaternion, slerp

UNIT_TOLERANCE = 1e-3  # quaternions are printed with six digits


@dataclass(frozen=True)
class Sample:
    t_ns: int
    position_m: Array  # 3
    quaternion: Array  # w, x, y, z; unit


def make_sample(culprit: str, t_ns: int, position_m: Array, quaternion: Array) -> Sample:
    """InputError for a quaternion (w, x, y, z) that is not of unit length."""
    norm = float(np.linalg.norm(quaternion))
    if abs(norm - 1.0) > UNIT_TOLERANCE:
        raise InputError(culprit, f"quaternion of length {norm:.4g}, expected 1")
    return Sample(t_ns, position_m, quaternion / norm)


class Trajectory:
    """world_from_body between samples: positions linearly, rotations by slerp. Times strictly increase."""

    def __init__(self, samples: list[Sample]) -> None:
        self._samples = samples
        self._times_ns = [sample.t_ns for sample in samples]

    def at(self, t_ns: int) -> Pose | None:
        """None outside the samples: nothing is extrapolated."""
        if not self._times_ns or not self._times_ns[0] <= t_ns <= self._times_ns[-1]:
            return None
        after = bisect_left(self._times_ns, t_ns)
        second = self._samples[after]
        if second.t_ns == t_ns:
            return Pose(rotation_from_quaternion(second.quaternion), second.position_m)
        first = self._samples[after - 1]
        fraction = (t_ns - first.t_ns) / (second.t_ns - first.t_ns)
        quaternion = slerp(first.quaternion, second.quaternion, fraction)
        position_m = np.asarray((1.0 - fraction) * first.position_m + fraction * second.position_m)
        return Pose(rotation_from_quaternion(quaternion), position_m)
