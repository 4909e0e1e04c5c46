"""What a run keeps of each frame for its summary and its report; images are not kept."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vista.geometry import Array, Pose
from vista.health.finding import FrameHealth, State

if TYPE_CHECKING:
    from vista.alignment import Alignment
    from vista.pipeline import Directions, Nearest, Obstacle


@dataclass(frozen=True)
class FrameRecord:
    index: int
    t_ns: int
    world_from_camera: Pose | None  # as the detector worked with it; None: no pose up to now
    obstacles: tuple[Obstacle, ...]
    nearest_collision: Nearest | None
    regions: int
    valid_fraction: float
    stage_ms: dict[str, float]  # in the order in which the stages ran
    dropped_tracks: int = 0  # for want of room
    motion_known: bool = False
    path_seen_m: float = 0.0  # beyond, no obstacle does not mean free space
    health: FrameHealth = field(default_factory=FrameHealth)  # empty where no checks are made
    velocity_m_s: Array | None = None  # (3,), in the world; None: not known
    directions: Directions | None = None  # that are free
    alignment: Alignment | None = None  # of the cameras against each other; None: not looked at

    @property
    def blind(self) -> bool:
        """Whether the view told nothing: obstacles and warnings of such a frame are not counted."""
        return self.health.state == State.BLIND

    @property
    def warning(self) -> Nearest | None:
        """The nearest collision, unless the view is blind."""
        return None if self.blind else self.nearest_collision

    @property
    def things(self) -> list[Obstacle]:
        """Obstacles with a confirmed track, unless the view is blind."""
        return [] if self.blind else [obstacle for obstacle in self.obstacles if obstacle.is_thing]

    @property
    def velocity_camera_m_s(self) -> Array | None:
        """The same in the frame of the camera."""
        pose = self.world_from_camera or Pose()
        return None if self.velocity_m_s is None else pose.rotation.T @ self.velocity_m_s

    def in_camera(self, position_m: Array) -> Array:
        """A position in the world, (3,), in the frame of the camera. What is not finite stays so."""
        with np.errstate(invalid="ignore"):
            return (self.world_from_camera or Pose()).inverse().apply(position_m)


@dataclass
class StageClock:
    """Wall time of the stages of one frame."""

    stage_ms: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        start_s = perf_counter()
        yield
        self.stage_ms[name] = 1e3 * (perf_counter() - start_s)


def stage_statistics(records: list[FrameRecord]) -> dict[str, dict[str, float]]:
    """Median and p99 of each stage over the frames."""
    names = list(dict.fromkeys(name for record in records for name in record.stage_ms))
    statistics = {}
    for name in names:
        values = [record.stage_ms[name] for record in records if name in record.stage_ms]
        median, p99 = np.percentile(values, [50, 99])
        statistics[name] = {"median": round(float(median), 3), "p99": round(float(p99), 3)}
    return statistics
