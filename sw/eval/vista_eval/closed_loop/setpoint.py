"""The setpoint of a pilot, and the trajectory between two decisions."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

Vector = np.ndarray  # (3,), world


class Setpoint(NamedTuple):
    """What the vehicle is told at a moment, as an autopilot takes it."""

    velocity_m_s: Vector
    heading_rad: float  # about world z, from x
    position_m: Vector | None = None  # None: no place is held
    acceleration_m_s2: Vector = np.zeros(3)  # that belongs to the trajectory
    yaw_rate_rad_s: float = 0.0  # likewise, about world z


class Trajectory(Protocol):
    def at(self, after_s: float) -> Setpoint:
        """What is flown so long after the decision."""


class Steady:
    """One setpoint for as long as nothing else is decided."""

    def __init__(self, setpoint: Setpoint) -> None:
        self.setpoint = setpoint

    def at(self, after_s: float) -> Setpoint:
        """The velocity goes on, and so does the place that is held, if any."""
        return self.setpoint
