"""The report's plots, each a function from the records of a run to one SVG element."""

from __future__ import annotations

import io
import re
from collections import defaultdict
from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from matplotlib.typing import RcKeyType

from vista.geometry import Array, Pose
from vista.history import FrameRecord
from vista.report.palette import distinct_colours

if TYPE_CHECKING:
    from vista.pipeline import Obstacle

STYLE: dict[RcKeyType, Any] = {
    "svg.fonttype": "none",  # text stays text: small files, searchable
    "font.family": "sans-serif",
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#94a3b8",
    "axes.labelcolor": "#334155",
    "axes.grid": True,
    "grid.color": "#e2e8f0",
    "xtick.color": "#475569",
    "ytick.color": "#475569",
}
ACCENT, WARNING, MUTED = "#2563eb", "#16a34a", "#94a3b8"
MAX_NAMED_TRACKS = 16  # more labels than that only cover each other

Records = list[FrameRecord]
T = TypeVar("T")


def svg_plot(
    width_in: float, height_in: float
) -> Callable[[Callable[[Figure, T], None]], Callable[[T], str]]:
    """Makes a function that draws on a figure into one that returns the <svg> element."""

    def decorate(draw: Callable[[Figure, T], None]) -> Callable[[T], str]:
        @wraps(draw)
        def render(shown: T) -> str:
            # The hash salt keeps ids of two plots in one page apart, and the same from run to run.
            with mpl.rc_context({**STYLE, "svg.hashsalt": draw.__name__}):
                figure = Figure(figsize=(width_in, height_in), layout="constrained")
                draw(figure, shown)
                stream = io.StringIO()
                figure.savefig(stream, format="svg", metadata={"Date": None})
            return svg_element(stream.getvalue())

        return render

    return decorate


def svg_element(document: str) -> str:
    """The <svg> element alone, as wide as the page allows."""
    element = document[document.index("<svg") :]
    return re.sub(
        r'width="[^"]*pt" height="[^"]*pt"|height="[^"]*pt" width="[^"]*pt"', 'width="100%"', element, count=1
    )


def times_s(records: Records) -> Array:
    """Since the first frame of the run."""
    return np.array([(record.t_ns - records[0].t_ns) / 1e9 for record in records])


def confirmed_tracks(records: Records) -> dict[int, list[tuple[float, Obstacle]]]:
    """(time, obstacle) of each track by id, from its confirmation on."""
    tracks: dict[int, list[tuple[float, Obstacle]]] = defaultdict(list)
    for t_s, record in zip(times_s(records), records, strict=True):
        for obstacle in record.obstacles:
            if obstacle.confirmed:
                tracks[obstacle.id].append((float(t_s), obstacle))
    return dict(tracks)


def track_colour(track_id: int) -> tuple[float, ...]:
    colours = distinct_colours()
    blue, green, red = colours[track_id % len(colours)] / 255.0 * 0.85  # darker: the page is white
    return red, green, blue


def _longest(tracks: dict[int, list[tuple[float, Obstacle]]]) -> set[int]:
    return set(sorted(tracks, key=lambda track_id: len(tracks[track_id]), reverse=True)[:MAX_NAMED_TRACKS])


@svg_plot(9.6, 4.0)
def plot_distances(figure: Figure, records: Records) -> None:
    axes = figure.subplots()
    tracks = confirmed_tracks(records)
    named = _longest(tracks)
    for track_id, points in tracks.items():
        t_s = [t for t, _ in points]
        distance_m = [obstacle.distance_m for _, obstacle in points]
        colour = track_colour(track_id)
        axes.plot(t_s, distance_m, "-" if len(points) > 1 else ".", color=colour, linewidth=1.4)
        if track_id in named:
            axes.annotate(
                f"#{track_id}",
                (t_s[-1], distance_m[-1]),
                (3, 0),
                textcoords="offset points",
                color=colour,
                size=8,
            )
    nearest = [(t, r.nearest_collision) for t, r in zip(times_s(records), records, strict=True)]
    hits = [(t, n.distance_m) for t, n in nearest if n is not None]
    if hits:
        axes.plot(
            *zip(*hits, strict=True),
            "o",
            color=WARNING,
            markersize=4,
            label="nearest in the collision volume",
        )
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False)  # no line runs there
    _say_if_empty(axes, bool(tracks), "no obstacle was confirmed")
    axes.set(xlabel="time (s)", ylabel="distance (m)", ylim=(0, None))


@svg_plot(4.7, 3.2)
def plot_collision(figure: Figure, records: Records) -> None:
    distance_axes, time_axes = figure.subplots(2, 1, sharex=True)
    hits = [
        (t, r.nearest_collision)
        for t, r in zip(times_s(records), records, strict=True)
        if r.nearest_collision
    ]
    timed = [(t, n.time_to_collision_s) for t, n in hits if n.time_to_collision_s is not None]
    distance_axes.plot(
        [t for t, _ in hits], [n.distance_m for _, n in hits], "o", color=WARNING, markersize=3
    )
    time_axes.plot([t for t, _ in timed], [s for _, s in timed], "o", color=WARNING, markersize=3)
    _say_if_empty(distance_axes, bool(hits), "nothing in the collision volume")
    _say_if_empty(time_axes, bool(timed), "no time to collision: not moving towards anything")
    distance_axes.set(ylabel="distance (m)", ylim=(0, None))
    time_axes.set(
        xlabel="time (s)", ylabel="time left (s)", ylim=(0, None), xlim=(0, max(times_s(records)[-1], 0.1))
    )


@svg_plot(4.7, 3.2)
def plot_regions(figure: Figure, records: Records) -> None:
    count_axes, valid_axes = figure.subplots(2, 1, sharex=True)
    t_s = times_s(records)
    marker = "." if len(records) == 1 else ""
    count_axes.plot(t_s, [record.regions for record in records], marker=marker, color=ACCENT)
    valid_axes.plot(t_s, [100 * record.valid_fraction for record in records], marker=marker, color=ACCENT)
    count_axes.set(ylabel="regions", ylim=(0, None))
    valid_axes.set(xlabel="time (s)", ylabel="valid disparity (%)", ylim=(0, 100))


@svg_plot(4.7, 3.8)
def plot_stages(figure: Figure, records: Records) -> None:
    """Boxes from the lower to the upper quartile with the median, a tick at p99."""
    axes = figure.subplots()
    names = list(dict.fromkeys(name for record in records for name in record.stage_ms))[::-1]
    samples = [[record.stage_ms[name] for record in records if name in record.stage_ms] for name in names]
    boxes = axes.boxplot(
        samples, orientation="horizontal", whis=(0, 99), showfliers=False, patch_artist=True, widths=0.6
    )
    for box, name in zip(boxes["boxes"], names, strict=True):
        summed = name in ("host", "total")
        box.set(facecolor="#bfdbfe" if summed else "#e2e8f0", edgecolor=ACCENT if summed else MUTED)
    for line in (*boxes["whiskers"], *boxes["caps"]):
        line.set(color=MUTED)
    for line in boxes["medians"]:
        line.set(color="#0f172a")
    axes.set_yticks(range(1, len(names) + 1), names)
    axes.set(xlabel="ms a frame", xlim=(0, None))


@svg_plot(4.7, 3.8)
def plot_map(figure: Figure, records: Records) -> None:
    """Tracks and the camera's path from above: the two world axes that are most level."""
    axes = figure.subplots()
    poses = [record.world_from_camera or Pose() for record in records]
    across, ahead = level_axes(poses)
    path_m = np.array([pose.translation_m for pose in poses])
    axes.plot(path_m[:, across], path_m[:, ahead], "-", color="#0f172a", linewidth=2.0, label="camera")
    axes.plot(path_m[-1, across], path_m[-1, ahead], "^", color="#0f172a", markersize=7)
    in_volume = {record.nearest_collision.id for record in records if record.nearest_collision}
    tracks = confirmed_tracks(records)
    named = _longest(tracks)
    for track_id, points in tracks.items():
        positions_m = np.array([obstacle.position_m for _, obstacle in points])
        x_m, y_m = positions_m[:, across], positions_m[:, ahead]
        colour = track_colour(track_id)
        axes.plot(x_m, y_m, "-", color=colour, linewidth=0.8, alpha=0.6)
        axes.plot(
            x_m[-1],
            y_m[-1],
            "o",
            color=colour,
            markersize=5,
            markeredgecolor=WARNING if track_id in in_volume else colour,
        )
        axes.add_patch(_two_sigma_ellipse(points[-1][1], across, ahead, colour))
        if track_id in named:
            axes.annotate(
                f"#{track_id}", (x_m[-1], y_m[-1]), (5, 3), textcoords="offset points", color=colour, size=8
            )
    _say_if_empty(axes, bool(tracks), "no obstacle was confirmed")
    axes.set(xlabel=f"{'xyz'[across]} (m)", ylabel=f"{'xyz'[ahead]} (m)")
    axes.set_aspect("equal", adjustable="datalim")


def level_axes(poses: list[Pose]) -> tuple[int, int]:
    """The world axes, in order, without the one nearest to the camera's down (its y)."""
    down = np.mean([pose.rotation[:, 1] for pose in poses], axis=0)
    vertical = int(np.argmax(np.abs(down)))
    across, ahead = (axis for axis in range(3) if axis != vertical)
    return across, ahead


def _two_sigma_ellipse(obstacle: Obstacle, across: int, ahead: int, colour: tuple[float, ...]) -> Ellipse:
    plane = np.ix_((across, ahead), (across, ahead))
    variances, vectors = np.linalg.eigh(np.asarray(obstacle.covariance_m2)[plane])
    width_m, height_m = 4.0 * np.sqrt(np.maximum(variances, 0.0))  # 2 sigma to each side
    angle_deg = np.degrees(np.arctan2(vectors[1, 0], vectors[0, 0]))
    centre = (obstacle.position_m[across], obstacle.position_m[ahead])
    return Ellipse(centre, width_m, height_m, angle=angle_deg, facecolor=colour, alpha=0.15)


def _say_if_empty(axes: Axes, filled: bool, text: str) -> None:
    if not filled:
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=MUTED)
