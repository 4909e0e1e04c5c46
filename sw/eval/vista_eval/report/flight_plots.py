"""The plots of the flights' report; each function returns one SVG element."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from vista.report.plots import ACCENT, GOOD, LINES, MUTED, WARNING, svg_plot

from vista_eval.metrics.comparison import Comparison
from vista_eval.metrics.flight_score import FlightScore
from vista_eval.metrics.rules import HIT_RANGE, HIT_RANGE_M, NEAR
from vista_eval.training.odds import Odds


@svg_plot(12.0, 2.9)
def plot_error(figure: Figure, flight: tuple[FlightScore, float]) -> None:
    """|P - P^| and 2 dz(r) over time as in the paper's figure 5; below, what was judged of each frame.

    flight: its score and f B in px m."""
    score, focal_baseline_px_m = flight
    error_axes, strip_axes = figure.subplots(2, 1, sharex=True, height_ratios=(5, 1))
    draw_error(error_axes, score, focal_baseline_px_m)
    t_s = frame_times_s(score)
    rows = (
        ("warned of", GOOD, [frame.matched_id is not None for frame in score.frames]),
        ("missed", WARNING, [frame.missed for frame in score.frames]),
        ("false alarm", "#f59e0b", [bool(frame.false_alarms) for frame in score.frames]),
    )
    for row, (_, colour, marks) in enumerate(rows):
        strip_axes.plot(
            t_s[np.array(marks, bool)], np.full(sum(marks), -row), "|", color=colour, markersize=7
        )
    strip_axes.set(ylim=(-len(rows) + 0.4, 0.6), xlabel="time (s)", xlim=(t_s[0], max(t_s[-1], 0.1)))
    strip_axes.set_yticks([-row for row in range(len(rows))], [name for name, _, _ in rows], fontsize=8)
    strip_axes.grid(False)


def draw_error(axes: Axes, score: FlightScore, focal_baseline_px_m: float) -> None:
    t_s = frame_times_s(score)
    aimed = [(t, f.range_m) for t, f in zip(t_s, score.frames, strict=True) if f.range_m is not None]
    errors = [(t, f.error_m) for t, f in zip(t_s, score.frames, strict=True) if f.error_m is not None]
    if not aimed:
        axes.text(0.5, 0.5, "nothing in the way", transform=axes.transAxes, ha="center", color=MUTED)
        axes.set_yticks([])
        return
    bound_m = [2.0 * range_m**2 / focal_baseline_px_m for _, range_m in aimed]
    axes.plot([t for t, _ in aimed], bound_m, color=WARNING, label="2 dz(r)")
    axes.plot([t for t, _ in errors], [e for _, e in errors], ".-", color=ACCENT, label="|P - P^|")
    axes.set(ylabel="m", ylim=(0.0, None))
    axes.legend(loc="upper right", frameon=False)


def frame_times_s(score: FlightScore) -> np.ndarray:
    return np.array([(frame.t_ns - score.frames[0].t_ns) / 1e9 for frame in score.frames])


@svg_plot(6.4, 4.4)
def plot_comparison(figure: Figure, comparison: Comparison) -> None:
    """Frames missed against frames with a false alarm: stereo alone at every threshold, and ours."""
    axes = figure.subplots()
    points = np.array([(point.alarms, point.missed) for point in comparison.alone], float)
    total = np.array([comparison.frames, max(comparison.near_frames, 1)])
    axes.plot(*(100.0 * points / total).T, ".", color=MUTED, label="stereo alone, each a threshold")
    ours = 100.0 * np.array([comparison.ours.alarms, comparison.ours.missed]) / total
    axes.plot(*ours[:, np.newaxis], "o", color=GOOD, markersize=10, label="segmentation and tracks")
    axes.set(
        xlabel="frames with a false alarm (%)",
        ylabel=f"frames with the target {NEAR} missed (%)",
        xlim=(-2, 102),
        ylim=(-2, 102),
    )
    axes.legend(loc="upper right", frameon=False)


@svg_plot(6.4, 4.4)
def plot_detection(figure: Figure, scores: list[FlightScore]) -> None:
    """Plots from where to where each target was in the way, and in which frames it was warned of."""
    axes = figure.subplots()
    aimed = [score for score in scores if score.hit_rate is not None]
    for row, score in enumerate(aimed):
        ranges_m = [frame.range_m for frame in score.frames if frame.range_m is not None]
        warned_m = [f.range_m for f in score.frames if f.matched_id is not None and f.range_m is not None]
        axes.plot([min(ranges_m), max(ranges_m)], [row, row], color=LINES, linewidth=7)
        axes.plot(warned_m, np.full(len(warned_m), row), "|", color=GOOD, markersize=7)
    axes.axvspan(*HIT_RANGE_M, color=ACCENT, alpha=0.15, zorder=0)
    axes.set_yticks(range(len(aimed)), [score.name for score in aimed], fontsize=8)
    axes.set(xlabel=f"range of the target (m); shaded: {HIT_RANGE}", ylim=(max(len(aimed), 1) - 0.5, -0.5))
    axes.set_xlim(left=0.0)


@svg_plot(4.4, 4.4)
def plot_reliability(figure: Figure, odds: Odds) -> None:
    """How often places are occupied against the probability that they are given."""
    axes = figure.subplots()
    bins = [one for one in odds.bins if one.places]
    axes.plot([0.0, 1.0], [0.0, 1.0], color=MUTED, linewidth=1.0)
    axes.plot([one.given for one in bins], [one.occupied for one in bins], "o-", color=ACCENT)
    axes.set(xlabel="probability given", ylabel="truly occupied", xlim=(0.0, 1.0), ylim=(0.0, 1.0))
