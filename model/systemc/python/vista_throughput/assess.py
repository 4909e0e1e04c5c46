"""Everything that `vista throughput` says about one system, and its form as JSON."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from vista_throughput.explore import KEEPS_UP, ClockNeeded, Limit, clock_needed, limit
from vista_throughput.figures import Figures, figures
from vista_throughput.host_times import HostTimes
from vista_throughput.presets import Clock
from vista_throughput.simulate import Run, Simulator
from vista_throughput.system import SystemConfig


@dataclass(frozen=True)
class Answer:
    preset: str | None
    config: SystemConfig
    clock: Clock
    host: HostTimes
    run: Run
    figures: Figures
    limit: Limit
    needed: ClockNeeded | None

    @property
    def keeps_up(self) -> bool:
        return self.figures.rate_hz >= KEEPS_UP * self.config.camera_rate_hz

    @property
    def bottleneck(self) -> str:
        return "camera" if self.keeps_up else self.limit.stage

    @property
    def clock_margin(self) -> float | None:
        """How many times the clock is above what the camera's rate needs."""
        return None if self.needed is None else self.config.engine_clock_hz / self.needed.clock_hz


def assess(
    simulator: Simulator, preset: str | None, config: SystemConfig, clock: Clock, host: HostTimes
) -> Answer:
    config = replace(config, rectify_ms=host.rectify_ms, host_stage_ms=host.stage_ms)
    run = simulator.run(replace(config, compute_words=config.rectify_rows == 0))
    limited, needed = limit(simulator, config), clock_needed(simulator, config)
    return Answer(preset, config, clock, host, run, figures(run), limited, needed)


def as_json(answer: Answer) -> dict[str, Any]:
    """Every figure with its unit in its name; numbers that do not exist are null."""
    content = {
        "version": 1,
        "preset": answer.preset,
        "system": asdict(replace(answer.config, rectify_ms=(), host_stage_ms={})),
        "clock": asdict(answer.clock),
        "host": {
            "origin": answer.host.origin,
            "rectify_ms": _statistics(answer.host.rectify_ms),
            "stages_ms": {name: _statistics(times) for name, times in answer.host.stage_ms.items()},
        },
        "figures": asdict(answer.figures),
        "bottleneck": answer.bottleneck,
        "limit": asdict(answer.limit),
        "clock_needed": answer.needed and asdict(answer.needed) | {"margin": answer.clock_margin},
        "simulation": answer.run.output,
    }
    return _finite(content)


def _statistics(times: tuple[float, ...]) -> dict[str, float] | None:
    if not times:
        return None
    median, p99 = np.percentile(times, [50, 99])
    return {"median": round(float(median), 4), "p99": round(float(p99), 4)}


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(content) for name, content in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(content) for content in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
