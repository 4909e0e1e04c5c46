"""Everything that `vista throughput` says about one system, and its form as JSON."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from vista.errors import InputError

from vista_throughput import presets
from vista_throughput.explore import KEEPS_UP, ClockNeeded, Limit, Point, clock_needed, limit, sweep
from vista_throughput.figures import Figures, figures
from vista_throughput.host_times import HostTimes
from vista_throughput.presets import Clock
from vista_throughput.simulate import Run, Simulator
from vista_throughput.system import SystemConfig

CLOCK_FACTORS = (0.03, 0.06, 0.125, 0.25, 0.5, 1.0, 2.0)  # of the system's own clock
DISPARITIES = (16, 32, 64, 128, 256)


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


@dataclass(frozen=True)
class Sweeps:
    """Rates by clock, of this build; by disparities, at this clock; by disparities, each at its routed
    clock."""

    clock: list[Point]
    disparities: list[Point]
    routed: list[Point]


def assess(
    simulator: Simulator, preset: str | None, config: SystemConfig, clock: Clock, host: HostTimes
) -> Answer:
    config = replace(config, rectify_ms=host.rectify_ms, host_stage_ms=host.stage_ms)
    run = simulator.run(replace(config, compute_words=config.rectify_rows == 0))
    limited, needed = limit(simulator, config), clock_needed(simulator, config)
    return Answer(preset, config, clock, host, run, figures(run), limited, needed)


def sweeps(simulator: Simulator, answer: Answer) -> Sweeps:
    config = answer.config
    clocks = [config.engine_clock_hz * factor for factor in CLOCK_FACTORS]
    if answer.needed is not None:
        clocks.append(answer.needed.clock_hz)
    fitting = [d for d in DISPARITIES if d + config.block_px <= config.max_width_px]
    return Sweeps(
        sweep(simulator, [replace(config, engine_clock_hz=clock) for clock in sorted(set(clocks))]),
        sweep(simulator, [replace(config, disparities=d) for d in fitting]),
        sweep(simulator, [c for d in fitting if (c := _at_routed_clock(config, d)) is not None]),
    )


def _at_routed_clock(config: SystemConfig, disparities: int) -> SystemConfig | None:
    try:
        clock = presets.routed_clock(disparities, config.block_px, config.max_width_px)
    except InputError:
        return None
    return replace(config, disparities=disparities, engine_clock_hz=clock.hz)


def as_json(answer: Answer, swept: Sweeps | None) -> dict[str, Any]:
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
        "sweeps": swept and asdict(swept),
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
