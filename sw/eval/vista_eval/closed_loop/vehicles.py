"""What can be flown, and how the loop treats it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from vista_eval.closed_loop import betaflight, vehicle, wing
from vista_eval.closed_loop.setpoint import Setpoint
from vista_eval.closed_loop.vehicle import GRAVITY_M_S2, State
from vista_eval.closed_loop.world import World

ACCELERATION_M_S2 = 3.0  # that the planner may ask for: more turns the cameras to the ground and to the sky
BANK_DEG, ROLL_IN_S = 40.0, 0.5
# A multirotor's: a little less than the vehicle has, and how long it takes to tilt.
BRAKING_M_S2, BRAKE_LAG_S = 4.0, 0.35


class Vehicle(Protocol):
    @property
    def state(self) -> State: ...

    def step(self, setpoint: Setpoint, wind_m_s: np.ndarray) -> None:
        """Flies on for STEP_S."""


@dataclass(frozen=True)
class Kind:
    name: str
    make: Callable[[np.ndarray, float, float], Vehicle]  # of place, heading, speed
    needs: Callable[[], Any]  # raises InputError where something is not installed
    plan: dict[str, Any]  # parameters of the planner
    hovers: bool
    avoiding_m: Callable[[float], float]  # that it goes on at this speed before it stands or flies aside
    # The goal is reached, a waypoint passed, from so near.
    reached_m: float
    passed_m: float
    # The least: radius of the sphere around it, room that is asked for, speed.
    radius_m: float = 0.0
    room_m: float = 0.0
    speed_m_s: float = 0.0
    # Its cameras, unless others are asked for.
    width_px: int = 320
    view_deg: float = 87.0


MULTIROTOR = Kind(
    "multirotor",
    lambda position_m, heading_rad, speed_m_s: vehicle.Multirotor(position_m, heading_rad),
    vehicle.airframe,
    {"vehicle": "multirotor", "acceleration_max_m_s2": ACCELERATION_M_S2},
    hovers=True,
    avoiding_m=lambda speed_m_s: speed_m_s * BRAKE_LAG_S + speed_m_s**2 / (2 * BRAKING_M_S2),
    reached_m=2.0,
    passed_m=3.0,
)
VEHICLES: dict[str, Kind] = {
    kind.name: kind
    for kind in (
        MULTIROTOR,
        replace(
            MULTIROTOR,
            name="betaflight",
            make=lambda position_m, heading_rad, speed_m_s: betaflight.Betaflight(position_m, heading_rad),
            needs=betaflight.program,
        ),
        Kind(
            "fixed-wing",
            wing.FixedWing,
            wing.airframe,
            {"vehicle": "fixed_wing", "bank_max_deg": BANK_DEG},
            hovers=False,
            avoiding_m=lambda speed_m_s: speed_m_s * ROLL_IN_S + turn_radius_m(speed_m_s),
            reached_m=10.0,
            passed_m=10.0,
            radius_m=wing.SPAN_M / 2,
            room_m=3.0,
            speed_m_s=18.0,
            width_px=640,
            view_deg=70.0,
        ),
    )
}


def turn_radius_m(speed_m_s: float) -> float:
    return speed_m_s**2 / (GRAVITY_M_S2 * math.tan(math.radians(BANK_DEG)))


def fitted(world: World, kind: Kind) -> World:
    """The world as this vehicle flies it: no nearer and no slower than it can."""
    return replace(
        world,
        radius_m=max(world.radius_m, kind.radius_m),
        room_m=max(world.room_m, kind.room_m),
        speed_m_s=max(world.speed_m_s, kind.speed_m_s),
    )
