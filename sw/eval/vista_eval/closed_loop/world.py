"""A world to fly through: a scene, a route, the wind, and the vehicle's size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vista_eval.render.course import Gusts
from vista_eval.render.scene import Point, Scene

CALM = Gusts()


@dataclass(frozen=True)
class World:
    name: str
    family: str
    scene: Scene  # as it stands when the flight begins
    route_m: tuple[Point, ...]  # from the start over waypoints to the goal
    speed_m_s: float
    radius_m: float = 0.35  # of the sphere around the vehicle
    room_m: float = 1.5  # between the vehicle's middle and everything, that is asked for
    wind_m_s: Point = (0.0, 0.0, 0.0)
    gusts: Gusts = CALM
    seed: int = 1

    @property
    def legs_m(self) -> list[tuple[np.ndarray, np.ndarray]]:
        points = [np.array(point, float) for point in self.route_m]
        return list(pairwise(points))

    @property
    def length_m(self) -> float:
        return sum(float(np.linalg.norm(end - start)) for start, end in self.legs_m)

    def wind_at(self, t_s: float) -> np.ndarray:
        return np.array(self.wind_m_s) + self.gusts.wind_m_s(t_s)


@dataclass(frozen=True)
class Family:
    """Worlds of one definition, by number; the same number and seed is the same world."""

    name: str
    title: str
    build: Callable[[int, int, float | None], World]  # of number, seed of the set, and speed if it is told
    wide: bool = False  # a fixed wing can turn round in it
    fixed: int = 0  # the first worlds, which are named cases of the definition and do not depend on a seed

    def world(self, number: int, seed: int, speed_m_s: float | None = None) -> World:
        return self.build(number, seed, speed_m_s)
