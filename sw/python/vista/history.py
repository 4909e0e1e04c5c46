"""What a run keeps of each frame for its summary and its report; images are not kept."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vista.geometry import Pose
from vista.health.finding import FrameHealth, State
from vista.pipeline import Found, Nearest, Obstacle

if TYPE_CHECKING:
    from vista.alignment import Alignment


@dataclass(frozen=True, kw_only=True)
class FrameRecord(Found):
    """What libvista found in a frame, as it is in memory, with what else is known of the frame."""

    index: int
    t_ns: int
    health: FrameHealth = field(default_factory=FrameHealth)  # empty where no checks are made
    alignment: Alignment | None = None  # of the cameras against each other; None: not looked at

    @property
    def world_from_camera(self) -> Pose | None:
        """The pose that the detector worked with; None: none up to now."""
        return None if self.motion.source == "UNTOLD" else self.motion.pose

    @property
    def motion_known(self) -> bool:
        return self.motion.known

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
