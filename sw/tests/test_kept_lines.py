"""Thin things that were found are kept where they are, until frames that should show them do not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from space_library import BASELINE_M, FOCAL_PX, HEIGHT, WIDTH, Space, Wall, scene
from stage_library import ffi, lib

WIRE = np.array([[-6.0, 0.2, 10.0], [6.0, 0.0, 11.0]])  # across the way of a level camera
MIDDLE = WIRE.mean(axis=0)
LEANING = Rotation.from_euler("z", 14, degrees=True).as_matrix()
BEHIND = [Wall(30.0)]
RADIUS_M = 1.0


def seen_line(rotation: np.ndarray, wire: np.ndarray = WIRE, sigma_px: float = 0.1):
    """The flat line that a camera at the origin finds of a wire."""
    x, y, z = (wire @ rotation).T
    u, v = (WIDTH - 1) / 2 + FOCAL_PX * x / z, (HEIGHT - 1) / 2 + FOCAL_PX * y / z
    d = FOCAL_PX * BASELINE_M / z
    slope, bend = (v[1] - v[0]) / (u[1] - u[0]), (d[1] - d[0]) / (u[1] - u[0])
    middle = (WIDTH - 1) / 2
    values = {
        "flat": True,
        "u_px": middle,
        "v_px": v[0] + slope * (middle - u[0]),
        "slope": slope,
        "first_px": max(int(np.ceil(u[0])), 0),
        "last_px": min(int(u[1]), WIDTH - 1),
        "disparity_px": d[0] + bend * (middle - u[0]),
        "disparity_slope": bend,
        "disparity_sigma_px": sigma_px,
    }
    return ffi.new("vista_thin_line *", values)


def watched(frames: int = 4, rotation: np.ndarray = LEANING) -> Space:
    """A wire before a wall, found by a camera that leans."""
    space = Space()
    for k in range(frames):
        space.take(scene(BEHIND, rotation=rotation), 0.1 * k, lines=[seen_line(rotation)])
    return space


def probability(shown) -> float:
    place = ffi.new("vista_path_place *", {"shown": shown})
    return lib.vista_path_place_probability(place)


def test_a_wire_that_lies_along_the_rows_is_where_it_was_found() -> None:
    space = watched()
    for k in range(4, 40):
        space.take(scene(BEHIND), 0.1 * k)
    shown = space.look(MIDDLE, RADIUS_M)
    assert (shown.lines, shown.votes) == (4, 0)
    assert shown.beyond == pytest.approx(1.0)
    assert shown.disparity_px == pytest.approx(FOCAL_PX * BASELINE_M / MIDDLE[2], rel=0.03)
    assert probability(shown) > 0.8
    beside = space.look(MIDDLE + np.array([0.0, 2.5, 0.0]), RADIUS_M)
    assert beside.lines == 0
    assert probability(beside) < 0.1


def test_a_place_farther_along_the_line_of_sight_is_told_apart() -> None:
    space = watched()
    assert space.look(MIDDLE * 1.3, RADIUS_M).lines == 0
    assert space.look(MIDDLE * 1.02, RADIUS_M).lines == 4


def test_a_line_is_in_the_way_of_what_leads_to_it_and_of_nothing_that_leads_away() -> None:
    """A place behind it is reached through it, and from farther away every place is before it."""
    space, stands = watched(), MIDDLE - np.array([0.0, 0.0, 0.5])
    space.take(scene(BEHIND, position=stands), 0.5)
    towards, behind, away = (
        stands + np.array([x, 0.0, z]) for x, z in ((0.3, 0.2), (0.0, 1.1), (-0.3, -0.2))
    )
    assert space.look_around(towards, 1.5, stands).lines == 4
    assert space.look_around(behind, 1.5, stands).lines == 4
    assert space.look_around(away, 1.5, stands).lines == 0
    assert space.look_around(away, 1.5, stands - np.array([0.0, 0.0, 2.0])).lines == 4


@pytest.mark.parametrize(("shown", "missed"), [(1, 4), (3, 13), (5, 22), (9, 22)])
def test_frames_that_should_show_it_and_do_not_let_go_of_it(shown: int, missed: int) -> None:
    """The later, the more have shown it, up to five; one that shows it again is forgiven all."""
    space, leaning, t = watched(shown), scene(BEHIND, rotation=LEANING), shown
    for _ in range(missed):
        space.take(leaning, 0.1 * t)
        t += 1
    assert space.look(MIDDLE, RADIUS_M).lines == min(shown, 5)
    space.take(leaning, 0.1 * t, lines=[seen_line(LEANING)])
    t += 1
    longest = {1: 8, 3: 17, 5: 22, 9: 22}[shown]
    for _ in range(longest):
        space.take(leaning, 0.1 * t)
        t += 1
    assert space.look(MIDDLE, RADIUS_M).lines == min(shown + 1, 5)
    for _ in range(2):
        space.take(leaning, 0.1 * t)
        t += 1
    assert space.look(MIDDLE, RADIUS_M).lines == 0


def test_frames_that_follow_closely_count_as_one_and_let_go_no_sooner() -> None:
    space, leaning = Space(), scene(BEHIND, rotation=LEANING)
    for k in range(5):
        space.take(leaning, 0.04 * k, lines=[seen_line(LEANING)])
    assert space.look(MIDDLE, RADIUS_M).lines == 3
    for k in range(5, 34):
        space.take(leaning, 0.04 * k)
    assert space.look(MIDDLE, RADIUS_M).lines == 3
    space.take(leaning, 0.04 * 34)
    assert space.look(MIDDLE, RADIUS_M).lines == 0


def test_five_pieces_of_a_line_are_kept_and_what_is_longer_than_they() -> None:
    space, leaning = watched(2), scene(BEHIND, rotation=LEANING)
    half = np.array([WIRE[0] + 0.25 * (WIRE[1] - WIRE[0]), WIRE[0] + 0.75 * (WIRE[1] - WIRE[0])])
    for k in range(2, 30):
        space.take(leaning, 0.1 * k, lines=[seen_line(LEANING, half)])
    assert space.handle.lines.count == 2 + 5
    assert space.look(WIRE[0] + 0.1 * (WIRE[1] - WIRE[0]), RADIUS_M).lines == 2


def test_after_a_gap_one_frame_lets_go_of_nothing() -> None:
    space = watched()
    space.take(scene(BEHIND, rotation=LEANING), 2.0)
    assert space.look(MIDDLE, RADIUS_M).lines == 4


def test_it_is_kept_for_a_minute() -> None:
    space = watched()
    space.take(scene(BEHIND), 59.9)
    assert space.look(MIDDLE, RADIUS_M).lines == 4
    space.take(scene(BEHIND), 60.35)
    assert space.look(MIDDLE, RADIUS_M).lines == 0


def test_a_line_of_unknown_range_tells_nothing() -> None:
    space = Space()
    space.take(scene(BEHIND, rotation=LEANING), 0.0, lines=[seen_line(LEANING, sigma_px=10.0)])
    assert space.handle.lines.count == 0


def test_a_start_forgets_them_and_memory_is_bounded() -> None:
    space = Space()
    apart = [
        seen_line(LEANING, (1.0 + 0.35 * (k // 8)) * (WIRE + np.array([0.0, k % 8 - 4.0, 0.0])))
        for k in range(lib.VISTA_THIN_MAX)
    ]
    for k in range(5):
        space.take(scene(BEHIND, rotation=LEANING), 0.1 * k, lines=apart)
    assert space.handle.lines.count == lib.VISTA_LINES_KEPT
    assert space.look(MIDDLE, RADIUS_M).lines == 2  # the newest: 2 of 96 pieces, and some of the rest
    space.reset()
    assert space.handle.lines.count == 0
