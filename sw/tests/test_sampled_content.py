"""Single things of sampled worlds: what they are made of, and where it is."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from vista_eval.worlds.sampled import movers
from vista_eval.worlds.sampled.grounds import COUNTRY_AND_TOWN

FLIGHTS = 2000


def test_a_bus_has_a_window_at_either_end() -> None:
    random = seeded(2)
    for _ in range(20):
        bus = movers.bus(0.7, random)
        x, z = bus.vertices_m[:, 0], bus.vertices_m[:, 2]
        window = np.isclose(z, 1.55) | np.isclose(z, 2.45)
        for side in (-1, 1):
            outermost = np.isclose(side * x, (side * x)[window].max()) & window
            assert bus.albedo[outermost] == pytest.approx(0.06)


def test_no_cover_is_drawn_twice_as_often_as_others() -> None:
    assert len(set(COUNTRY_AND_TOWN)) == len(COUNTRY_AND_TOWN)
