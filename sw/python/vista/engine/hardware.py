"""What the engines in hardware have in common: their settings, and the order of the words of a frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from vista.engine.contract import Disparity, EngineParameters


def settings_of(parameters: EngineParameters) -> dict[str, Any]:
    """The parameters as both vista_rtl_settings and vista_board_settings name them."""
    return {
        "xsobel": parameters.prefilter == "xsobel",
        "prefilter_cap": parameters.prefilter_cap,
        "texture_threshold": parameters.texture_threshold,
        "uniqueness_ratio": parameters.uniqueness_ratio,
        "lr_max_diff": parameters.lr_number,
        "smooth": parameters.smooth,
        "levels": parameters.levels,
    }


def level_shapes(shape: tuple[int, int], levels: int) -> list[tuple[int, int]]:
    """(height, width) of each level, level 0 first."""
    shapes = [shape]
    while len(shapes) < levels:
        shapes.append(((shapes[-1][0] + 1) // 2, (shapes[-1][1] + 1) // 2))
    return shapes


def split_levels(words: Disparity, shapes: list[tuple[int, int]]) -> list[Disparity]:
    """The words of a frame, which come level after level."""
    ends = np.cumsum([height * width for height, width in shapes])
    return [part.reshape(shape) for part, shape in zip(np.split(words, ends[:-1]), shapes, strict=True)]
