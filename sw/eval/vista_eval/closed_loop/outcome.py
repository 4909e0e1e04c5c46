"""What a flight comes to, and why it was lost."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vista_eval.closed_loop.loop import REST_M_S, Flight, Moment, heading_off_rad
from vista_eval.closed_loop.progress import speeds_of
from vista_eval.closed_loop.vehicles import VEHICLES

NEAR_MISS_M = 1.5  # what the competition of SBFT and ICST calls a soft failure
BACK_S = 4.0  # before a collision in which its cause is looked for
ALONG_M = 2.0  # a warning is of what was hit if it is so near to it

BLIND = "nothing was looked at"
UNSEEN = "not in view"
UNWARNED = "in view, never warned of"
LATE = "warned of too late"
FLOWN_ON = "warned of in time"


@dataclass(frozen=True)
class Outcome:
    """One flight in numbers."""

    world: str
    family: str
    rival: str
    speed_m_s: float
    end: str  # reached, collision, held, late
    hit: str
    cause: str  # of a collision
    time_s: float
    way_m: float
    route_m: float
    nearest_m: float  # of the vehicle's middle to anything that stands
    clearance_m: float  # of its sphere
    stops: int  # that it came to rest on the way
    evasions: int  # times that it left the way that is best where nothing is in the way
    top_speed_m_s: float
    frames: int
    lost_frames: int

    @property
    def crashed(self) -> bool:
        return self.end == "collision"

    @property
    def detour(self) -> float:
        """The share that the way is longer than the route."""
        return self.way_m / self.route_m - 1.0


def outcome_of(flight: Flight, rival: str) -> Outcome:
    world, moments = flight.world, flight.moments
    places = np.array([moment.state.position_m for moment in moments])
    speeds = speeds_of(np.array([moment.t_s for moment in moments]), places).tolist()
    return Outcome(
        world.name,
        world.family,
        rival,
        world.speed_m_s,
        flight.end,
        flight.hit,
        cause_of(flight) if flight.end == "collision" else "",
        flight.time_s,
        flight.way_m,
        world.length_m,
        flight.nearest.distance_m,
        flight.nearest.distance_m - world.radius_m,
        stops_of(speeds, flight.end),
        begins([moment.decision.avoids for moment in moments[:-1]]),
        max(float(np.linalg.norm(moment.state.velocity_m_s)) for moment in moments),
        len(moments) - 1,
        flight.lost_frames,
    )


def stops_of(speeds_m_s: list[float], end: str) -> int:
    """How often the vehicle comes to rest after it set off, without the last rest at the goal."""
    set_off = next((k for k, speed in enumerate(speeds_m_s) if speed > 2 * REST_M_S), len(speeds_m_s))
    count = begins([speed < REST_M_S for speed in speeds_m_s[set_off:]])
    return count - 1 if end == "reached" and speeds_m_s[-1] < REST_M_S else count


def begins(states: list[bool]) -> int:
    """How often something begins."""
    return sum(now and not before for now, before in zip(states, [False, *states], strict=False))


def cause_of(flight: Flight) -> str:
    """Tells where the chain failed: whether what was hit was in view, and when it was first warned of."""
    if flight.moments[-1].record is None:
        return BLIND
    place = flight.moments[-1].state.position_m
    before = [m for m in flight.moments[:-1] if flight.time_s - m.t_s < BACK_S]
    half_view_rad = math.radians(flight.conditions.view_deg) / 2
    if not any(in_view(moment, place, half_view_rad) for moment in before):
        return UNSEEN
    warned = [moment for moment in before if warns_of(moment, place)]
    if not warned:
        return UNWARNED
    first = warned[0]
    speed = float(np.linalg.norm(first.state.velocity_m_s))
    return LATE if np.linalg.norm(place - first.state.position_m) < needed_m(flight, speed) else FLOWN_ON


def needed_m(flight: Flight, speed_m_s: float) -> float:
    """The way from the exposure of a frame that shows something to a place where it is avoided."""
    late_m = speed_m_s * flight.conditions.latency_s
    return late_m + VEHICLES[flight.conditions.vehicle].avoiding_m(speed_m_s)


def in_view(moment: Moment, place_m: np.ndarray, half_view_rad: float) -> bool:
    far = float(np.linalg.norm(place_m - moment.state.position_m)) > 1.0
    return far and heading_off_rad(moment.state, place_m) < half_view_rad


def warns_of(moment: Moment, place_m: np.ndarray) -> bool:
    """Whether the nearest collision, or the end of the free path, is no farther than the place."""
    record = moment.record
    if record is None or record.warning is None:
        return False
    return bool(
        record.warning.distance_m < float(np.linalg.norm(place_m - moment.state.position_m)) + ALONG_M
    )


def first_wrong(flight: Flight) -> Moment | None:
    """The last decision that led into a collision while there was still room to avoid it: where a look at the
    flight should begin. None: it did not crash."""
    if flight.end != "collision":
        return None
    place = flight.moments[-1].state.position_m
    for moment in reversed(flight.moments[:-1]):
        speed = float(np.linalg.norm(moment.state.velocity_m_s))
        if np.linalg.norm(place - moment.state.position_m) > needed_m(flight, speed):
            return moment
    return flight.moments[0]
