"""What goes before the matching: smoothing and pyramid, and the words of all levels in turn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from vista import native
from vista.engine.contract import Disparity, EngineParameters, Image, check_images

Filter = Callable[[Image], Image]


@dataclass(frozen=True)
class FrontEnd:
    """Smoothing and the step to the next level, of one image each.

    map: applies a function to both images of a pair; the built-in one, or that of a pool of threads.
    """

    smooth: Filter
    reduce: Filter
    map: Callable[[Filter, tuple[Image, Image]], Iterable[Image]] = map

    def pairs(self, left: Image, right: Image, parameters: EngineParameters) -> Iterator[tuple[Image, Image]]:
        """The pair to be matched at each level, level 0 first."""
        for level in range(parameters.levels):
            if level > 0:
                left, right = self.map(self.reduce, (left, right))
            if parameters.smooth:
                smooth_left, smooth_right = self.map(self.smooth, (left, right))
                yield smooth_left, smooth_right
            else:
                yield left, right


def c_front_end(isa: int = 0) -> FrontEnd:
    """Makes the front end of libvista_engine; isa: one of its VISTA_ENGINE_ISA_*, auto by default."""
    ffi, lib = native.load("vista_engine")

    def reduced_shape(shape: tuple[int, int]) -> tuple[int, int]:
        return lib.vista_frontend_reduced_px(shape[0]), lib.vista_frontend_reduced_px(shape[1])

    def apply(function: Any, shape_of: Callable[[Any], Any], image: Image) -> Image:
        image = np.ascontiguousarray(image)
        height, width = image.shape
        out = np.empty(shape_of(image.shape), np.uint8)
        c_image = ffi.new(
            "vista_frontend_image *", (ffi.from_buffer("uint8_t[]", image), width, height, width)
        )
        status = function(c_image, ffi.from_buffer("uint8_t[]", out), out.shape[1], isa)
        native.check(ffi, lib, status)
        return out

    return FrontEnd(
        smooth=partial(apply, lib.vista_frontend_smooth, lambda shape: shape),
        reduce=partial(apply, lib.vista_frontend_reduce, reduced_shape),
    )


class LevelEngine(ABC):
    """An engine that matches pair by pair what its front end makes of the images."""

    parameters: EngineParameters
    _front_end: FrontEnd

    @abstractmethod
    def check_size(self, width_px: int, height_px: int) -> None:
        """ValueError for images that it does not take."""

    @abstractmethod
    def _match(self, left: Image, right: Image) -> Disparity:
        """The words of one level from its two images, smoothed already."""

    def compute(self, left: Image, right: Image) -> Disparity:
        """Disparity words of the left image, at level 0."""
        return next(self.levels(left, right))

    def levels(self, left: Image, right: Image) -> Iterator[Disparity]:
        """Disparity words of one level after the other, level 0 first; each in 1/16 px of its own pixels."""
        check_images(left, right)
        self.check_size(left.shape[1], left.shape[0])
        return (self._match(*pair) for pair in self._front_end.pairs(left, right, self.parameters))

    def compute_levels(self, left: Image, right: Image) -> list[Disparity]:
        """Disparity words of all levels at once."""
        return list(self.levels(left, right))
