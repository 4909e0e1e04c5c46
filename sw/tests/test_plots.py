"""Plots in pages: well-formed, the same from run to run, ids that do not collide, colours of the page."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from matplotlib.figure import Figure
from vista.report.plots import ACCENT, VARIABLES, svg_plot


@svg_plot(3.0, 2.0)
def plot_one(figure: Figure, values: list[float]) -> None:
    figure.subplots().plot(values, color=ACCENT)


@svg_plot(3.0, 2.0)
def plot_other(figure: Figure, values: list[float]) -> None:
    figure.subplots().plot(values, color=ACCENT)


def test_plots_are_well_formed_and_repeatable() -> None:
    element = plot_one([1.0, 3.0, 2.0])
    assert ElementTree.fromstring(element).tag.endswith("svg")
    assert plot_one([1.0, 3.0, 2.0]) == element


def test_ids_of_different_plots_differ() -> None:
    one, other = (
        set(re.findall(r'<clipPath id="(\w+)"', plot([1.0, 2.0]))) for plot in (plot_one, plot_other)
    )
    assert one and other and not one & other


def test_plots_take_the_colours_of_the_page() -> None:
    element = plot_one([1.0, 2.0])
    assert "var(--accent)" in element and "var(--soft)" in element
    assert not any(colour in element for colour in VARIABLES)
    assert "#ffffff" not in element  # no white ground in a dark page
