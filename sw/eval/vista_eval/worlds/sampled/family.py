"""A family of flights, and its flights by number."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from vista_eval.render.flight import Flight
from vista_eval.render.scene import Scene
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import seed_of
from vista_eval.worlds.sampled.sensors import pose_faults, rig, sensor

Split = Literal["dev", "test", "test2"]


@dataclass(frozen=True)
class Family:
    name: str
    title: str
    split: Split
    scene: Callable[[float, int], Scene]  # of altitude in metres and seed
    courses: Courses
    clear: bool = False  # nothing is in the way: every alarm is false

    def flight(self, number: int, seed: int) -> Flight:
        """seed: of the whole set; no two families share that of a flight."""
        own = seed_of(seed, self.name, number)
        course = self.courses.draw(own)
        return Flight(
            f"{self.name}_{number:03d}",
            f"{self.title}, {number}",
            "dev" if self.split == "dev" else "test",
            course,
            self.scene,
            rig=rig(own),
            sensor=sensor(own),
            seed=own,
            family=self.name,
            pose_faults=pose_faults(own, course.frames),
        )

    def flights(self, count: int, seed: int) -> Iterator[Flight]:
        return (self.flight(number, seed) for number in range(count))
