"""How far a vehicle gets, without its sway.

A planner's multirotor sways to both sides, as it flies and where it stands. So its way, and whether it is at
rest, are those of its mean place over one period."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from vista_eval.closed_loop.vehicle import STEP_S

SWAY_S = 1.4  # period of the sway (sw/src/plan/primitives.c)
STEPS = round(SWAY_S / STEP_S)
Place = NDArray[np.float64]


class Progress:
    """The way of the mean place of the last SWAY_S, one step of STEP_S after the other."""

    def __init__(self, at_m: Place) -> None:
        self._places = deque([at_m] * STEPS, maxlen=STEPS)
        self.gone_m = 0.0  # without the way from the mean place to the vehicle
        self.speed_m_s = 0.0

    def take(self, at_m: Place) -> None:
        gone_m = float(np.linalg.norm(at_m - self._places[0]))
        self._places.append(at_m)
        self.gone_m += gone_m / STEPS
        self.speed_m_s = gone_m / SWAY_S

    @property
    def way_m(self) -> float:
        """The way so far, and from the mean place to where the vehicle is."""
        return self.gone_m + float(np.linalg.norm(self._places[-1] - np.mean(self._places, axis=0)))


def speeds_of(times_s: Place, places_m: Place) -> Place:
    """The speed of the mean place at each time, in m/s; places_m: (n, 3)."""
    before_m = [np.interp(times_s - SWAY_S, times_s, axis) for axis in places_m.T]
    return np.asarray(np.linalg.norm(places_m - np.stack(before_m, 1), axis=1) / SWAY_S)
