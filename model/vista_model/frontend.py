"""What goes before the matching: smoothing and pyramid, as model/README.md puts them.

Borders are mirrored without repeating the edge (row -1 is row 1), as often as a tiny image needs it.
"""

from __future__ import annotations

import functools

import numpy as np
import numpy.typing as npt

from vista_model.engine import Image, Ints, Parameters, compute


def mirrored(places: Ints, size: int) -> Ints:
    """The places inside 0 .. size-1 that stand for these; a single place stands for all."""
    if size == 1:
        return np.zeros_like(places)
    period = 2 * (size - 1)
    inside = places % period
    return np.minimum(inside, period - inside)


def filtered(image: Ints, weights: tuple[int, ...], axis: int) -> Ints:
    """The sum of the neighbours along an axis, times their weights."""
    size, radius = image.shape[axis], len(weights) // 2
    places = np.arange(size, dtype=np.int32)
    neighbours = [image.take(mirrored(places + i - radius, size), axis) for i in range(len(weights))]
    return functools.reduce(np.add, (weight * part for weight, part in zip(weights, neighbours, strict=True)))


def smooth(image: Image) -> Image:
    """Smoothing: [1 2 1] in both directions, a sixteenth of the sum, half rounded up."""
    sums = filtered(filtered(image.astype(np.int32), (1, 2, 1), 0), (1, 2, 1), 1)
    return ((sums + 8) >> 4).astype(np.uint8)


def reduce(image: Image) -> Image:
    """The next level: [1 4 6 4 1] in both directions, a 256th of the sum, every second row and column."""
    sums = filtered(filtered(image.astype(np.int32), (1, 4, 6, 4, 1), 0), (1, 4, 6, 4, 1), 1)
    return ((sums[::2, ::2] + 128) >> 8).astype(np.uint8)


def pyramid(image: Image, levels: int) -> list[Image]:
    """Level 0, the image itself, and those reduced from it; none is smoothed."""
    images = [image]
    while len(images) < levels:
        images.append(reduce(images[-1]))
    return images


def compute_levels(
    left: Image, right: Image, parameters: Parameters, levels: int = 1, smoothed: bool = False
) -> list[npt.NDArray[np.int16]]:
    """The words of every level, level 0 first, each in sixteenths of its own pixels."""
    pairs = zip(pyramid(left, levels), pyramid(right, levels), strict=True)
    return [
        compute(smooth(a), smooth(b), parameters) if smoothed else compute(a, b, parameters) for a, b in pairs
    ]
