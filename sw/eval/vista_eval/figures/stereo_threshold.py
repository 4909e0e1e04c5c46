"""Figure 2: how a matching threshold trades correct against missing disparities.

Left: the image. Middle: disparities with a low threshold, errors in the sky. Right: with a high one. Dark is
far, light is near, white is undefined.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import SCALE, create_engine
from vista.sequence import Frame, open_sequence

from vista_eval.baselines.stereo_alone import thresholded
from vista_eval.dataset.truth import FlightTruth
from vista_eval.figures.canvas import show
from vista_eval.figures.moments import shown_frame

# (texture, uniqueness in percent) that a match has to have
LOW, HIGH = (0, 0), (300, 40)
WRONG_PX = 1.0


def draw(truths: list[FlightTruth], values: parameters.Values) -> Figure:
    """Draws the flight whose sky the low threshold fills most."""
    truth, frame, low = max(
        (low_threshold(truth, values) for truth in truths), key=lambda found: sky_matched(*found)
    )
    high = match(frame, values, HIGH)
    figure = Figure(figsize=(10.5, 3.0), layout="constrained")
    image_axes, low_axes, high_axes = figure.subplots(1, 3)
    show(image_axes, frame.left, f"{truth.title}\n")  # as many lines as beside it: the same size
    largest_px = values["stereo"]["num_disparities"] - 1
    for axes, words, name in ((low_axes, low, "low threshold"), (high_axes, high, "high threshold")):
        exact_px = truth.disparity_px(frame.t_ns)
        show(axes, shade(words, largest_px), f"{name}: {correctness(words, exact_px)}")
    return figure


def low_threshold(
    truth: FlightTruth, values: parameters.Values
) -> tuple[FlightTruth, Frame, NDArray[np.int16]]:
    sequence = open_sequence(truth.folder)
    frame = sequence.read(sequence.frames[shown_frame(truth)])
    return truth, frame, match(frame, values, LOW)


def match(frame: Frame, values: parameters.Values, threshold: tuple[int, int]) -> NDArray[np.int16]:
    engine = create_engine("golden", thresholded(engine_parameters(values), *threshold))
    return engine.compute(frame.left, frame.right)


def sky_matched(truth: FlightTruth, frame: Frame, words: NDArray[np.int16]) -> int:
    return int(np.sum((words >= 0) & (truth.disparity_px(frame.t_ns) == 0.0)))


def correctness(words: NDArray[np.int16], exact_px: NDArray[np.float32]) -> str:
    valid = words >= 0
    sky = exact_px == 0.0
    wrong = valid & ~sky & (np.abs(words / SCALE - exact_px) > WRONG_PX)
    return (
        f"{percent(valid & sky, sky)} of the sky matched,\n"
        f"{percent(valid & ~sky, ~sky)} of the rest, {percent(wrong, valid & ~sky)} of that wrong"
    )


def percent(part: NDArray[np.bool_], whole: NDArray[np.bool_]) -> str:
    return f"{100.0 * part.sum() / max(whole.sum(), 1):.0f} %"


def shade(words: NDArray[np.int16], largest_px: int) -> NDArray[np.uint8]:
    """Logarithmic, so that far things differ too; undefined is white."""
    levels = 235.0 * np.log1p(np.maximum(words, 0) / SCALE) / np.log1p(largest_px)
    return np.where(words < 0, 255, np.clip(levels, 0, 235)).astype(np.uint8)
