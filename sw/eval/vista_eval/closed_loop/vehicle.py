"""A multirotor with motors that saturate, drag and wind, and the controller that tracks setpoints with it.

The dynamics are those of rotorpy (MIT), with the airframe that PX4's own simulator uses: 1 kg, a thrust of
twice the weight, motors that lag by 50 ms. The controller is a cascade of position, velocity, attitude and
rates as autopilots have it. Where the rotors cannot give all that is asked, thrust comes first, then roll and
pitch, and yaw last, as in PX4's allocation; and the thrust makes up for the true tilt, as ArduPilot's does,
so that a vehicle that is still leaning does not sink."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from vista.errors import InputError

from vista_eval.closed_loop.setpoint import Setpoint

INSTALL = "pip install --no-deps rotorpy==3.0.0; pip install scipy"
GRAVITY_M_S2 = 9.81
STEP_S = 0.01
# The motors lag by 50 ms, so the tilt follows with 11 rad/s and the velocity with 3.
TILT_GAIN, RATE_GAIN = 120.0, 18.0
# The rotors' drag gives 6.5 rad/s2 of yaw at most, so the heading follows with 4 rad/s.
HEADING_GAIN, YAW_RATE_GAIN = 3.0, 6.0
MOST_TURN_RAD_S, MOST_TURN_RAD_S2 = 1.5, 4.0
LEAST_UPRIGHT = 0.5  # cosine of the tilt up to which the thrust makes up for it
THRUST_RANGE = 0.1, 0.9  # shares of the most: the rest is kept for roll and pitch
POSITION_GAIN, VELOCITY_GAIN, WIND_GAIN = 1.2, 3.0, 0.8
MOST_WIND_M_S2 = 2.5  # that the integral of the velocity's error makes up for
SMOOTHED_S = 0.05  # of the acceleration, as inertial sensors are filtered


@dataclass(frozen=True)
class Limits:
    """What the controller asks of the vehicle at most."""

    level_m_s2: float = 5.0
    upright_m_s2: float = 3.0


class State(NamedTuple):
    """The true state of the vehicle."""

    position_m: np.ndarray
    velocity_m_s: np.ndarray
    rotation: np.ndarray  # world_from_body
    rates_rad_s: np.ndarray  # in the body
    acceleration_m_s2: np.ndarray  # over the last SMOOTHED_S

    @property
    def heading_rad(self) -> float:
        return math.atan2(self.rotation[1, 0], self.rotation[0, 0])

    @property
    def world_from_body(self) -> np.ndarray:
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = self.rotation, self.position_m
        return pose


def airframe(control: str = "cmd_motor_thrusts", step_s: float = STEP_S) -> tuple[Any, Any]:
    """The model of rotorpy, by what it is controlled, and how rotations are made for it."""
    try:
        from rotorpy.vehicles.multirotor import Multirotor as Model
        from rotorpy.vehicles.px4_sihsim_quadx_params import quad_params
        from scipy.spatial.transform import Rotation
    except ModuleNotFoundError as error:
        raise InputError("vista fly", f"{error.name} is not installed: {INSTALL}") from None
    tolerances = {"method": "RK23", "rtol": 1e-3, "atol": 1e-5, "first_step": step_s}
    return Model(quad_params, control_abstraction=control, integrator_kwargs=tolerances), Rotation


class Multirotor:
    def __init__(
        self,
        position_m: np.ndarray,
        heading_rad: float,
        limits: Limits = Limits(),
        control: str = "cmd_motor_thrusts",
        step_s: float = STEP_S,
    ) -> None:
        self.limits = limits
        self._model, self._rotation = airframe(control, step_s)
        hover_rad_s = math.sqrt(self._model.mass * GRAVITY_M_S2 / 4 / self._model.k_eta)
        self._state = {
            "x": np.array(position_m, float),
            "v": np.zeros(3),
            "q": self._rotation.from_euler("z", heading_rad).as_quat(),
            "w": np.zeros(3),
            "wind": np.zeros(3),
            "rotor_speeds": np.full(4, hover_rad_s),
        }
        self._turn_rad_s = 0.0  # that is asked for
        self._against_wind = np.zeros(3)
        self._acceleration = np.zeros(3)

    @property
    def state(self) -> State:
        now = self._state
        rotation = self._rotation.from_quat(now["q"]).as_matrix()
        return State(now["x"].copy(), now["v"].copy(), rotation, now["w"].copy(), self._acceleration.copy())

    def step(self, setpoint: Setpoint, wind_m_s: np.ndarray) -> None:
        """Flies on for STEP_S."""
        self._turn(setpoint)
        force = self._model.mass * (self.asked_m_s2(setpoint) + np.array([0.0, 0.0, GRAVITY_M_S2]))
        self._state["wind"] = np.asarray(wind_m_s, float)
        before = self._state["v"]
        self._fly(force)
        acceleration = (self._state["v"] - before) / STEP_S
        self._acceleration += STEP_S / SMOOTHED_S * (acceleration - self._acceleration)

    def _fly(self, force_n: np.ndarray) -> None:
        """Flies on for STEP_S, after this force."""
        told = {"cmd_motor_thrusts": self.thrusts_n(force_n)}
        self._state = self._model.step(self._state, told, STEP_S)

    def _turn(self, setpoint: Setpoint) -> None:
        """Asks for the turn that brings the heading to the setpoint's, as fast as the yaw can follow."""
        off_rad = wrapped(setpoint.heading_rad - self.state.heading_rad)
        rate = setpoint.yaw_rate_rad_s + HEADING_GAIN * off_rad
        more = np.clip(rate, -MOST_TURN_RAD_S, MOST_TURN_RAD_S) - self._turn_rad_s
        self._turn_rad_s += float(np.clip(more, -MOST_TURN_RAD_S2 * STEP_S, MOST_TURN_RAD_S2 * STEP_S))

    def thrusts_n(self, force_n: np.ndarray) -> np.ndarray:
        """The thrust of each rotor that turns the vehicle's up to the force, and gives its upright part."""
        state, model = self.state, self._model
        most_n = model.k_eta * model.rotor_speed_max**2
        up = self.up(force_n)
        turning = np.array(  # rad/s2
            [
                -TILT_GAIN * up[1] - RATE_GAIN * state.rates_rad_s[0],
                TILT_GAIN * up[0] - RATE_GAIN * state.rates_rad_s[1],
                YAW_RATE_GAIN * (self._turn_rad_s - state.rates_rad_s[2]),
            ]
        )
        moment = model.inertia @ turning
        shares = model.TM_to_f * np.array([self.collective_n(force_n), *moment])
        thrust, tilt, yaw = shares[:, 0], shares[:, 1] + shares[:, 2], shares[:, 3]
        tilted = thrust + fitting(thrust, tilt, most_n) * tilt
        return tilted + fitting(tilted, yaw, most_n) * yaw

    def up(self, force_n: np.ndarray) -> np.ndarray:
        """The direction of the force, in the body."""
        return self.state.rotation.T @ force_n / np.linalg.norm(force_n)

    def collective_n(self, force_n: np.ndarray) -> float:
        """The thrust of all rotors whose upright part is the force's, within THRUST_RANGE."""
        most_n = 4 * self._model.k_eta * self._model.rotor_speed_max**2
        upright = max(float(self.state.rotation[2, 2]), LEAST_UPRIGHT)
        least, highest = (share * most_n for share in THRUST_RANGE)
        return float(np.clip(force_n[2] / upright, least, highest))

    def asked_m_s2(self, setpoint: Setpoint) -> np.ndarray:
        """The acceleration that brings the vehicle to the setpoint, within its limits."""
        velocity = np.array(setpoint.velocity_m_s, float)
        if setpoint.position_m is not None:
            velocity += POSITION_GAIN * (setpoint.position_m - self._state["x"])
        error = velocity - self._state["v"]
        asked = limited(VELOCITY_GAIN * error + setpoint.acceleration_m_s2, self.limits)
        if np.linalg.norm(error) < 1.0:  # otherwise it is not the wind that is made up for
            more = self._against_wind + WIND_GAIN * STEP_S * error
            self._against_wind = np.clip(more, -MOST_WIND_M_S2, MOST_WIND_M_S2)
        return asked + self._against_wind


def fitting(thrusts_n: np.ndarray, more_n: np.ndarray, most_n: float) -> float:
    """The share of more, up to 1, that can be added so that each rotor's thrust stays from 0 to most_n."""
    room = np.where(more_n > 0, most_n - thrusts_n, thrusts_n)
    return float(np.min(np.minimum(1.0, room / np.maximum(np.abs(more_n), 1e-9))))


def limited(acceleration: np.ndarray, limits: Limits) -> np.ndarray:
    level = float(np.hypot(acceleration[0], acceleration[1]))
    share = min(1.0, limits.level_m_s2 / level) if level > 0 else 1.0
    upright = float(np.clip(acceleration[2], -limits.upright_m_s2, limits.upright_m_s2))
    return np.array([share * acceleration[0], share * acceleration[1], upright])


def wrapped(angle_rad: float) -> float:
    return math.remainder(angle_rad, 2 * math.pi)
