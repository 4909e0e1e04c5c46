"""Figure 5: the paper's four flights, one column for each.

From the top: the left image; the regions, one colour each; the obstacles (yellow: tracked, green: the nearest
in the collision volume with its distance); |P - P^| against 2 dz(r) over time.
"""

from __future__ import annotations

from matplotlib.figure import Figure
from vista import parameters
from vista.report.overlay import draw_obstacles

from vista_eval.dataset.truth import FlightTruth
from vista_eval.figures.canvas import show
from vista_eval.figures.moments import fly_through, shown_frame
from vista_eval.figures.segmentation import colour_regions
from vista_eval.metrics.flight_score import COMPANION_RMS_FT, FOOT_M
from vista_eval.report.flight_plots import draw_error


def draw(truths: list[FlightTruth], values: parameters.Values) -> Figure:
    columns = the_four(truths)
    figure = Figure(figsize=(3.0 * len(columns), 8.6), layout="constrained")
    rows = figure.subplots(4, len(columns), squeeze=False, height_ratios=(3, 3, 3, 2.6))
    for (image_axes, region_axes, overlay_axes, error_axes), truth in zip(rows.T, columns, strict=True):
        moment, score = fly_through(truth, shown_frame(truth), values)
        frame, result = moment.step.frame, moment.step.result
        show(image_axes, frame.left)
        image_axes.set_title(truth.title, fontsize=9)
        show(region_axes, colour_regions(moment))
        show(overlay_axes, draw_obstacles(frame.left, result.obstacles, result.nearest_collision))
        draw_error(error_axes, score, truth.focal_baseline_px_m)
        error_axes.set(xlabel="time (s)")
    return figure


def the_four(truths: list[FlightTruth]) -> list[FlightTruth]:
    """The flights in the companion's order, sign at 10 and 30 ft/s, pole at 30 and 10: the one of that name
    (sign_10), else the longest like it, else the first with a target."""
    found = []
    for kind, speed_ft_s in COMPANION_RMS_FT:
        alike = [
            truth
            for truth in truths
            if [t.kind for t in truth.targets] == [kind] and round(truth.speed_m_s / FOOT_M) == speed_ft_s
        ]
        name = f"{kind}_{speed_ft_s}"
        found += [max(alike, key=lambda truth: (truth.name == name, len(truth.times_ns)))] if alike else []
    others = [truth for truth in truths if truth.targets]
    return list({truth.name: truth for truth in (*found, *others)}.values())[:4]
