"""How far the right camera has turned against its calibration: libvista estimates it (vista/alignment.h)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from vista import native
from vista.geometry import Array
from vista.health.finding import State as Health
from vista.structs import Struct


@dataclass(frozen=True)
class Turn:
    """The turn of the right camera against its calibration: positive pitch looks up, positive roll lowers the
    right side. A vertical shift of its image counts as pitch."""

    pitch_rad: float = 0.0
    roll_rad: float = 0.0

    @property
    def pitch_deg(self) -> float:
        return math.degrees(self.pitch_rad)

    @property
    def roll_deg(self) -> float:
        return math.degrees(self.roll_rad)

    def rotation(self) -> Array:
        """(3, 3): from the rectified right camera as calibrated to the one that has turned."""
        ffi, lib = native.load("vista")
        rotation = ffi.new("double[9]")
        lib.vista_turn_rotation(ffi.new("vista_turn *", (self.pitch_rad, self.roll_rad)), rotation)
        return np.array(list(rotation)).reshape(3, 3)


class State(StrEnum):
    """What is known of the turn after a pair, as vista/alignment.h has it, in the same order."""

    HELD = "held"
    MEASURED = "measured"
    BEYOND = "beyond"
    LOST = "lost"


class Alignment(Struct):
    """The outcome of one pair (vista_alignment_result)."""

    __slots__ = ()
    NAME = "vista_alignment_result"
    changed: bool  # whether the correction is another turn than that of this pair
    row_error_90_px: float  # 90th percentile of the distances of features from their rows
    features: int
    matched: int
    agreeing: int

    @property
    def state(self) -> State:
        return tuple(State)[int(self.memory["state"])]

    @property
    def correction(self) -> Turn:
        """What the right image of the next pair is to be rectified for."""
        return Turn(*self.memory["correction"].item())

    @property
    def estimate(self) -> Turn:
        return Turn(*self.memory["estimate"].item())

    @property
    def row_error_px(self) -> float | None:
        """The median distance of features from their rows; None: too few agree."""
        return self.memory["row_error_px"].item() if self.rows_known else None

    @property
    def health(self) -> Health:
        """How far this frame can be trusted, as far as the alignment goes."""
        ffi, lib = native.load("vista")
        health = ffi.new("vista_health *")
        lib.vista_alignment_judge(self.in_c(), health)
        return tuple(Health)[int(health.state)]
