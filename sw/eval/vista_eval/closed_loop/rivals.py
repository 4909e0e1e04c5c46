"""What flies the same worlds: a pilot, and the eyes that he has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from vista import parameters

from vista_eval.closed_loop.loop import Conditions, Flight, fly
from vista_eval.closed_loop.perception import Perception, Words, fitted_to
from vista_eval.closed_loop.pilots import BrakeOnly, Pilot, Straight
from vista_eval.closed_loop.vehicles import VEHICLES, fitted
from vista_eval.closed_loop.world import World

MakePilot = Callable[[Perception, parameters.Values, Conditions], Pilot]


def straight(perception: Perception, values: parameters.Values, conditions: Conditions) -> Pilot:
    return Straight()


def brake_only(perception: Perception, values: parameters.Values, conditions: Conditions) -> Pilot:
    return BrakeOnly()


def planner(perception: Perception, values: parameters.Values, conditions: Conditions) -> Pilot:
    from vista_eval.closed_loop.planned import WithPlanner

    return WithPlanner(perception, values, conditions.pose_noise)


@dataclass(frozen=True)
class Rival:
    name: str
    title: str
    pilot: MakePilot
    words: Words = "engine"
    forest: bool = False
    sees: bool = True
    hovers: bool = False  # it is for vehicles that can stand
    late: bool = True  # by the latency of the chain; else it decides at the moment of the exposure

    def fly(self, world: World, values: parameters.Values, conditions: Conditions) -> Flight:
        if not self.late:
            conditions = replace(conditions, latency_s=0.0)
        kind = VEHICLES[conditions.vehicle]
        world = fitted(world, kind)
        own = fitted_to(world, kind, values)
        return fly(
            world,
            lambda perception: self.pilot(perception, own, conditions),
            own,
            conditions,
            self.words,
            self.forest,
            self.sees,
        )


RIVALS: dict[str, Rival] = {
    rival.name: rival
    for rival in (
        Rival("none", "no avoidance", straight, sees=False),
        Rival("brake", "brake only", brake_only, hovers=True),
        Rival("planner", "planner", planner),
        Rival("perfect", "planner, perfect words", planner, words="perfect"),
        Rival("sgbm", "planner, words of SGBM", planner, words="SGBM"),
        Rival("obstacles", "planner, obstacles without the map", planner, words="obstacles"),
        Rival("alone", "planner, stereo alone", planner, words="clusters"),
        Rival("forest", "planner, forest in place of the cut", planner, forest=True),
        Rival("punctual", "planner without latency", planner, late=False),
    )
}
