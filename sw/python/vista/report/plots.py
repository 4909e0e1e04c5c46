"""Plots of the pages of flights and throughput, light and dark; their extras bring matplotlib."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from functools import wraps
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

ACCENT, WARNING, GOOD, MUTED = "#2563eb", "#dc2626", "#15803d", "#94a3b8"
INK, TEXT, TICKS, LINES = "#0f172a", "#334155", "#475569", "#e2e8f0"
# In a page these colours follow its light or dark scheme: templates/page.css.
VARIABLES = {
    ACCENT: "accent",
    WARNING: "warning",
    GOOD: "good",
    MUTED: "muted",
    INK: "ink",
    TEXT: "soft",
    TICKS: "soft",
    LINES: "line",
}
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",  # text stays text: small files, searchable
    "font.family": "sans-serif",
    "font.size": 10,
    "text.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": TEXT,
    "axes.grid": True,
    "grid.color": LINES,
    "xtick.color": TICKS,
    "ytick.color": TICKS,
}

Draw = Callable[[Figure, Any], None]


def svg_plot(width_in: float, height_in: float) -> Callable[[Draw], Callable[[Any], str]]:
    """Makes a function that draws something on a figure into one that returns the <svg> element."""

    def decorate(draw: Draw) -> Callable[[Any], str]:
        @wraps(draw)
        def render(subject: Any) -> str:
            return draw_svg(draw.__name__, width_in, height_in, lambda figure: draw(figure, subject))

        return render

    return decorate


def draw_svg(name: str, width_in: float, height_in: float, draw: Callable[[Figure], None]) -> str:
    """The <svg> element of what `draw` draws on a figure of this size."""
    # The hash salt keeps ids of two plots in one page apart, and the same from run to run.
    with mpl.rc_context(STYLE | {"svg.hashsalt": name}):
        figure = Figure(figsize=(width_in, height_in), layout="constrained")
        draw(figure)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None})
    return svg_element(stream.getvalue())


def svg_element(document: str) -> str:
    """The <svg> element alone, as wide as the page allows, in the colours of the page."""
    element = document[document.index("<svg") :]
    for colour, variable in VARIABLES.items():
        element = element.replace(colour, f"var(--{variable})")
    return re.sub(
        r'width="[^"]*pt" height="[^"]*pt"|height="[^"]*pt" width="[^"]*pt"', 'width="100%"', element, count=1
    )
