"""Poses at given times out of a sampled trajectory, and what a frame gets of it."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from vista.errors import InputError
from vista.geometry import Array, Pose, rotation_from_quaternion, slerp
from vista.sequence.types import FrameFiles

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


class PoseSource(Protocol):
    """Poses in the world at any time, or at some."""

    def at(self, t_ns: int) -> Pose | None: ...

    def span(self) -> str:
        """Which time it covers, for messages: "it has ..."."""


class Trajectory:
    """world_from_body between samples: positions linearly, rotations by slerp. Times strictly increase."""

    def __init__(self, samples: list[Sample]) -> None:
        self._samples = samples
        self._times_ns = [sample.t_ns for sample in samples]

    def span(self) -> str:
        return f"it has {_span(self._times_ns)}"

    def first(self) -> Pose:
        return _pose(self._samples[0])

    def at(self, t_ns: int) -> Pose | None:
        """None outside the samples: nothing is extrapolated."""
        if not self._times_ns or not self._times_ns[0] <= t_ns <= self._times_ns[-1]:
            return None
        after = bisect_left(self._times_ns, t_ns)
        second = self._samples[after]
        if second.t_ns == t_ns:
            return _pose(second)
        first = self._samples[after - 1]
        fraction = (t_ns - first.t_ns) / (second.t_ns - first.t_ns)
        quaternion = slerp(first.quaternion, second.quaternion, fraction)
        position_m = np.asarray((1.0 - fraction) * first.position_m + fraction * second.position_m)
        return Pose(rotation_from_quaternion(quaternion), position_m)


def _pose(sample: Sample) -> Pose:
    return Pose(rotation_from_quaternion(sample.quaternion), sample.position_m)


def _span(times_ns: list[int]) -> str:
    return f"{min(times_ns) / 1e9:.3f} to {max(times_ns) / 1e9:.3f} s"


def with_poses(
    frames: Iterable[FrameFiles],
    trajectory: PoseSource,
    source: str | Path,
    body_from_left: Pose | None = None,
) -> tuple[tuple[FrameFiles, ...], tuple[str, ...]]:
    """The frames with the poses of the left camera, and notes: frames outside the time of the trajectory are
    left out. source: of the poses, for messages; body_from_left: where they are those of another body."""
    given = tuple(frames)
    posed = []
    for frame in given:
        world_from_body = trajectory.at(frame.t_ns)
        if world_from_body is not None:
            pose = world_from_body if body_from_left is None else world_from_body @ body_from_left
            posed.append(replace(frame, world_from_camera=pose))
    if not posed:
        asked = _span([frame.t_ns for frame in given])
        raise InputError(
            source, f"covers the time of none of the {len(given)} frames: {trajectory.span()}, they {asked}"
        )
    left_out = len(given) - len(posed)
    notes = (f"{left_out} of {len(given)} frames lie outside the time of {source}",) if left_out else ()
    return tuple(posed), notes
