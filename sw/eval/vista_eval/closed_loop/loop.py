"""The loop: exposure, detection, decision, flight; until the goal, a collision, or no progress."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from vista import parameters
from vista.geometry import Pose
from vista.history import FrameRecord

from vista_eval.closed_loop.camera import StereoCamera, rig_of
from vista_eval.closed_loop.collision import Geometry, Near
from vista_eval.closed_loop.perception import Perception, Words
from vista_eval.closed_loop.pilots import Decision, Leg, Pilot, Seen
from vista_eval.closed_loop.progress import Progress
from vista_eval.closed_loop.setpoint import Setpoint
from vista_eval.closed_loop.vehicle import STEP_S, State, wrapped
from vista_eval.closed_loop.vehicles import VEHICLES, Kind
from vista_eval.closed_loop.world import World
from vista_eval.pose_noise import PoseError
from vista_eval.render.course import START_NS
from vista_eval.render.optics import FlawedSensor
from vista_eval.render.rig import LEFT
from vista_eval.render.sensor import Sensor
from vista_eval.worlds.draws import draws

SET_OFF_M = 2.0
HELD_S = 8.0  # at rest for so long after it set off: it will not go on
REST_M_S = 0.3  # of the mean place over a period of the sway
# A flight takes at most so many times what its route takes at its speed, and so much more.
LONGEST, SLACK_S = 3.0, 20.0
DROP_OUT_FRAMES = 2


NOTHING = Near(math.inf, "")


@dataclass(frozen=True)
class Conditions:
    """How a flight is flown, apart from its world and its pilot."""

    rate_hz: float = 10.0
    latency_s: float = 0.05  # from the middle of the exposure to the command
    width_px: int = 320
    view_deg: float = 87.0  # from side to side
    noise_grey: float = 1.5
    drop_outs: float = 0.0  # probability of a frame that two of them are lost
    pose_noise: bool = False  # errors like those of a navigation filter
    glare: float = 0.0  # radiance of the sun's veil in the lens
    vehicle: str = "multirotor"


@dataclass(frozen=True)
class Moment:
    """What was true and what was known and decided, at the time of a decision."""

    t_s: float
    state: State
    near: Near  # the nearest since the decision before
    record: FrameRecord | None
    decision: Decision
    setpoint: Setpoint
    left: np.ndarray | None  # the newest image that was judged


@dataclass
class Flight:
    """One flight from its start to its end."""

    world: World
    conditions: Conditions
    moments: list[Moment] = field(default_factory=list)
    end: str = ""  # reached, collision, held, late
    hit: str = ""  # the thing
    time_s: float = 0.0
    way_m: float = 0.0
    nearest: Near = NOTHING  # to the vehicle's middle, over the flight
    lost_frames: int = 0


@dataclass(frozen=True)
class Exposed:
    """A pair that waits for the detector."""

    t_s: float
    t_ns: int
    pose: Pose  # told
    pair: tuple[np.ndarray, np.ndarray]
    disparity_px: np.ndarray | None


def fly(
    world: World,
    pilot_of: Callable[[Perception], Pilot],
    values: parameters.Values,
    conditions: Conditions = Conditions(),
    words: Words = "engine",
    forest: bool = False,
    sees: bool = True,
) -> Flight:
    """sees: whether there are cameras; a pilot who looks at nothing needs none."""
    rig, flight = rig_of(conditions.width_px, conditions.view_deg), Flight(world, conditions)
    camera = StereoCamera(world.scene, rig, sensor_of(conditions), world.seed) if sees else None
    perception = Perception(rig, values, words, forest)
    pilot, geometry = pilot_of(perception), Geometry(world.scene)
    kind = VEHICLES[conditions.vehicle]
    legs = legs_of(world, kind)
    heading = legs[0].to_m - legs[0].from_m
    vehicle = kind.make(legs[0].from_m, math.atan2(heading[1], heading[0]), world.speed_m_s)
    faults, drift = (
        Faults(world.seed, conditions.drop_outs),
        PoseError(world.seed) if conditions.pose_noise else None,
    )
    waiting: deque[Exposed] = deque()
    period_steps = round(1 / conditions.rate_hz / STEP_S)
    late_steps = round(conditions.latency_s / STEP_S)
    longest_s = LONGEST * world.length_m / world.speed_m_s + SLACK_S
    decision, decided_step, record, left = None, 0, None, None
    leg, step, rested_s, near, here = 0, 0, 0.0, NOTHING, geometry.nearest(legs[0].from_m)
    progress = Progress(legs[0].from_m)
    while not flight.end:
        state = vehicle.state
        if step % period_steps == 0:
            if faults.loses_frame():
                flight.lost_frames += 1
            elif camera is not None:
                waiting.append(exposed(camera, state, step * STEP_S, step // period_steps, drift, words))
        due = step % period_steps == late_steps % period_steps and step >= late_steps
        if due or decision is None:
            if waiting and step >= late_steps + round(waiting[0].t_s / STEP_S):
                frame = waiting.popleft()
                record = perception.judge(frame.pair, frame.t_ns, frame.pose, frame.disparity_px)
                left = frame.pair[LEFT]
            told = state if drift is None else state._replace(position_m=state.position_m + drift.position_m)
            t_s = step * STEP_S
            seen = Seen(t_s, time_ns(t_s), told, legs[leg], record, conditions.latency_s, kind)
            decision, decided_step = pilot.decide(seen), step
            flight.moments.append(
                Moment(t_s, state, near, record, decision, decision.trajectory.at(0.0), left)
            )
            near = NOTHING
        setpoint = decision.trajectory.at((step - decided_step) * STEP_S)
        if drift is not None and setpoint.position_m is not None:  # the autopilot errs by the same
            setpoint = setpoint._replace(position_m=setpoint.position_m - drift.position_m)
        vehicle.step(setpoint, world.wind_at(step * STEP_S))
        now = vehicle.state
        met, here = geometry.nearest_on_way(here, state.position_m, now.position_m, step * STEP_S, STEP_S)
        near = min(near, met, key=lambda one: one.distance_m)
        flight.nearest = min(flight.nearest, met, key=lambda one: one.distance_m)
        progress.take(now.position_m)
        step += 1
        flight.time_s = step * STEP_S
        at_rest = progress.speed_m_s < REST_M_S
        rested_s = rested_s + STEP_S if at_rest and progress.gone_m > SET_OFF_M else 0.0
        if met.distance_m < world.radius_m or now.position_m[2] < world.radius_m:
            flight.end, flight.hit = "collision", met.name if met.distance_m < world.radius_m else "ground"
        elif arrived(now.position_m, legs[leg], kind):
            leg += 1
            if leg == len(legs):
                flight.end = "reached"
        elif rested_s > (0.0 if decision.final else HELD_S):
            flight.end = "held"
        elif flight.time_s > longest_s:
            flight.end = "late"
    flight.way_m = progress.way_m
    last = flight.moments[-1]
    flight.moments.append(
        Moment(flight.time_s, vehicle.state, near, last.record, last.decision, last.setpoint, last.left)
    )
    return flight


def exposed(
    camera: StereoCamera, state: State, t_s: float, index: int, drift: PoseError | None, words: Words
) -> Exposed:
    pair = camera.expose(state.world_from_body, t_s, index)
    true = state.world_from_body @ camera.rig.body_from_camera(LEFT)
    pose, t_ns = Pose(true[:3, :3], true[:3, 3]), time_ns(t_s)
    told = pose if drift is None else drift.on(pose, t_ns)
    disparity_px = camera.disparity_px(state.world_from_body) if words == "perfect" else None
    return Exposed(t_s, t_ns, told, pair, disparity_px)


def sensor_of(conditions: Conditions) -> Sensor:
    sensor = Sensor() if conditions.glare == 0 else FlawedSensor(glare=conditions.glare)
    return sensor.with_noise(conditions.noise_grey)


def time_ns(t_s: float) -> int:
    return START_NS + round(t_s * 1e9)


def legs_of(world: World, kind: Kind) -> list[Leg]:
    """Ends that are passed: waypoints, and the goal too of a vehicle that cannot stop there."""
    ends = world.legs_m
    return [Leg(a, b, world.speed_m_s, k < len(ends) or not kind.hovers) for k, (a, b) in enumerate(ends, 1)]


def arrived(position_m: np.ndarray, leg: Leg, kind: Kind) -> bool:
    """Near the end of the leg; or, if it is passed, beyond it and not far off."""
    off_m = float(np.linalg.norm(position_m - leg.to_m))
    beyond = float((position_m - leg.to_m) @ (leg.to_m - leg.from_m)) > 0
    near_m = kind.passed_m if leg.passed else kind.reached_m
    return off_m < near_m or (leg.passed and beyond and off_m < 3 * near_m)


class Faults:
    """Frames that are lost."""

    def __init__(self, seed: int, drop_outs: float) -> None:
        self._random, self._drop_outs, self._left = draws(seed, "drop-outs"), drop_outs, 0

    def loses_frame(self) -> bool:
        if self._left == 0 and self._random.random() < self._drop_outs:
            self._left = DROP_OUT_FRAMES
        lost = self._left > 0
        self._left -= lost
        return bool(lost)


def heading_off_rad(state: State, point_m: np.ndarray) -> float:
    """The angle between where the cameras look and a point, level."""
    towards = point_m - state.position_m
    return abs(wrapped(math.atan2(towards[1], towards[0]) - state.heading_rad))
