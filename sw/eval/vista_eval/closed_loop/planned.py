"""The pilot that flies by the planner of libvista."""

from __future__ import annotations

import math

import numpy as np
from vista import parameters
from vista.plan import Decision as Plan
from vista.plan import Goal, Option, Planner, State

from vista_eval.closed_loop.perception import UP_WORLD, Perception
from vista_eval.closed_loop.pilots import LOOK_S, Decision, Seen, look
from vista_eval.closed_loop.setpoint import Setpoint
from vista_eval.pose_noise import POSITION_SIGMA_M

MOST_PATHS = 40  # of those that were ruled out, in a film


class Planned:
    """A decision of the planner as a trajectory."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan

    def at(self, after_s: float) -> Setpoint:
        told = self._plan.at(after_s)
        heading_rad = math.atan2(told.heading[1], told.heading[0])
        return Setpoint(
            told.velocity_m_s, heading_rad, told.position_m, told.acceleration_m_s2, told.yaw_rate_rad_s
        )


class WithPlanner:
    def __init__(self, perception: Perception, values: parameters.Values, pose_noise: bool = False) -> None:
        self._detector, self.planner = perception.detector, Planner(values)
        self._sigma_m = POSITION_SIGMA_M if pose_noise else 0.0

    def decide(self, seen: Seen) -> Decision:
        leg, now = seen.leg, seen.state
        if seen.t_s < LOOK_S or seen.record is None:
            return look(seen)
        state = State.made(
            t_ns=seen.t_ns,
            position_m=now.position_m,
            velocity_m_s=now.velocity_m_s,
            acceleration_m_s2=now.acceleration_m_s2,
            up=UP_WORLD,
            heading=np.array([math.cos(now.heading_rad), math.sin(now.heading_rad), 0.0]),
            position_sigma_m=self._sigma_m,
        )
        goal = Goal.made(from_m=leg.from_m, to_m=leg.to_m, speed_m_s=leg.speed_m_s, passed=leg.passed)
        plan = self.planner.decide(self._detector, state, goal)
        options = plan.options
        return Decision(
            Planned(plan), plan.action, why_of(plan, options), paths_of(plan, options, now.position_m)
        )


def why_of(plan: Plan, options: list[Option]) -> str:
    """What is flown, and what ruled out the best of what is not."""
    flown = "as committed"
    if 0 <= plan.chosen < len(options):
        chosen = options[plan.chosen]
        flown = f"{chosen.primitive} at {chosen.speed_m_s:.1f} m/s"
    against = next((option for option in options if option.ruling.startswith("by_")), None)
    if plan.action == "proceeds" or against is None:
        return flown
    ruled = against.ruling.removeprefix("by_")
    what = f"#{against.obstacle_id}" if ruled == "obstacle" else ruled
    return f"{flown}; {against.primitive} is ruled out by {what} in {against.after_s:.1f} s"


def paths_of(plan: Plan, options: list[Option], position_m: np.ndarray) -> list[tuple[np.ndarray, str]]:
    """The trajectory that is flown, and lines to what ruled others out."""
    found = [
        (np.array([position_m, option.where_m]), option.ruling)
        for option in options
        if option.ruling.startswith("by_") and np.any(option.where_m)
    ][:MOST_PATHS]
    return [*found, (plan.points["position_m"], "chosen")]
