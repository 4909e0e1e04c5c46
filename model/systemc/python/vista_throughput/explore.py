"""What limits a system, which clock it needs, and how it depends on clock and disparities, by simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from vista_throughput.figures import busiest, figures, rate_hz
from vista_throughput.simulate import Run, Simulator
from vista_throughput.system import SystemConfig

PROBE_FRAMES = 16  # of a simulation that is asked for one rate
KEEPS_UP = 0.99  # of the camera's rate
AHEAD = 1.1  # of a camera that outruns the rest without filling memory with frames that are dropped
FULL = 0.9995  # of a pixel a clock: the fastest camera behind which no frame waits
GAIN = 1.05  # in rate, for a faster stage to count as the one that limits
MAX_CAMERA_HZ = 10_000.0  # that model/systemc takes
CLOCK_TOLERANCE = 0.002
MAX_STEPS = 8
MAX_CLOCK_RATIO = 4.0  # of a pixel a clock: if that is not enough, memory is what is too slow

Faster = Callable[[SystemConfig, float], SystemConfig]
STAGES: dict[str, Faster] = {
    "engine": SystemConfig.faster_engine,
    "memory": SystemConfig.faster_memory,
    "link": SystemConfig.faster_link,
    "host": SystemConfig.faster_host,
}


@dataclass(frozen=True)
class Limit:
    """What the system could do behind a camera that is fast enough, the stage that keeps it from doing more,
    and what it could do with each stage twice as fast."""

    rate_hz: float
    stage: str
    rate_if_twice_as_fast_hz: dict[str, float]


@dataclass(frozen=True)
class ClockNeeded:
    """The lowest engine clock at which no frame of the camera is lost, and the run that confirmed it."""

    clock_hz: float
    confirmed_frames: int
    confirmed_dropped: int


@dataclass(frozen=True)
class Point:
    """One simulated point of a sweep."""

    clock_hz: float
    disparities: int
    rate_hz: float  # of the whole system, with its camera
    latency_p50_ms: float
    engine_rate_hz: float  # of engine and memory alone, with a camera as fast as they are
    engine_latency_ms: float  # first pixel into the engine -> last word out of it


def probe(config: SystemConfig) -> SystemConfig:
    """Short, times only, with the mean of the host's times: rates differ by what was changed, not by the
    draw. Nobody's frames are taken back, so that the slowest stage is always at work."""
    return replace(config.steady_host(), frames=PROBE_FRAMES, compute_words=False, buffer_policy="queue")


def limit(simulator: Simulator, config: SystemConfig) -> Limit:
    """The stage that, made twice as fast, raises the highest rate the most."""
    run = fastest_run(simulator, config)
    base = rate_hz(run)
    faster = {
        name: rate_hz(fastest_run(simulator, change(config, 2.0)))
        for name, change in STAGES.items()
        if (name != "host" or config.host_stage_ms or config.rectify_ms)
        and (name != "link" or config.has_board)
    }
    best = max(faster, key=lambda name: faster[name])
    return Limit(base, best if faster[best] >= GAIN * base else busiest(run), faster)


def fastest_run(simulator: Simulator, config: SystemConfig, end: str = "host_end_ns") -> Run:
    """The run with the highest rate at `end`, whatever camera it takes.

    Looked for among cameras up to what the engines can do, a pixel a clock. A camera far ahead of the rest
    costs memory for frames that are lost: it is brought down to just above what is reached."""

    def behind(camera_hz: float) -> Run:
        return simulator.run(probe(config.faster_camera(camera_hz / config.camera_rate_hz)))

    most_hz = config.lanes * config.engine_clock_hz / (config.width_px * config.height_px)
    # The fastest camera that the system is known to keep up with, the slowest that it is known not to.
    low, high = 0.0, min(FULL * most_hz, MAX_CAMERA_HZ)
    best, camera_hz = behind(high), high
    for _ in range(MAX_STEPS):
        reached = rate_hz(best, end)
        if high <= 1.02 * AHEAD * reached or high - low < 0.03 * high:
            break
        closer = AHEAD * reached
        camera_hz = closer if camera_hz == high and low < closer < high else (low + high) / 2
        run = behind(camera_hz)
        low, high = (camera_hz, high) if rate_hz(run, end) >= KEEPS_UP * camera_hz else (low, camera_hz)
        best = max(best, run, key=lambda one: rate_hz(one, end))
    return best


def engine_rate_hz(simulator: Simulator, config: SystemConfig) -> float:
    """What engine and memory can do, without a host behind them."""
    end = "engine_last_word_ns"
    return rate_hz(fastest_run(simulator, config.without_host(), end), end)


def clock_needed(simulator: Simulator, config: SystemConfig) -> ClockNeeded | None:
    """The clock that the camera's rate needs, host left out; None if memory does not let any clock do it."""

    def rate(clock_hz: float) -> float:
        return engine_rate_hz(simulator, replace(config, engine_clock_hz=clock_hz))

    wanted = config.camera_rate_hz
    low, high = 0.0, wanted * config.width_px * config.height_px / config.lanes  # no clock below can do it
    growth = 1.02  # little: it is mostly the pixels alone that take the time
    while rate(high) < wanted:
        low, high, growth = high, growth * high, 1.3 * growth
        if high > config.width_px * config.height_px * MAX_CLOCK_RATIO * wanted:
            return None
    while high - low > CLOCK_TOLERANCE * high and low > 0:
        middle = (low + high) / 2
        low, high = (low, middle) if rate(middle) >= wanted else (middle, high)
    run = simulator.run(replace(config.without_host(), engine_clock_hz=high, compute_words=False))
    return ClockNeeded(high, len(run.frames), run.dropped)


def sweep(simulator: Simulator, configs: list[SystemConfig]) -> list[Point]:
    return [_point(simulator, config) for config in configs]


def _point(simulator: Simulator, config: SystemConfig) -> Point:
    run: Run = simulator.run(replace(probe(config), buffer_policy=config.buffer_policy))
    found = figures(run)
    return Point(
        config.engine_clock_hz,
        config.disparities,
        found.rate_hz,
        found.latency_p50_ms,
        engine_rate_hz(simulator, config),
        found.engine_p50_ms,
    )
