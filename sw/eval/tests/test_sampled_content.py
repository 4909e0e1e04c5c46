"""Single things of sampled worlds: what they are made of, and where it is."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from vista_eval.render.rig import PAPER_RIG, RIGHT
from vista_eval.worlds.grounds import COUNTRY_AND_TOWN
from vista_eval.worlds.sampled import fences, movers, poles, sensors

FLIGHTS = 2000


@pytest.mark.parametrize("fence", [fences.railing, fences.chain_link])
def test_a_fence_ends_at_its_outer_posts(fence) -> None:
    random = seeded(1)
    for _ in range(20):
        length_m, height_m = float(random.uniform(8, 18)), float(random.uniform(1.2, 3.0))
        bars, posts = fence(length_m, height_m, random)
        ends_m = np.concatenate([bars.start_m, bars.end_m])
        assert np.abs(ends_m[:, 1]).max() <= length_m / 2 + 1e-9
        assert ends_m[:, 2].min() >= 0.0
        assert np.all(np.linalg.norm(bars.end_m - bars.start_m, axis=1) > 1e-3)
        for side in (-1, 1):
            outermost_m = (side * posts.vertices_m[:, 1]).max()
            assert outermost_m == pytest.approx(length_m / 2, abs=0.05)


def test_a_bus_has_a_window_at_either_end() -> None:
    random = seeded(2)
    for _ in range(20):
        bus = movers.bus(0.7, random)
        x, z = bus.vertices_m[:, 0], bus.vertices_m[:, 2]
        window = np.isclose(z, 1.55) | np.isclose(z, 2.45)
        for side in (-1, 1):
            outermost = np.isclose(side * x, (side * x)[window].max()) & window
            assert bus.albedo[outermost] == pytest.approx(0.06)


@pytest.mark.slow
def test_posts_are_as_thick_as_said() -> None:
    random, diameters_m = seeded(3), []
    here = movers.site(5.0, int(random.integers(1 << 20)), movers.ANY, COUNTRY_AND_TOWN)
    while len(diameters_m) < 200:
        (first, *_) = poles.pole("pole", here, random).solids
        if first.name == "pole_pole":
            diameters_m.append(2 * first.radius_m)
    assert 0.03 <= min(diameters_m) < 0.04 and 0.25 < max(diameters_m) <= 0.3


def test_no_cover_is_drawn_twice_as_often_as_others() -> None:
    assert len(set(COUNTRY_AND_TOWN)) == len(COUNTRY_AND_TOWN)


def test_rows_of_some_flights_are_off() -> None:
    """One fault of eight, which three flights of ten have."""
    rigs = [sensors.rig(int(seed)) for seed in seeded(4).integers(1 << 31, size=FLIGHTS)]
    faulty = [rig for rig in rigs if rig != PAPER_RIG]
    expected = FLIGHTS * sensors.FAULTY / len(sensors.FAULTS)
    assert abs(len(faulty) - expected) < 5 * np.sqrt(expected)
    off_px = [rig.focal_px * np.tan(np.radians(rig.right_pitch_deg)) for rig in faulty]
    assert 0.1 <= np.abs(off_px).min() < 0.2 and 0.4 < np.abs(off_px).max() <= 0.5
    assert min(off_px) < 0 < max(off_px)
    turned = faulty[0].body_from_mounted_camera(RIGHT) @ np.linalg.inv(
        PAPER_RIG.body_from_mounted_camera(RIGHT)
    )
    assert not np.allclose(turned, np.eye(4), atol=1e-6)
