"""Colours, BGR for OpenCV, chosen to be told apart on grey imagery."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray


class Colour(NamedTuple):
    blue: int
    green: int
    red: int


YELLOW = Colour(0, 225, 255)  # tracked obstacles
RED = Colour(75, 75, 255)  # obstacles on the collision course
GREY = Colour(170, 170, 170)  # tracks that are not confirmed yet
ALARM = Colour(40, 40, 210)  # the ground of a warning's text
WHITE = Colour(245, 245, 245)
INK = Colour(24, 20, 18)  # backgrounds, and disparity where there is none
PALETTE_SIZE = 64


def distinct_colours() -> NDArray[np.uint8]:
    """PALETTE_SIZE x 3: hues by the golden angle, so that neighbours in the table are far apart in colour."""
    index = np.arange(PALETTE_SIZE)
    hue = (index * 0.618034 * 180.0) % 180.0  # OpenCV's hue: half degrees
    saturation = 255.0 * np.array([0.75, 0.95, 0.6])[index % 3]
    value = 255.0 * np.array([0.95, 0.8])[index % 2]
    hsv = np.stack([hue, saturation, value], axis=-1).astype(np.uint8)
    return np.asarray(cv2.cvtColor(hsv[np.newaxis], cv2.COLOR_HSV2BGR)[0], np.uint8)


class RegionColours:
    """One colour a region that stays with it from frame to frame: a region inherits the colour of the earlier
    region that it shares most cells with, unless one that shares more has taken it."""

    def __init__(self) -> None:
        self._colours = distinct_colours()
        self._previous: tuple[NDArray[np.int32], NDArray[np.int64]] | None = (
            None  # region of cell, slot of region
        )
        self._next_slot = 0

    def assign(self, region_of_cell: NDArray[np.int32]) -> NDArray[np.uint8]:
        """(regions, 3) BGR; region_of_cell: label of each cell, -1 for none."""
        count = int(region_of_cell.max(initial=-1)) + 1
        slots = np.full(count, -1, np.int64)
        if self._previous is not None:
            self._inherit(region_of_cell, slots, *self._previous)
        free = slots < 0
        slots[free] = self._next_slot + np.arange(int(free.sum()))
        self._next_slot += int(free.sum())
        self._previous = (region_of_cell.copy(), slots)
        return self._colours[slots % PALETTE_SIZE]

    @staticmethod
    def _inherit(
        region_of_cell: NDArray[np.int32],
        slots: NDArray[np.int64],
        before: NDArray[np.int32],
        slots_before: NDArray[np.int64],
    ) -> None:
        if len(before) != len(region_of_cell) or not len(slots_before):
            return
        both = (region_of_cell >= 0) & (before >= 0)
        keys = region_of_cell[both].astype(np.int64) * len(slots_before) + before[both]
        pairs, shared_cells = np.unique(keys, return_counts=True)
        taken = set()
        for pair in pairs[np.argsort(-shared_cells, kind="stable")]:
            region, region_before = divmod(int(pair), len(slots_before))
            if slots[region] < 0 and region_before not in taken:
                slots[region] = slots_before[region_before]
                taken.add(region_before)
