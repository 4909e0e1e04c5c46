"""The pilots that need no planner: who avoids nothing, and who only brakes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from vista.history import FrameRecord

from vista_eval.closed_loop.setpoint import Setpoint, Steady, Trajectory
from vista_eval.closed_loop.vehicle import State
from vista_eval.closed_loop.vehicles import Kind

# Before so long every pilot hovers or flies straight on, so that the detector has seen something.
LOOK_S = 1.0
AHEAD_M = 8.0  # of the point on the leg that is flown to
GENTLY_M_S2 = (
    2.0  # to speed up, and to slow down before the goal: a hard start turns the cameras to the ground
)
GENTLY_S = 1 / 3  # of the controller
MARGIN_M = 2.0
AT_REST_M_S = 0.3


class Leg(NamedTuple):
    from_m: np.ndarray
    to_m: np.ndarray
    speed_m_s: float
    passed: bool  # another leg follows


class Seen(NamedTuple):
    """What a pilot decides by."""

    t_s: float  # of the decision, since the start
    t_ns: int
    state: State  # at that time, as the navigation filter tells it
    leg: Leg
    record: FrameRecord | None  # of the newest frame; None: none was judged yet
    latency_s: float
    kind: Kind


@dataclass(frozen=True)
class Decision:
    trajectory: Trajectory
    action: str  # proceeds, evades, brakes, ...
    why: str = ""
    paths: list[tuple[np.ndarray, str]] = field(
        default_factory=list
    )  # weighed: points and what became of them
    final: bool = False  # nothing else will ever be decided

    @property
    def avoids(self) -> bool:
        """Whether it is another way than where nothing is in the way."""
        return self.action not in ("proceeds", "arrived", "looks")


class Pilot(Protocol):
    def decide(self, seen: Seen) -> Decision: ...


def along_leg(state: State, leg: Leg) -> Setpoint:
    """Flies along the leg at its speed, and slows down before its end unless it is passed."""
    way = leg.to_m - leg.from_m
    length = float(np.linalg.norm(way))
    way = way / length
    done = float((state.position_m - leg.from_m) @ way)
    ahead = leg.from_m + min(done + AHEAD_M, length + (AHEAD_M if leg.passed else 0.0)) * way
    towards = ahead - state.position_m
    left_m = float(np.linalg.norm(leg.to_m - state.position_m))
    speed = leg.speed_m_s if leg.passed else min(leg.speed_m_s, math.sqrt(2 * GENTLY_M_S2 * left_m))
    speed = min(speed, float(np.linalg.norm(state.velocity_m_s)) + GENTLY_M_S2 * GENTLY_S)
    velocity = speed * towards / max(float(np.linalg.norm(towards)), 1e-6)
    return Setpoint(velocity, math.atan2(way[1], way[0]))


def look(seen: Seen) -> Decision:
    """What is flown before anything is decided: it stands, or goes on if it cannot."""
    told = along_leg(seen.state, seen.leg)
    if seen.kind.hovers:
        told = Setpoint(np.zeros(3), told.heading_rad, seen.state.position_m)
    return Decision(Steady(told), "looks")


class Straight:
    """Avoids nothing."""

    def decide(self, seen: Seen) -> Decision:
        told = along_leg(seen.state, seen.leg)
        if seen.t_s < LOOK_S:
            return look(seen)
        return Decision(Steady(told), "proceeds")


class BrakeOnly:
    """Flies the leg until the nearest collision, or the end of what is seen to be free, comes within the
    stopping distance; then stops for good."""

    def __init__(self) -> None:
        self._held_m: np.ndarray | None = None
        self._why = ""

    def decide(self, seen: Seen) -> Decision:
        told = along_leg(seen.state, seen.leg)
        if seen.t_s < LOOK_S or seen.record is None:
            return look(seen)
        if not self._why:
            self._why = self.reason(seen, seen.record)
        if not self._why:
            return Decision(Steady(told), "proceeds")
        if self._held_m is None and np.linalg.norm(seen.state.velocity_m_s) < AT_REST_M_S:
            self._held_m = seen.state.position_m
        if self._held_m is not None:
            held = Steady(Setpoint(np.zeros(3), told.heading_rad, self._held_m))
            return Decision(held, "holds", self._why, final=True)
        return Decision(Steady(Setpoint(np.zeros(3), told.heading_rad)), "brakes", self._why)

    @staticmethod
    def reason(seen: Seen, record: FrameRecord) -> str:
        """Why the vehicle has to stop now; empty: it has not."""
        speed = float(np.linalg.norm(seen.state.velocity_m_s))
        stop_m = speed * seen.latency_s + seen.kind.avoiding_m(speed)
        # Both are measured from where the frame was taken.
        taken = record.world_from_camera
        since_m = 0.0 if taken is None else float(np.linalg.norm(seen.state.position_m - taken.translation_m))
        nearest = record.warning
        if nearest is not None and nearest.distance_m - since_m < stop_m + MARGIN_M:
            return f"#{nearest.id} at {nearest.distance_m:.1f} m"
        left_m = float(np.linalg.norm(seen.leg.to_m - seen.state.position_m))
        if speed > AT_REST_M_S and record.path_seen_m - since_m < min(stop_m, left_m):
            return f"free to {record.path_seen_m:.1f} m only"
        return ""
