"""How far the flight path is seen, against what geometry says of simple views."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from board_flight import board_flight
from pipeline_library import Pipeline
from random_seed import seeded
from stage_library import INVALID, camera, ffi, frame_view, lib, parameters, told_by

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 640, 480, 500.0, 0.5
RADIUS_M, LENGTH_M = 2.0, 100.0
STEP_M = LENGTH_M / 20  # of the distances that are looked at
CHANGES = {"obstacle_map.collision_radius_m": RADIUS_M, "obstacle_map.collision_length_m": LENGTH_M}
JUDGED = ("ACCEPTED", "HORIZONTAL", "TOO_FAR", "TOO_SMALL")


def seen_m(
    words: np.ndarray, verdicts=("ACCEPTED",), regions=None, path=None, plain=False, **changes: float
) -> float:
    """regions: the number of each pixel's, all of them of the first unless given."""
    height, width = words.shape
    known = parameters(CHANGES | {f"obstacle_map.{name}": value for name, value in changes.items()})
    items = ffi.new("vista_region[]", len(verdicts))
    for item, name in zip(items, verdicts, strict=True):
        item.verdict, item.plain = getattr(lib, f"VISTA_REGION_{name}"), plain
    numbers = np.ascontiguousarray(np.zeros(words.shape) if regions is None else regions, np.int32)
    frame = frame_view(
        known, camera(width, height, FOCAL_PX, BASELINE_M), words=words, path=path or straight()
    )
    return lib.vista_path_view(frame, told_by(frame, items, numbers))


def straight(direction=(0.0, 0.0, 1.0)):
    unit = np.array(direction) / np.linalg.norm(direction)
    return ffi.new("vista_flight_path *", {"direction": unit.tolist(), "length_m": LENGTH_M})


def offsets_px() -> tuple[np.ndarray, np.ndarray]:
    v, u = np.indices((HEIGHT, WIDTH))
    return u - (WIDTH - 1) / 2, v - (HEIGHT - 1) / 2


def words_where(mask: np.ndarray) -> np.ndarray:
    return np.where(mask, 16 * 4, -1).astype(np.int16)


EVERYWHERE = np.ones((HEIGHT, WIDTH), bool)


@pytest.mark.parametrize("verdict", JUDGED)
def test_what_is_judged_is_seen(verdict: str) -> None:
    assert seen_m(words_where(EVERYWHERE), (verdict,)) == LENGTH_M


@pytest.mark.parametrize("verdict", ["UNKNOWN", "TOO_FEW_PIXELS", "INCONSISTENT"])
def test_what_cannot_be_judged_is_not(verdict: str) -> None:
    assert seen_m(words_where(EVERYWHERE), (verdict,)) == 0.0


def test_without_disparities_or_regions_nothing_is_seen() -> None:
    assert seen_m(words_where(~EVERYWHERE)) == 0.0
    assert seen_m(words_where(EVERYWHERE), regions=-np.ones((HEIGHT, WIDTH))) == 0.0


def test_what_has_but_an_outline_is_seen() -> None:
    """The inside of a plain wall has no words, and its region is an obstacle all the same."""
    assert seen_m(words_where(~EVERYWHERE), plain=True) == LENGTH_M
    assert seen_m(words_where(~EVERYWHERE), ("UNKNOWN",), plain=True) == 0.0


def test_a_hole_in_the_middle_ends_the_view_where_it_fills_the_cross_section() -> None:
    """The disc of f R / s px at s metres has 1 - (hole f R / s)^2 left."""
    random = seeded(1)
    u, v = offsets_px()
    for _ in range(10):
        hole_px, least = random.uniform(12.0, 60.0), 0.2
        ends_m = FOCAL_PX * RADIUS_M * math.sqrt(1.0 - least) / hole_px
        found = seen_m(words_where(np.hypot(u, v) > hole_px))
        # The disc is sampled, and its rim is as wide as a sample.
        assert 0.85 * ends_m - STEP_M <= found <= 1.15 * ends_m


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_view_is_along_the_flight_and_not_along_the_camera(side: float) -> None:
    """Ten degrees to one side, in a view that shows something on one side only."""
    u, _ = offsets_px()
    one_side = words_where(side * u > 20.0)
    turned = [straight((sign * math.tan(math.radians(10.0)), 0.0, 1.0)) for sign in (side, -side)]
    assert seen_m(one_side, path=turned[0]) == LENGTH_M
    assert seen_m(one_side, path=turned[1]) == 0.0


def test_an_arc_leaves_what_is_seen() -> None:
    """Straight ahead all is seen, up to 100 px to either side; at s metres the arc is 0.5 c s^2 aside."""
    u, _ = offsets_px()
    band = words_where(np.abs(u) <= 100.0)
    curvature = 1 / 80.0
    arc = ffi.new(
        "vista_flight_path *",
        {
            "direction": [0.0, 0.0, 1.0],
            "normal": [1.0, 0.0, 0.0],
            "curvature_1_m": curvature,
            "length_m": LENGTH_M,
        },
    )
    found = seen_m(band, path=arc)
    turn = np.arctan(100.0 / FOCAL_PX) * 2  # a chord at half the turn leads to the band's rim
    assert found == pytest.approx(turn / curvature, abs=STEP_M)


def test_a_share_of_noise_does_not_count_as_a_view() -> None:
    random = seeded(2)
    sparse = words_where(random.random((HEIGHT, WIDTH)) < 0.1)
    assert seen_m(sparse, ("ACCEPTED",)) == 0.0


def test_a_flight_sees_its_path_where_there_is_texture_and_says_so_where_there_is_none() -> None:
    *ahead, last = board_flight()[:4]
    pipeline = Pipeline()
    pipeline.fly(ahead)
    assert pipeline.result.path_seen_m > 20.0
    pipeline.fly([replace(last, words=np.full_like(last.words, INVALID))])
    assert pipeline.result.path_seen_m == 0.0
