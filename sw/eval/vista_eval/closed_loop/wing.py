"""A fixed wing with the dynamics of JSBSim, and the autopilot that tracks setpoints with it.

The airframe is the smallest with wings among those that JSBSim's wheel brings: `minisgs`, a model glider of
2.44 m span and 5 kg. Two things of it are changed when it is loaded. Its wing area, 42.23 square feet, is
ten times what its span, its chord and the areas of its tail come to: it is 4.223 here. And it has an engine:
a thrust along the fuselage of half the weight at most, which lags by 0.2 s.

The autopilot is laid out as those of PX4 and ArduPilot are: course and place beside the path ask for a
bank, the rate of climb for a pitch, airspeed for thrust; bank and pitch ask for rates, and rates for
deflections, scaled by the airspeed. Speed is that through the air, and only a little of it makes up for
being ahead or behind."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from vista.errors import InputError

from vista_eval.closed_loop.setpoint import Setpoint
from vista_eval.closed_loop.vehicle import GRAVITY_M_S2, SMOOTHED_S, STEP_S, State

INSTALL = "pip install jsbsim==1.3.3"
AIRFRAME, WING_AREA_FT2 = "minisgs", 4.223
SPAN_M, MASS_KG, AREA_M2 = 2.44, 5.02, 0.392
FT_M, LBF_N = 0.3048, 4.44822
START_ALTITUDE_M = 100.0  # above the sea, of the air's density
SUBSTEPS = 2
THRUST_SHARE, THRUST_LAG_S = 0.5, 0.2
SLOWEST_M_S = 14.5  # through the air: a tenth above where it stalls

# How fast errors are made up for.
PATH_RAD_S, PATH_DAMPING = 0.8, 0.8  # beside the path
MOST_ASIDE_M = 6.0
MOST_BANK_RAD, MOST_LIFT = math.radians(50.0), 1.1  # the coefficient is 1.26 at most
MOST_ALPHA_RAD = 0.16  # angle of attack, just below that of the most lift: nothing pulls beyond
ANGLE_S = 0.15  # in which an angle is to be reached, with rates of at most
MOST_ROLL_RAD_S, MOST_PITCH_RAD_S = 1.2, 0.8
HEIGHT_GAIN, MOST_CLIMB_M_S = 0.8, 4.0
CLIMB_GAIN, CLIMB_INTEGRAL = 0.06, 0.06  # radians of pitch for a metre a second of climb
SPEED_GAIN, SPEED_INTEGRAL = 1.0, 0.2
KEEP_UP_GAIN, MOST_KEEP_UP_M_S = 0.4, 1.5  # of the airspeed, for being behind

# Coefficients of the airframe, which deflections are reckoned with.
CHORD_M, DENSITY = 0.173, 1.213
ROLL_DAMPING, AILERON = 0.47, 0.25
PITCH_DAMPING, PITCH_STIFFNESS, ELEVATOR = 9.0 + 5.2, 0.573, 1.261
LIFT_0, LIFT_SLOPE = 0.48, 4.5
ADVERSE_YAW, AILERON_YAW, RUDDER = 0.18, 0.0115, 0.037
INERTIA = np.array([0.644, 0.427, 1.055])  # of roll, pitch and yaw, kg m^2
ARMS_M = np.array([SPAN_M, CHORD_M, SPAN_M])
AILERON_RAD = math.radians(20.0), math.radians(15.0)
ELEVATOR_RAD = math.radians(28.0), math.radians(23.0)
RUDDER_RAD = math.radians(16.0), math.radians(16.0)
RATE_S = np.array([0.1, 0.1, 0.3])  # in which rates are to be reached
TRIM_GAIN, SLIP_GAIN = 1.0, 1.0


@cache
def library() -> Any:
    try:
        import jsbsim
    except ModuleNotFoundError:
        raise InputError("--vehicle", f"jsbsim is not installed: {INSTALL}") from None
    jsbsim.FGJSBBase().debug_lvl = 0
    return jsbsim


def airframe() -> Any:
    """The model of JSBSim with wings of their size and an engine."""
    jsbsim = library()
    fdm = jsbsim.FGFDMExec(None)
    tree = ET.parse(Path(jsbsim.get_default_root_dir()) / "aircraft" / AIRFRAME / f"{AIRFRAME}.xml")
    root = tree.getroot()
    area = root.find("metrics/wingarea")
    assert area is not None
    area.text = str(WING_AREA_FT2)
    engine = ET.SubElement(ET.SubElement(root, "external_reactions"), "force", name="engine", frame="BODY")
    for tag, values in (("location", "000"), ("direction", "100")):
        vector = ET.SubElement(engine, tag, {"unit": "IN"} if tag == "location" else {})
        for axis, value in zip("xyz", values, strict=True):
            ET.SubElement(vector, axis).text = value
    with TemporaryDirectory() as folder:
        path = Path(folder) / AIRFRAME / f"{AIRFRAME}.xml"
        path.parent.mkdir()
        tree.write(path)
        if not fdm.load_model_with_paths(AIRFRAME, folder, folder, folder, True):
            raise InputError("--vehicle", f"JSBSim cannot load {AIRFRAME}")
    return fdm


class FixedWing:
    def __init__(self, position_m: np.ndarray, heading_rad: float, speed_m_s: float) -> None:
        """It flies level at this speed through the air, which it keeps."""
        self._fdm, self._speed_m_s = airframe(), max(speed_m_s, SLOWEST_M_S)
        alpha_rad = needed_alpha_rad(self._speed_m_s, 1.0)
        start = {
            "h-sl-ft": START_ALTITUDE_M / FT_M,
            "psi-true-rad": -heading_rad,
            "theta-rad": alpha_rad,
            "u-fps": self._speed_m_s * math.cos(alpha_rad) / FT_M,
            "w-fps": self._speed_m_s * math.sin(alpha_rad) / FT_M,
        }
        self._fdm.set_dt(STEP_S / SUBSTEPS)
        for name, value in start.items():
            self._fdm[f"ic/{name}"] = value
        self._fdm.run_ic()
        self._position = np.array(position_m, float)
        self._velocity = self.velocity_m_s()
        self._acceleration = np.zeros(3)
        self._thrust = 0.1
        self._pitch_rad = self._throttle = self._trim_rad = 0.0  # integrals

    def velocity_m_s(self) -> np.ndarray:
        found = [self._fdm[f"velocities/v-{axis}-fps"] for axis in ("north", "east", "down")]
        return np.array([found[0], -found[1], -found[2]]) * FT_M

    @property
    def state(self) -> State:
        roll, pitch, yaw = (self._fdm[f"attitude/{axis}-rad"] for axis in ("phi", "theta", "psi"))
        rates = [self._fdm[f"velocities/{axis}-rad_sec"] for axis in "pqr"]
        return State(
            self._position.copy(),
            self._velocity.copy(),
            rotation_of(roll, -pitch, -yaw),
            np.array([rates[0], -rates[1], -rates[2]]),
            self._acceleration.copy(),
        )

    def step(self, setpoint: Setpoint, wind_m_s: np.ndarray) -> None:
        """Flies on for STEP_S."""
        for axis, value in zip(("north", "east", "down"), wind_m_s * [1, -1, -1], strict=True):
            self._fdm[f"atmosphere/wind-{axis}-fps"] = value / FT_M
        self.deflect(*self.asked(setpoint))
        for _ in range(SUBSTEPS):
            self._fdm.run()
        before, self._velocity = self._velocity, self.velocity_m_s()
        self._position += STEP_S / 2 * (before + self._velocity)
        acceleration = (self._velocity - before) / STEP_S
        self._acceleration += STEP_S / SMOOTHED_S * (acceleration - self._acceleration)

    @property
    def angle_of_attack_rad(self) -> float:
        return float(self._fdm["aero/alpha-rad"])

    def asked(self, setpoint: Setpoint) -> tuple[float, float]:
        """Bank and pitch that bring it to the setpoint, in radians; sets the thrust."""
        told = np.asarray(setpoint.velocity_m_s, float)
        level = math.hypot(told[0], told[1])
        way = np.array([told[0], told[1], 0.0]) / level
        left = np.array([-way[1], way[0], 0.0])
        off = np.zeros(3) if setpoint.position_m is None else setpoint.position_m - self._position
        beside = limited(off @ left, MOST_ASIDE_M)
        aside = float(setpoint.acceleration_m_s2 @ left)
        aside += PATH_RAD_S**2 * beside - 2 * PATH_DAMPING * PATH_RAD_S * float(self._velocity @ left)
        most = most_bank_rad(self.air_m_s())
        bank = limited(math.atan(-aside / GRAVITY_M_S2), most)
        climb = limited(told[2] + HEIGHT_GAIN * off[2], MOST_CLIMB_M_S)
        self.push(climb, KEEP_UP_GAIN * float(off @ way))
        return bank, self.pitch_for(climb)

    def pitch_for(self, climb_m_s: float) -> float:
        air = self.air_m_s()
        missing = climb_m_s - float(self._velocity[2])
        self._pitch_rad = limited(self._pitch_rad + CLIMB_INTEGRAL * STEP_S * missing, 0.2)
        roll = self._fdm["attitude/phi-rad"]
        alpha = needed_alpha_rad(air, 1 / max(math.cos(roll), 0.5)) * math.cos(roll)
        asked = alpha + climb_m_s / air + CLIMB_GAIN * missing + self._pitch_rad
        left = MOST_ALPHA_RAD - self.angle_of_attack_rad
        return min(asked, self._fdm["attitude/theta-rad"] + left)

    def push(self, climb_m_s: float, keep_up_m_s: float) -> None:
        """Sets the thrust that climbs so fast at the airspeed."""
        air = self.air_m_s()
        wanted = self._speed_m_s + limited(keep_up_m_s, MOST_KEEP_UP_M_S)
        missing = max(wanted, SLOWEST_M_S) - air
        if abs(missing) < 1.0:  # otherwise the thrust is at its limit
            self._throttle = limited(self._throttle + SPEED_INTEGRAL * STEP_S * missing, 2.0)
        drag = drag_n(air, 1 / max(math.cos(self._fdm["attitude/phi-rad"]), 0.5))
        force = drag + MASS_KG * (GRAVITY_M_S2 * climb_m_s / air + SPEED_GAIN * missing + self._throttle)
        asked = float(np.clip(force / (MASS_KG * GRAVITY_M_S2), 0.0, THRUST_SHARE))
        self._thrust += STEP_S / THRUST_LAG_S * (asked - self._thrust)
        self._fdm["external_reactions/engine/magnitude"] = self._thrust * MASS_KG * GRAVITY_M_S2 / LBF_N

    def deflect(self, bank_rad: float, pitch_rad: float) -> None:
        """Sets the surfaces for this bank, to the right positive, and pitch, up positive."""
        fdm, air = self._fdm, self.air_m_s()
        roll, pitch = fdm["attitude/phi-rad"], fdm["attitude/theta-rad"]
        rates = np.array([fdm[f"velocities/{axis}-rad_sec"] for axis in "pqr"])
        turn = GRAVITY_M_S2 * math.tan(roll) / air  # coordinated
        asked = np.array(
            [
                limited((bank_rad - roll) / ANGLE_S, MOST_ROLL_RAD_S),
                limited((pitch_rad - pitch) / ANGLE_S, MOST_PITCH_RAD_S) + turn * math.sin(roll),
                turn * math.cos(roll),
            ]
        )
        missing = asked - rates
        self._trim_rad = limited(self._trim_rad + STEP_S * TRIM_GAIN * float(missing[1]), 0.3)
        pressure_n = DENSITY / 2 * air**2 * AREA_M2
        # Coefficients of the moments that make up for what is missing.
        roll_up, pitch_up, yaw_up = missing * INERTIA / RATE_S / (pressure_n * ARMS_M)
        damped = ROLL_DAMPING * asked[0] * SPAN_M / (2 * air)
        aileron = (damped + roll_up) / AILERON
        stiff = PITCH_STIFFNESS * self.angle_of_attack_rad + PITCH_DAMPING * asked[1] * CHORD_M / (2 * air)
        elevator = -(stiff + pitch_up) / ELEVATOR - self._trim_rad
        adverse = -ADVERSE_YAW * rates[0] * SPAN_M / (2 * air) + AILERON_YAW * aileron
        rudder = (adverse - yaw_up) / RUDDER - SLIP_GAIN * fdm["aero/beta-rad"]
        fdm["fcs/aileron-cmd-norm"] = share_of(aileron, AILERON_RAD)
        fdm["fcs/elevator-cmd-norm"] = share_of(elevator, ELEVATOR_RAD)
        fdm["fcs/rudder-cmd-norm"] = share_of(rudder, RUDDER_RAD)

    def air_m_s(self) -> float:
        return max(float(self._fdm["velocities/vt-fps"]) * FT_M, 5.0)


def needed_alpha_rad(air_m_s: float, load: float) -> float:
    """The angle of attack that carries so many times the weight."""
    lift = load * MASS_KG * GRAVITY_M_S2 / (DENSITY / 2 * air_m_s**2 * AREA_M2)
    return min((lift - LIFT_0) / LIFT_SLOPE, 0.2)


def most_bank_rad(air_m_s: float) -> float:
    """The bank that the wings carry level without coming near to a stall."""
    share = MASS_KG * GRAVITY_M_S2 / (DENSITY / 2 * air_m_s**2 * AREA_M2 * MOST_LIFT)
    return min(MOST_BANK_RAD, math.acos(min(share, 1.0)))


def drag_n(air_m_s: float, load: float) -> float:
    alpha = needed_alpha_rad(air_m_s, load)
    return DENSITY / 2 * air_m_s**2 * AREA_M2 * (0.0157 + 0.28 * alpha)


def share_of(angle_rad: float, most_rad: tuple[float, float]) -> float:
    """The deflection as a share of the most to its side."""
    return limited(angle_rad / most_rad[int(angle_rad > 0)], 1.0)


def limited(value: float, most: float) -> float:
    return min(max(float(value), -most), most)


def rotation_of(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """world_from_body of axes ahead, left, up: turned about up, then left, then ahead."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    about_up = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    about_left = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_ahead = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return np.asarray(about_up @ about_left @ about_ahead)
