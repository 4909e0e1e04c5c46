"""Corrects the calibration in flight: from what the rows of a pair say to how the next one is rectified."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from vista import parameters
from vista.alignment import Alignment, Estimator, State, Turn
from vista.control_grid import GridPair
from vista.errors import InputError
from vista.health.finding import State as Health
from vista.rectify import Rectifier
from vista.sequence import Frame


class RectifyingEngine(Protocol):
    """An engine that takes raw images, and the map to rectify them by."""

    def load_map(self, grids: GridPair) -> None: ...


class Correction:
    """Belongs to one run. engine: that which rectifies in place of the rectifier, if one does."""

    def __init__(
        self, rectifier: Rectifier, values: parameters.Values, engine: RectifyingEngine | None = None
    ) -> None:
        """ValueError for images that are too small."""
        self._rectifier, self._engine = rectifier, engine
        self._estimator = Estimator(rectifier.calibration, values)

    def update(self, frame: Frame) -> Alignment:
        """frame: rectified. The map for the next one is made when it is to change, which is seldom."""
        found = self._estimator.update(frame.left, frame.right, frame.t_ns, self._rectifier.applied)
        if not found.changed:
            return found
        try:
            self._apply(found.correction)
        except InputError:  # the hardware's line buffer does not reach so far
            return replace(found, state=State.BEYOND, health=Health.BLIND, changed=False)
        return found

    def reset(self) -> None:
        """What comes next does not continue what came before: the calibration holds again."""
        self._estimator.reset()
        self._apply(Turn())

    def _apply(self, turn: Turn) -> None:
        self._rectifier.align(turn)
        if self._engine is not None and self._rectifier.grids is not None:
            self._engine.load_map(self._rectifier.grids)
