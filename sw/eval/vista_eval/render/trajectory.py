"""The path of the aircraft: a straight approach at constant altitude and speed, with a helicopter's sway."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

FOOT_M = 0.3048
START_NS = 1_600_000_000_000_000_000

# (amplitude, frequency in Hz, phase in rad): incommensurable, so that no two frames see the same sway.
ROLL_DEG = ((0.6, 0.31, 0.4), (0.2, 1.3, 1.9))
PITCH_DEG = ((0.35, 0.23, 2.1), (0.15, 1.7, 0.3))
YAW_DEG = ((0.4, 0.17, 1.0), (0.1, 0.9, 2.6))
LATERAL_M = ((0.06, 0.21, 0.7),)
VERTICAL_M = ((0.04, 0.27, 1.6),)


@dataclass(frozen=True)
class BodyState:
    t_ns: int
    world_from_body: np.ndarray  # 4x4
    velocity_world_m_s: np.ndarray  # (3,)


def sway(terms: tuple[tuple[float, float, float], ...], t_s: float) -> float:
    return sum(a * math.sin(2 * math.pi * hz * t_s + phase) for a, hz, phase in terms)


def sway_rate(terms: tuple[tuple[float, float, float], ...], t_s: float) -> float:
    return sum(a * 2 * math.pi * hz * math.cos(2 * math.pi * hz * t_s + phase) for a, hz, phase in terms)


def rotation_from_angles(roll_deg: float, pitch_deg: float, yaw_deg: float) -> np.ndarray:
    """R = Rz(yaw) Ry(pitch) Rx(roll), body axes forward, left, up: positive pitch is nose down."""
    (cr, cp, cy), (sr, sp, sy) = (
        [f(math.radians(a)) for a in (roll_deg, pitch_deg, yaw_deg)] for f in (math.cos, math.sin)
    )
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


class Course(Protocol):
    """Where the body is in each frame and between frames, and what is known of the whole."""

    @property
    def frames(self) -> int: ...
    @property
    def rate_hz(self) -> float: ...
    @property
    def speed_m_s(self) -> float: ...
    @property
    def last_range_m(self) -> float: ...
    @property
    def altitude_m(self) -> float: ...
    def before_last_s(self, frame: float, /) -> float: ...
    def state_at(self, frame: float, /) -> BodyState: ...


@dataclass(frozen=True)
class Approach:
    """Straight along +x towards world x = 0."""

    altitude_m: float
    speed_m_s: float
    last_range_m: float  # from the body's origin to x = 0 in the last frame
    frames: int
    rate_hz: float
    sway_phase_s: float = 0.0  # lets flights differ
    sway_scale: float = 1.0

    def before_last_s(self, frame: float) -> float:
        """Time from the last frame, at most 0."""
        return (frame - self.frames + 1) / self.rate_hz

    def state_at(self, frame: float) -> BodyState:
        # Sway is counted from the end, so that a shorter approach is the end of a longer one.
        sway_s = self.before_last_s(frame) + self.sway_phase_s
        angles_deg = (self.sway_scale * sway(terms, sway_s) for terms in (ROLL_DEG, PITCH_DEG, YAW_DEG))
        pose = np.eye(4)
        pose[:3, :3] = rotation_from_angles(*angles_deg)
        pose[:3, 3] = (
            -self.last_range_m + self.speed_m_s * self.before_last_s(frame),
            self.sway_scale * sway(LATERAL_M, sway_s),
            self.altitude_m + self.sway_scale * sway(VERTICAL_M, sway_s),
        )
        drift_m_s = (self.sway_scale * sway_rate(terms, sway_s) for terms in (LATERAL_M, VERTICAL_M))
        velocity_m_s = np.array([self.speed_m_s, *drift_m_s])
        return BodyState(START_NS + round(frame / self.rate_hz * 1e9), pose, velocity_m_s)
