"""Draws the frame timeline and the sweeps, as PNG and as SVG elements for the report."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from vista.report.plots import ACCENT, INK, MUTED, STYLE, WARNING, svg_element

from vista_throughput.assess import Answer, Sweeps
from vista_throughput.explore import Point

TIMELINE_FRAMES = 5
SYSTEM, ENGINE, ROUTED = ACCENT, "#d97706", INK
FRAME_COLOURS = ("#2563eb", "#d97706", "#0d9488", "#9333ea")  # in turn
DROPPED = WARNING
PNG_DPI = 130


@dataclass(frozen=True)
class Picture:
    svg: str
    png: bytes


def picture(name: str, width_in: float, height_in: float, draw: Callable[[Figure], None]) -> Picture:
    # The hash salt keeps ids of two plots in one page apart, and the same from run to run.
    with mpl.rc_context(STYLE | {"svg.hashsalt": name}):
        figure = Figure(figsize=(width_in, height_in), layout="constrained")
        draw(figure)
        text, image = io.StringIO(), io.BytesIO()
        figure.savefig(text, format="svg", transparent=True, metadata={"Date": None})
        figure.savefig(image, format="png", dpi=PNG_DPI)
    return Picture(svg_element(text.getvalue()), image.getvalue())


def timeline(answer: Answer) -> Picture:
    return picture("timeline", 9.6, 0.55 * len(_rows(answer)) + 1.3, lambda figure: _timeline(figure, answer))


def sweep_plot(answer: Answer, swept: Sweeps) -> Picture:
    return picture("sweep", 9.6, 5.6, lambda figure: _sweeps(figure, answer, swept))


def _rows(answer: Answer) -> list[tuple[str, str, str, int | None]]:
    """Name, first and last time of a frame, and the lane it has to be on."""
    rows: list[tuple[str, str, str, int | None]] = [("camera", "capture_start_ns", "capture_end_ns", None)]
    if answer.config.rectify_ms:
        rows.append(("rectification", "rectify_start_ns", "rectify_end_ns", None))
    for lane in range(answer.config.lanes):
        number = f" {lane}" if answer.config.lanes > 1 else ""
        rows += [
            (f"fetch DMA{number}", "fetch_start_ns", "engine_last_pixel_ns", lane),
            (f"engine{number}", "engine_start_ns", "engine_last_word_ns", lane),
            (f"result DMA{number}", "engine_first_word_ns", "result_end_ns", lane),
        ]
    return [*rows, ("host", "host_start_ns", "host_end_ns", None)]


def _timeline(figure: Figure, answer: Answer) -> None:
    """A bar a stage and frame, in the frame's colour, from the middle of the run."""
    axes = figure.subplots()
    frames = _with_last_pixel(answer)
    middle = max(0, (len(frames) - TIMELINE_FRAMES) // 2)
    shown = frames[middle : middle + TIMELINE_FRAMES]
    start_ns = shown[0]["capture_start_ns"]
    rows = _rows(answer)
    for frame in shown:
        colour = FRAME_COLOURS[frame["frame"] % len(FRAME_COLOURS)]
        for place, (name, first, last, lane) in enumerate(rows):
            begin, end = frame[first], frame[last]
            if begin is None or end is None or lane not in (None, frame["lane"]):
                continue
            lost = name == "camera" and frame["dropped"] is not None
            _bar(axes, place, (begin - start_ns) / 1e6, (end - start_ns) / 1e6, colour, lost)
            if name in ("camera", "host"):
                middle_ms = ((begin + end) / 2 - start_ns) / 1e6
                axes.text(middle_ms, place, str(frame["frame"]), ha="center", va="center", size=8, color="w")
    axes.set_yticks(range(len(rows)), [row[0] for row in rows])
    axes.set(xlabel="time (ms)", ylim=(len(rows) - 0.4, -0.6))
    axes.grid(axis="y", visible=False)
    axes.set_axisbelow(True)
    if any(frame["dropped"] is not None for frame in shown):
        legend = [Patch(facecolor="white", edgecolor=DROPPED, hatch="////", label="dropped later")]
        axes.legend(handles=legend, loc="upper right", frameon=False)


def _bar(axes: Axes, place: int, begin_ms: float, end_ms: float, colour: str, lost: bool) -> None:
    look: dict[str, Any] = {"color": colour, "edgecolor": "white", "linewidth": 0.6}
    if lost:
        look = {"facecolor": MUTED, "edgecolor": DROPPED, "hatch": "////", "linewidth": 0.6}
    axes.barh(place, end_ms - begin_ms, left=begin_ms, height=0.62, **look)


def _with_last_pixel(answer: Answer) -> list[dict[str, Any]]:
    """Frames with the time of their last pixel into the engine, which the simulation gives in clocks."""
    period_ns = 1e9 / answer.config.engine_clock_hz
    frames = []
    for frame in answer.run.frames:
        clocks = (frame["engine_start_clock"], frame["engine_last_pixel_clock"])
        end = None
        if None not in clocks:
            end = frame["engine_start_ns"] + (clocks[1] - clocks[0] + 1) * period_ns
        frames.append(frame | {"engine_last_pixel_ns": end})
    return frames


def _sweeps(figure: Figure, answer: Answer, swept: Sweeps) -> None:
    (clock_rate, disparity_rate), (clock_latency, disparity_latency) = figure.subplots(
        2, 2, sharex="col", sharey="row"
    )
    clocks_mhz = [point.clock_hz / 1e6 for point in swept.clock]
    disparities = [point.disparities for point in swept.disparities]
    _rates(clock_rate, clocks_mhz, swept.clock)
    _latencies(clock_latency, clocks_mhz, swept.clock)
    _rates(disparity_rate, disparities, swept.disparities)
    _latencies(disparity_latency, disparities, swept.disparities)
    if swept.routed:
        _routed(disparity_rate, swept.routed, "engine_rate_hz")
        _routed(disparity_latency, swept.routed, "engine_latency_ms")
    _marks(clock_rate, answer)
    for axes in (clock_rate, clock_latency):
        axes.set_xscale("log")
        axes.axvline(answer.config.engine_clock_hz / 1e6, color=ROUTED, linewidth=0.9, linestyle=":")
    for axes in (disparity_rate, disparity_latency):
        axes.set_xscale("log", base=2)
        axes.set_xticks(disparities, [str(d) for d in disparities])
        axes.minorticks_off()
    for axes in (clock_rate, clock_latency):
        axes.set_yscale("log")
        _plain_ticks(axes.yaxis)
    _plain_ticks(clock_latency.xaxis)
    clock_rate.set(ylabel="frames/s", title=f"{answer.config.disparities} disparities")
    disparity_rate.set(title=f"{answer.config.engine_clock_hz / 1e6:.4g} MHz")
    clock_latency.set(ylabel="latency (ms)", xlabel="engine clock (MHz)")
    disparity_latency.set(xlabel="disparities")
    disparity_rate.legend(loc="best", frameon=False, fontsize=8)


def _rates(axes: Axes, x: list[float] | list[int], points: list[Point]) -> None:
    axes.plot(
        x, _positive([p.engine_rate_hz for p in points]), "o-", color=ENGINE, label="engine and memory alone"
    )
    axes.plot(x, _positive([p.rate_hz for p in points]), "s-", color=SYSTEM, label="camera to obstacle map")


def _latencies(axes: Axes, x: list[float] | list[int], points: list[Point]) -> None:
    axes.plot(x, _positive([p.engine_latency_ms for p in points]), "o-", color=ENGINE)
    axes.plot(x, _positive([p.latency_p50_ms for p in points]), "s-", color=SYSTEM)


def _routed(axes: Axes, points: list[Point], value: str) -> None:
    axes.plot(
        [p.disparities for p in points],
        [getattr(p, value) for p in points],
        "D",
        color=ROUTED,
        markerfacecolor="none",
        label="the same at the clock that was routed",
    )


def _marks(axes: Axes, answer: Answer) -> None:
    rate = answer.config.camera_rate_hz
    axes.axhline(rate, color=MUTED, linewidth=0.9)
    axes.annotate(
        f"camera {rate:g} Hz",
        (0, rate),
        (4, 3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        size=8,
    )
    if answer.needed is not None:
        axes.axvline(answer.needed.clock_hz / 1e6, color=MUTED, linewidth=0.9, linestyle="--")


def _plain_ticks(axis: Axis) -> None:
    """1, 2, 5, 10, 20: a decade alone is too coarse for what is drawn here."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _positive(values: list[float]) -> np.ndarray:
    """A rate of 0 or a missing latency has no place on a logarithmic axis."""
    array = np.array(values, float)
    return np.where(array > 0, array, np.nan)
