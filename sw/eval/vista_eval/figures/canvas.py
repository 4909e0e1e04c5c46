"""Panels side by side, laid out as in the paper: pictures without axes, with a caption under each."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image
from vista.output import write_atomically
from vista.report.plots import STYLE

DPI = 150
COLOURS = 256  # a palette looks the same and takes half of the bytes or less


def show(axes: Axes, picture: NDArray[np.uint8], caption: str = "") -> None:
    """picture: grey, or BGR as OpenCV has it."""
    rgb = picture if picture.ndim == 2 else cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)
    axes.imshow(rgb, cmap="gray", vmin=0, vmax=255, interpolation="antialiased")
    bare(axes, caption)


def bare(axes: Axes, caption: str) -> None:
    axes.set(xticks=[], yticks=[], xlabel=caption)
    axes.xaxis.label.set_fontsize(8)
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(False)


def save(figure: Figure, path: Path) -> Path:
    with mpl.rc_context(STYLE):
        drawn, written = io.BytesIO(), io.BytesIO()
        figure.savefig(drawn, format="png", dpi=DPI)
    Image.open(drawn).convert("RGB").quantize(COLOURS).save(written, "png", optimize=True)
    write_atomically(path, written.getvalue())
    return path
