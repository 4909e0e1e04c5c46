"""The course of an aircraft: straight, climbing, turning, blown about, with a helicopter's sway; and what a
navigation filter with faults records of it."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

FOOT_M = 0.3048
GRAVITY_M_S2 = 9.81
START_NS = 1_600_000_000_000_000_000

Terms = tuple[tuple[float, float, float], ...]  # amplitude, frequency in Hz, phase in rad

# Sway. Incommensurable, so that no two frames see the same.
ROLL_DEG: Terms = ((0.6, 0.31, 0.4), (0.2, 1.3, 1.9))
PITCH_DEG: Terms = ((0.35, 0.23, 2.1), (0.15, 1.7, 0.3))
YAW_DEG: Terms = ((0.4, 0.17, 1.0), (0.1, 0.9, 2.6))
LATERAL_M: Terms = ((0.06, 0.21, 0.7),)
VERTICAL_M: Terms = ((0.04, 0.27, 1.6),)

GUST_HZ = (0.13, 0.37, 0.83, 1.7)  # of each axis, a little off for each seed
GUST_SHARES = (0.75, 0.5, 0.35, 0.25)  # of the standard deviation; their squares sum to 1
GUST_TURN_DEG_PER_M_S = (1.6, 0.7, 0.9)  # roll, pitch, yaw that a gust of 1 m/s from aside or below makes


@dataclass(frozen=True)
class BodyState:
    t_ns: int
    world_from_body: np.ndarray  # 4x4
    velocity_world_m_s: np.ndarray  # (3,)


def sway(terms: Terms, t_s: float) -> float:
    return sum(a * math.sin(2 * math.pi * hz * t_s + phase) for a, hz, phase in terms)


def sway_rate(terms: Terms, t_s: float) -> float:
    return sum(a * 2 * math.pi * hz * math.cos(2 * math.pi * hz * t_s + phase) for a, hz, phase in terms)


def sway_integral(terms: Terms, t_s: float) -> float:
    return sum(-a * math.cos(2 * math.pi * hz * t_s + phase) / (2 * math.pi * hz) for a, hz, phase in terms)


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


@dataclass(frozen=True)
class Gusts:
    """Wind that changes, of the same standard deviation along each axis of the world."""

    sigma_m_s: float = 0.0
    seed: int = 1

    @functools.cache  # noqa: B019 (a few numbers for each flight)
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
        terms = [self.terms(axis) for axis in range(3)]
        return np.array([sway_integral(each, t_s) - sway_integral(each, 0) for each in terms])

    def turn_deg(self, t_s: float) -> np.ndarray:
        """Roll, pitch and yaw of an aircraft in them: from wind from the left it rolls to the right, from
        wind from below its nose goes down, and it turns into the wind."""
        _, aside, up = self.wind_m_s(t_s)
        return np.array(GUST_TURN_DEG_PER_M_S) * [-aside, up, -aside]


@dataclass(frozen=True)
class Course:
    """A straight flight, a climb, a descent or a coordinated turn at constant speed, that goes through
    (0, 0, altitude) along +x, but for gusts and sway."""

    altitude_m: float  # where the path meets x = 0
    speed_m_s: float  # through the air
    last_range_m: float  # from the body's origin in the last frame to that point, along the path
    frames: int
    rate_hz: float
    climb_deg: float = 0.0  # of the path against the horizon; less than 0: a descent
    bank_deg: float = 0.0  # more than 0: the left wing is up, the turn goes to the right, towards -y
    gusts: Gusts = Gusts()
    sway_phase_s: float = 0.0  # lets flights differ
    sway_scale: float = 1.0

    @property
    def turn_rate_rad_s(self) -> float:
        """The rate about world z, to the left. The wings carry the weight and bend the path."""
        return -GRAVITY_M_S2 * math.tan(math.radians(self.bank_deg)) / self.speed_m_s

    def before_last_s(self, frame: float) -> float:
        """Time from the last frame, at most 0. Sway and gusts are counted from there, so that a shorter
        course is the end of a longer one."""
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
        level = math.cos(climb)
        return np.array([math.cos(heading) * level, math.sin(heading) * level, math.sin(climb)])

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


@dataclass(frozen=True)
class PoseFaults:
    """What is wrong with the recorded poses. The truth keeps what was flown."""

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
