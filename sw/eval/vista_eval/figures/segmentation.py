"""Figure 4: segmentations; beside each image, its regions in one colour each."""

from __future__ import annotations

import textwrap

import cv2
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from vista import parameters
from vista.report.palette import GREY, INK, RegionColours

from vista_eval.dataset.truth import FlightTruth
from vista_eval.figures.canvas import show
from vista_eval.figures.moments import Moment, fly_to, shown_frame

ROWS, PAIRS = 2, 3
CAPTION_LETTERS = 26  # a line: what a panel is wide


def draw(truths: list[FlightTruth], values: parameters.Values) -> Figure:
    figure = Figure(figsize=(10.5, 3.2), layout="constrained")
    axes = figure.subplots(ROWS, 2 * PAIRS).reshape(-1, 2)
    for pair in axes.ravel():
        pair.set_axis_off()
    for (image_axes, region_axes), truth in zip(axes, various(truths), strict=False):
        moment = fly_to(truth, shown_frame(truth), values)
        for one in (image_axes, region_axes):
            one.set_axis_on()
        title = textwrap.fill(truth.title, CAPTION_LETTERS)
        regions = f"{moment.step.result.outcome.region_count} regions"
        show(image_axes, moment.step.frame.left, title)
        show(region_axes, colour_regions(moment), regions + "\n" * title.count("\n"))  # the same size
    return figure


def various(truths: list[FlightTruth]) -> list[FlightTruth]:
    """Chooses as many as there is room for, of as many kinds of target as there are."""
    by_kind: dict[str, list[FlightTruth]] = {}
    for truth in truths:
        kind = truth.targets[0].kind if truth.targets else "none"
        by_kind.setdefault(kind, []).append(truth)
    turns = max(len(same) for same in by_kind.values())
    ordered = [same[turn] for turn in range(turns) for same in by_kind.values() if turn < len(same)]
    return ordered[: ROWS * PAIRS]


def colour_regions(moment: Moment) -> NDArray[np.uint8]:
    result = moment.step.result
    colours = np.vstack([RegionColours().assign(result.region_of_cell), [GREY]]).astype(np.uint8)
    labels = result.region_of_pixel
    picture = colours[labels]  # the last colour serves -1, no region
    border = np.zeros(labels.shape, np.uint8)
    border[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    border[1:] |= labels[1:] != labels[:-1]
    picture[border != 0] = INK
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.5), np.uint8)
