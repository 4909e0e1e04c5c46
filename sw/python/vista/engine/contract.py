"""What all engines share: parameters, images, words, and what is refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

# As vista/word.h and vista/engine.h have them; --help does not load the library.
SCALE = 16  # words a pixel of disparity
INVALID = -16  # the word of a pixel without a disparity
LR_OFF = -1  # of lr_max_diff where None is no number: in C, and in TOML
MAX_LEVELS = 4

Image = npt.NDArray[np.uint8]
Disparity = npt.NDArray[np.int16]


@dataclass(frozen=True)
class EngineParameters:
    """The contract's parameters; every engine takes these."""

    num_disparities: int = 32
    block_size: int = 11
    prefilter: str = "xsobel"
    prefilter_cap: int = 31
    texture_threshold: int = 10
    uniqueness_ratio: int = 15
    lr_max_diff: int | None = 1  # None: off

    smooth: bool = False  # each level before it is matched
    levels: int = 1  # of the pyramid, each half the size of the one before

    @property
    def lr_number(self) -> int:
        """lr_max_diff where None is no number: in C, and in the registers."""
        return LR_OFF if self.lr_max_diff is None else self.lr_max_diff

    def matches(self, width_px: int, height_px: int) -> bool:
        """Whether an image of this size holds a pixel that is matched; else all its words are INVALID."""
        narrowest_px = self.num_disparities + self.block_size - 1
        return width_px >= narrowest_px and height_px >= self.block_size


class Engine(Protocol):
    """What the rest of the chain knows of an engine."""

    @property
    def parameters(self) -> EngineParameters: ...

    def check_size(self, width_px: int, height_px: int) -> None:
        """ValueError for images that it does not take."""

    def compute(self, left: Image, right: Image) -> Disparity:
        """The words of level 0."""

    def levels(self, left: Image, right: Image) -> Iterator[Disparity]:
        """The words of parameters.levels levels, level 0 first, each as soon as it is there.

        A word of level k is in 1/16 px of that level: it stands for 2**k times as much at level 0, and pixel
        (x, y) of level k lies at (2**k x, 2**k y) of level 0.
        """


def check_images(left: Image, right: Image) -> None:
    """What every engine asks of a pair, whatever its size: TypeError or ValueError otherwise."""
    for side, image in (("left", left), ("right", right)):
        if not isinstance(image, np.ndarray):
            raise TypeError(f"{side} image must be a numpy array, not {type(image).__name__}")
        if image.dtype != np.uint8:
            raise TypeError(f"{side} image must be uint8, not {image.dtype}")
        if image.ndim != 2:
            raise ValueError(f"{side} image must have 2 dimensions (height, width), not {image.ndim}")
        if image.size == 0:
            raise ValueError(f"{side} image is empty")
    if left.shape != right.shape:
        raise ValueError(f"left image is {_size(left)} but right image is {_size(right)}")


def _size(image: Image) -> str:
    return f"{image.shape[1]}x{image.shape[0]}"


def check_parameters(parameters: EngineParameters) -> None:
    for name, value in asdict(parameters).items():
        if name == "smooth":
            if not isinstance(value, bool):
                raise TypeError(f"smooth must be True or False, not {value!r}")
            continue
        off = name == "lr_max_diff" and value is None
        wanted = str if name == "prefilter" else (int, np.integer)
        if not off and (not isinstance(value, wanted) or isinstance(value, bool)):
            raise TypeError(f"{name} must be {'a string' if wanted is str else 'an integer'}, not {value!r}")
        if isinstance(value, int | np.integer) and not (0 <= value < 2**31):
            raise ValueError(f"{name} must be from 0 to {2**31 - 1}, not {value}")
    if parameters.prefilter not in ("none", "xsobel"):
        raise ValueError(f"prefilter must be none or xsobel, not {parameters.prefilter!r}")
    if not 1 <= parameters.levels <= MAX_LEVELS:
        raise ValueError(f"levels must be from 1 to {MAX_LEVELS}, not {parameters.levels}")
