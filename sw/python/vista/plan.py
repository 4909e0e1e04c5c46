"""The planner of libvista (vista/plan.h): from what the detector knows of space to what is flown next."""

from __future__ import annotations

import time
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vista import native, parameters
from vista.detector import Detector
from vista.geometry import Array
from vista.pipeline import c_parameters
from vista.structs import Struct


class State(Struct):
    """The vehicle at the time of a decision: State.made(t_ns=..., position_m=..., ...)."""

    NAME = "vista_plan_state"
    t_ns: int
    position_m: Array
    velocity_m_s: Array
    acceleration_m_s2: Array
    up: Array
    heading: Array
    position_sigma_m: float


class Goal(Struct):
    """A place to fly to: Goal.made(from_m=..., to_m=..., speed_m_s=...)."""

    NAME = "vista_plan_goal"
    from_m: Array
    to_m: Array
    speed_m_s: float
    passed: bool


class Setpoint(Struct):
    """What the vehicle is told at a moment."""

    NAME = "vista_plan_setpoint"
    position_m: Array
    velocity_m_s: Array
    acceleration_m_s2: Array
    heading: Array
    yaw_rate_rad_s: float


class Option(Struct):
    """One manoeuvre that was weighed, and what became of it."""

    NAME = "vista_plan_option"
    NAMES: ClassVar = {
        "primitive": "plan_primitive",
        "ruling": "plan_ruling",
        "ends": "plan_ruling",
    }
    primitive: str
    ruling: str
    direction: Array
    speed_m_s: float
    cost_s: float
    free_m: float
    ends: str
    obstacle_id: int
    where_m: Array
    after_s: float


class Decision(Struct):
    """A decision: a trajectory that ends in an escape, and why it is this one."""

    NAME = "vista_plan_decision"
    NAMES: ClassVar = {"action": "plan_action"}
    PARTS: ClassVar = {"setpoint": Setpoint}
    action: str
    t_ns: int
    setpoint: Setpoint
    chosen: int
    escape_s: float
    escape_seen: bool
    step_s: float
    point_count: int
    circle_from: int
    looks: int

    @property
    def points(self) -> NDArray[np.void]:
        """The points of the trajectory, step_s apart, as an array of structs."""
        points: NDArray[np.void] = self.memory["points"][: self.point_count]
        return points

    @property
    def options(self) -> list[Option]:
        """The manoeuvres that were weighed, the cheapest first."""
        return Option.all_of(self.memory["options"][: int(self.memory["option_count"])])

    def at(self, after_s: float) -> Setpoint:
        """What is flown so long after the state."""
        ffi, lib = native.load("vista")
        setpoint = ffi.new("vista_plan_setpoint *")
        lib.vista_plan_at(self.in_c(), after_s, setpoint)
        return Setpoint.copied(ffi, setpoint)


class Planner:
    """The planner of one vehicle. It keeps the decision that it has committed to."""

    def __init__(self, values: parameters.Values | None = None) -> None:
        self._ffi, self._lib = native.load("vista")
        self._planner = self._ffi.new("vista_planner *")
        self._check(
            self._lib.vista_planner_start(
                self._planner, c_parameters(self._ffi, self._lib, values or parameters.defaults())
            )
        )
        self._decision = self._ffi.new("vista_plan_decision *")
        self.took_ms = 0.0  # processor time of the last decision

    @property
    def in_c(self) -> Any:
        """The vista_planner itself."""
        return self._planner

    def reset(self) -> None:
        """Forgets all decisions and where the vehicle was."""
        self._lib.vista_planner_reset(self._planner)

    def decide(self, detector: Detector, state: State, goal: Goal) -> Decision:
        """Decides after the detector has judged a frame. Raises ValueError for what is no state or goal."""
        arguments: tuple[Any, ...] = (self._planner, detector.in_c, state.in_c(), goal.in_c(), self._decision)
        start_ns = time.thread_time_ns()
        status = self._lib.vista_planner_decide(*arguments)
        self.took_ms = 1e-6 * (time.thread_time_ns() - start_ns)
        self._check(status)
        return Decision.copied(self._ffi, self._decision)

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status)
