"""The figures of one simulated run: rates, latencies, and how busy each stage is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vista_throughput.simulate import Run

WARM_UP = 0.1  # share of the frames that a rate leaves out: buffers fill


@dataclass(frozen=True)
class Stage:
    """Time of one frame in a stage or waiting for it, ms; share of the simulated time that it is at work."""

    name: str
    p50_ms: float
    p99_ms: float
    utilisation: float | None = None  # None: a wait


@dataclass(frozen=True)
class Figures:
    rate_hz: float  # of frames that reach the end of the host
    delivered: int
    dropped: int
    drops: dict[str, int]  # by reason
    latency_p50_ms: float  # first pixel leaves the sensor -> obstacle map
    latency_p99_ms: float
    engine_p50_ms: float  # first pixel taken -> last word handed over
    stages: tuple[Stage, ...]


def rate_hz(run: Run, end: str = "host_end_ns") -> float:
    """Frames a second at one point, the first ones left out; 0 with less than two of them.

    From the line fitted through their times: the first and the last one's own jitter hardly counts."""
    ends_s = np.sort([frame[end] / 1e9 for frame in run.delivered])
    ends_s = ends_s[int(WARM_UP * len(ends_s)) :]
    if len(ends_s) < 2:
        return 0.0
    return 1.0 / float(np.polyfit(np.arange(len(ends_s)), ends_s - ends_s[0], 1)[0])


def spans_ms(run: Run, first: str, last: str, otherwise: str | None = None) -> np.ndarray:
    """last - first of the frames that were delivered; a frame without `first` counts from `otherwise`."""
    values = []
    for frame in run.delivered:
        start = frame[first] if frame[first] is not None or otherwise is None else frame[otherwise]
        if start is not None and frame[last] is not None:
            values.append((frame[last] - start) / 1e6)
    return np.array(values)


def figures(run: Run) -> Figures:
    output = run.output
    latency = spans_ms(run, "capture_start_ns", "host_end_ns")
    engine = spans_ms(run, "engine_start_ns", "engine_last_word_ns")
    return Figures(
        rate_hz(run),
        len(run.delivered),
        run.dropped,
        {reason: count for reason, count in output["totals"]["drops"].items() if count},
        *_percentiles(latency),
        _percentiles(engine)[0],
        tuple(_stages(run)),
    )


def _stages(run: Run) -> list[Stage]:
    output = run.output
    camera = output["camera"]
    lanes = [lane["utilisation"] for lane in output["lanes"]]
    memory, host = output["memory"]["utilisation"], output["host"]

    def stage(name: str, span: np.ndarray, utilisation: float | None = None) -> Stage:
        return Stage(name, *_percentiles(span), utilisation)

    stages = [
        stage(
            "camera",
            spans_ms(run, "capture_start_ns", "capture_end_ns"),
            camera["readout_ns"] / camera["period_ns"],
        )
    ]
    if run.config.rectify_ms:
        busy = host["rectify_utilisation"]
        stages.append(stage("wait for rectification", spans_ms(run, "capture_end_ns", "rectify_start_ns")))
        stages.append(stage("rectification", spans_ms(run, "rectify_start_ns", "rectify_end_ns"), busy))
    return [
        *stages,
        stage("wait for the engine", spans_ms(run, "rectify_end_ns", "engine_start_ns", "capture_end_ns")),
        stage("engine", spans_ms(run, "engine_start_ns", "engine_last_word_ns"), float(np.mean(lanes))),
        stage("result to memory", spans_ms(run, "engine_last_word_ns", "result_end_ns")),
        stage("wait for the host", spans_ms(run, "result_end_ns", "host_start_ns")),
        stage("host", spans_ms(run, "host_start_ns", "host_end_ns"), host["utilisation"]),
        Stage("memory port", float("nan"), float("nan"), memory),
        *(
            [Stage("link", float("nan"), float("nan"), host["link_utilisation"])]
            if run.config.has_board
            else []
        ),
    ]


def _percentiles(values: np.ndarray) -> tuple[float, float]:
    if not len(values):
        return float("nan"), float("nan")
    p50, p99 = np.percentile(values, [50, 99])
    return float(p50), float(p99)


def busiest(run: Run) -> str:
    """Names which of engine, memory, link and host is busiest."""
    output = run.output
    return max(
        {
            "engine": max(lane["utilisation"] for lane in output["lanes"]),
            "memory": output["memory"]["utilisation"],
            "link": output["host"]["link_utilisation"] or 0.0,
            "host": max(output["host"]["utilisation"], output["host"]["rectify_utilisation"] or 0.0),
        }.items(),
        key=lambda item: item[1],
    )[0]
