"""Courses that climb, descend, turn and are blown about."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vista_eval.render.trajectory import (
    LATERAL_M,
    PITCH_DEG,
    ROLL_DEG,
    START_NS,
    VERTICAL_M,
    YAW_DEG,
    BodyState,
    rotation_from_angles,
    sway,
    sway_rate,
)

GRAVITY_M_S2 = 9.81
GUST_HZ = (0.13, 0.37, 0.83, 1.7)  # of each axis, a little off for each seed
GUST_SHARES = (0.75, 0.5, 0.35, 0.25)  # of the standard deviation; their squares sum to 1
GUST_TURN_DEG_PER_M_S = (1.6, 0.7, 0.9)  # roll, pitch, yaw that a gust of 1 m/s from aside or below makes

Terms = tuple[tuple[float, float, float], ...]  # amplitude, frequency in Hz, phase


@dataclass(frozen=True)
class Gusts:
    """Wind that changes, of the same standard deviation along each axis of the world."""

    sigma_m_s: float = 0.0
    seed: int = 1

    def terms(self, axis: int) -> Terms:
        random = np.random.default_rng((self.seed, axis))
        phases = random.uniform(0, 2 * math.pi, len(GUST_HZ))
        pitches = random.uniform(0.8, 1.25, len(GUST_HZ))
        return tuple(
            (math.sqrt(2) * share * self.sigma_m_s, hz * float(pitch), float(phase))
            for share, hz, pitch, phase in zip(GUST_SHARES, GUST_HZ, pitches, phases, strict=True)
        )

    def wind_m_s(self, t_s: float) -> np.ndarray:
        return np.array([sway(self.terms(axis), t_s) for axis in range(3)])

    def drift_m(self, t_s: float) -> np.ndarray:
        """The wind's way from time 0 on."""
        return np.array([carried(self.terms(axis), t_s) - carried(self.terms(axis), 0) for axis in range(3)])

    def turn_deg(self, t_s: float) -> np.ndarray:
        """Roll, pitch and yaw of an aircraft in them: from wind from the left it rolls to the right, from
        wind from below its nose goes down, and it turns into the wind."""
        _, aside, up = self.wind_m_s(t_s)
        return np.array(GUST_TURN_DEG_PER_M_S) * [-aside, up, -aside]


def carried(terms: Terms, t_s: float) -> float:
    """The integral of `sway`."""
    return sum(-a * math.cos(2 * math.pi * hz * t_s + phase) / (2 * math.pi * hz) for a, hz, phase in terms)


@dataclass(frozen=True)
class Manoeuvre:
    """A climb, a descent or a coordinated turn at constant speed, or a straight flight, that goes through
    (0, 0, altitude) along +x, but for gusts and sway."""

    altitude_m: float  # where the path meets x = 0
    speed_m_s: float  # through the air
    last_range_m: float  # from the body's origin in the last frame to that point, along the path
    frames: int
    rate_hz: float
    climb_deg: float = 0.0  # of the path against the horizon; less than 0: a descent
    bank_deg: float = 0.0  # more than 0: the left wing is up, the turn goes to the right, towards -y
    gusts: Gusts = Gusts()
    sway_phase_s: float = 0.0
    sway_scale: float = 1.0

    @property
    def turn_rate_rad_s(self) -> float:
        """About world z, to the left. The wings carry the weight and bend the path."""
        return -GRAVITY_M_S2 * math.tan(math.radians(self.bank_deg)) / self.speed_m_s

    def before_last_s(self, frame: float) -> float:
        """Time from the last frame, at most 0."""
        return (frame - self.frames + 1) / self.rate_hz

    def before_meeting_s(self, frame: float) -> float:
        """Time from when the body meets x = 0, less than 0."""
        return self.before_last_s(frame) - self.last_range_m / self.speed_m_s

    def path_m(self, t_s: float) -> np.ndarray:
        """(3,) at a time from the meeting, in still air."""
        level_m_s = self.speed_m_s * math.cos(math.radians(self.climb_deg))
        half_turn = self.turn_rate_rad_s * t_s / 2
        chord_m = level_m_s * t_s * float(np.sinc(half_turn / math.pi))
        rise_m = self.speed_m_s * math.sin(math.radians(self.climb_deg)) * t_s
        return np.array(
            [chord_m * math.cos(half_turn), chord_m * math.sin(half_turn), self.altitude_m + rise_m]
        )

    def direction(self, t_s: float) -> np.ndarray:
        """(3,) unit vector of flight through the air."""
        heading, climb = self.turn_rate_rad_s * t_s, math.radians(self.climb_deg)
        return np.array(
            [
                math.cos(heading) * math.cos(climb),
                math.sin(heading) * math.cos(climb),
                math.sin(climb),
            ]
        )

    def state_at(self, frame: float) -> BodyState:
        t_s = self.before_meeting_s(frame)
        sway_s = self.before_last_s(frame) + self.sway_phase_s
        heading_deg = math.degrees(self.turn_rate_rad_s * t_s)
        swaying_deg = [self.sway_scale * sway(terms, sway_s) for terms in (ROLL_DEG, PITCH_DEG, YAW_DEG)]
        steady_deg = np.array([self.bank_deg, -self.climb_deg, heading_deg])
        pose = np.eye(4)
        pose[:3, :3] = rotation_from_angles(*(steady_deg + swaying_deg + self.gusts.turn_deg(t_s)))
        offset_m, drift_m_s = (
            self.sway_scale * np.array([0.0, move(LATERAL_M, sway_s), move(VERTICAL_M, sway_s)])
            for move in (sway, sway_rate)
        )
        pose[:3, 3] = self.path_m(t_s) + self.gusts.drift_m(t_s) + offset_m
        velocity_m_s = self.speed_m_s * self.direction(t_s) + self.gusts.wind_m_s(t_s) + drift_m_s
        return BodyState(START_NS + round(frame / self.rate_hz * 1e9), pose, velocity_m_s)
