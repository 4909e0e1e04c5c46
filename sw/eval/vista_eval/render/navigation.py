"""What a navigation filter with faults records of a flight. The truth keeps what was flown."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from vista_eval.render.trajectory import BodyState, Course


@dataclass(frozen=True)
class PoseFaults:
    delay_s: float = 0.0  # each frame gets the pose of that long before
    drift_m_s: float = 0.0  # of the position, horizontally, from the first frame on
    drift_deg_s: float = 0.0  # of the attitude, about one axis
    lost: tuple[tuple[int, int], ...] = ()  # first frame and number of frames that repeat the pose before
    seed: int = 1  # of the drift's direction and axis


NO_FAULTS = PoseFaults()


def recorded_states(course: Course, faults: PoseFaults) -> list[BodyState]:
    """One a frame, at the frame's time."""
    states = [drifted(course, faults, frame) for frame in range(course.frames)]
    for first, count in faults.lost:
        for frame in range(max(first, 1), min(first + count, len(states))):
            states[frame] = replace(states[frame - 1], t_ns=states[frame].t_ns)
    return states


def drifted(course: Course, faults: PoseFaults, frame: int) -> BodyState:
    state = course.state_at(frame - faults.delay_s * course.rate_hz)
    random = np.random.default_rng(faults.seed)
    heading = random.uniform(0, 2 * np.pi)
    axis = random.standard_normal(3)
    axis /= np.linalg.norm(axis)
    drift_m_s = faults.drift_m_s * np.array([np.cos(heading), np.sin(heading), 0.0])
    age_s = frame / course.rate_hz
    pose = state.world_from_body.copy()
    pose[:3, :3] = pose[:3, :3] @ cv2.Rodrigues(axis * np.radians(faults.drift_deg_s) * age_s)[0]
    pose[:3, 3] += drift_m_s * age_s
    return BodyState(course.state_at(frame).t_ns, pose, state.velocity_world_m_s + drift_m_s)
