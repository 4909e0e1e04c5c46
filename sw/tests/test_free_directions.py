"""Which level directions are free, against what geometry says of simple views."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from board_flight import UP_WORLD, WORLD_FROM_CAMERA, board_flight
from mavlink_link import AXES, FIRST_DEG, rotation
from pipeline_library import Pipeline
from random_seed import seeded
from space_library import (
    FOCAL_PX,
    RADIUS_M,
    SPACE_FRAMES,
    SPACING_S,
    UNMATCHED,
    WIDTH,
    Space,
    Wall,
    scene,
    seen_ellipse,
    with_faces,
)
from stage_library import INVALID, ffi, lib, status_name
from vista.pipeline import Directions

UP = np.array([0.0, -1.0, 0.0])  # world of the scenes
GROUND_M = 8.0  # far below
middles_deg = FIRST_DEG + np.arange(lib.VISTA_DIRECTIONS) + 0.5
HALF_VIEW_DEG = np.degrees(np.arctan(0.5 * (WIDTH - 1) / FOCAL_PX))
inside = np.abs(middles_deg) < HALF_VIEW_DEG - 0.5


def directions(space: Space, *obstacles) -> tuple[np.ndarray, np.ndarray]:
    """free_m and blocked_m of the frame that the map took last."""
    found, (items, faces) = ffi.new("vista_directions *"), with_faces(space.frame, obstacles)
    lib.vista_free_directions(space.frame, space.handle, items, faces, len(obstacles), found)
    return np.array(list(found.free_m)), np.array(list(found.blocked_m))


def of_scene(*walls: Wall, ground_y_m=GROUND_M, rotation=None) -> tuple[np.ndarray, np.ndarray]:
    space = Space()
    up_camera = UP if rotation is None else rotation.T @ UP
    space.watch(scene(walls, ground_y_m, rotation=rotation), up_camera=up_camera)
    return directions(space)


farthest_m = of_scene()[0].max()


def test_before_the_sky_the_whole_view_is_free_and_nothing_else() -> None:
    free_m, blocked_m = of_scene()
    np.testing.assert_array_equal(free_m[inside], farthest_m)
    assert farthest_m > 40.0 and not free_m[np.abs(middles_deg) > HALF_VIEW_DEG + 0.5].any()
    assert not blocked_m.any()


def test_what_nobody_has_matched_is_neither_free_nor_blocked() -> None:
    space = Space()
    for look in (UNMATCHED, scene([Wall(20.0, textured=False)])):
        space.reset()
        space.watch(look)
        free_m, blocked_m = directions(space)
        assert not free_m.any() and not blocked_m.any()


def test_a_board_ends_what_is_free_in_its_columns() -> None:
    random = seeded(1)
    for _ in range(10):
        z_m = random.uniform(8.0, 35.0)
        first, last = np.sort(random.uniform(-20.0, 20.0, 2))
        x_m = z_m * np.tan(np.radians([first, last]))
        free_m, blocked_m = of_scene(Wall(z_m, tuple(x_m)))
        depth_m = z_m / np.cos(np.radians(middles_deg))
        behind = (middles_deg > first + 0.5) & (middles_deg < last - 0.5)
        beside = inside & ((middles_deg < first - 0.7) | (middles_deg > last + 0.7))
        assert (free_m[behind] < depth_m[behind]).all()
        assert (free_m[behind] > 0.8 * depth_m[behind]).all()
        np.testing.assert_allclose(blocked_m[behind], depth_m[behind], rtol=0.04)
        assert (free_m[beside] == farthest_m).all() and not blocked_m[beside].any()


def test_a_wall_without_texture_is_not_free_behind_its_foot() -> None:
    z_m = 15.0
    free_m, _ = of_scene(Wall(z_m, textured=False), ground_y_m=3.0)
    assert (free_m[inside] < z_m / np.cos(np.radians(middles_deg[inside]))).all()


def test_what_is_below_the_aircraft_does_not_end_what_is_free() -> None:
    free_m, _ = of_scene(Wall(20.0, y_m=(RADIUS_M, 1e3)))
    assert (free_m[inside] == farthest_m).all()


@pytest.mark.parametrize("roll_deg, pitch_deg", [(20.0, -8.0), (-30.0, 5.0), (0.0, 12.0)])
def test_directions_are_level_whatever_the_attitude(roll_deg: float, pitch_deg: float) -> None:
    """A board that a level camera sees in its middle ends the same columns for one that is not level."""
    turned = AXES.T @ rotation(roll_deg, pitch_deg, 0.0) @ AXES
    board = Wall(20.0, (-2.0, 2.0))
    behind = np.abs(middles_deg) < 4.5
    beside = (np.abs(middles_deg) > 7.0) & (np.abs(middles_deg) < 12.0)
    free_m, blocked_m = of_scene(board, rotation=turned)
    np.testing.assert_allclose(blocked_m[behind], 20.0 / np.cos(np.radians(middles_deg[behind])), rtol=0.05)
    assert (free_m[behind] < 20.0).all() and (free_m[beside] > 30.0).all()


def test_a_camera_that_looks_up_or_down_has_no_level_directions() -> None:
    for up in ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)):
        space = Space()
        space.watch(scene((), GROUND_M), up_camera=up)
        assert not directions(space)[0].any()


def test_a_tracked_thing_blocks_where_it_is_and_one_that_is_not_confirmed_does_not() -> None:
    """Nothing of it is matched in the frames."""
    space = Space()
    space.watch(scene((), GROUND_M))
    thing = {"confirmed": True, "position_m": [0.0, 0.0, 20.0], "extent_m": [2.0, 2.0]}
    free_m, blocked_m = directions(space, thing)
    behind = np.abs(middles_deg) < 2.0
    assert (free_m[behind] < 20.0).all() and blocked_m[behind] == pytest.approx(20.0)
    assert (free_m[inside & (np.abs(middles_deg) > 4.0)] == farthest_m).all()
    near = thing | {"position_m": [0.0, 0.0, 0.5]}
    assert not directions(space, near)[0][behind].any()
    below = thing | {"position_m": [0.0, RADIUS_M + 1.5, 20.0]}
    for other in (thing | {"confirmed": False}, below):
        assert (directions(space, other)[0][inside] == farthest_m).all()


def test_a_blind_frame_calls_nothing_free() -> None:
    space = Space()
    space.watch(scene((), GROUND_M))
    space.take(UNMATCHED, 1.0)
    assert not directions(space)[0].any()


def test_one_wrong_frame_does_not_block_what_the_others_see_through() -> None:
    space = Space()
    board = scene([Wall(20.0, (-2.0, 2.0))], GROUND_M)
    for k in range(SPACE_FRAMES):
        space.take(board if k == SPACE_FRAMES - 2 else scene((), GROUND_M), SPACING_S * (k + 1))
    assert not directions(space)[1].any()


def test_where_the_motion_is_not_known_the_newest_frame_is_asked_alone() -> None:
    space = Space()
    space.watch(scene([Wall(20.0)], GROUND_M))
    space.take(scene((), GROUND_M), 1.0)
    assert not (directions(space)[0][inside] == farthest_m).any()
    space.frame.motion.known = False
    assert (directions(space)[0][inside] == farthest_m).all()


def directions_of(pipeline: Pipeline):
    found = ffi.new("vista_directions *")
    assert status_name(lib.vista_pipeline_directions(pipeline.handle, found)) == "VISTA_OK"
    return found


def test_a_flight_at_a_board_is_free_beside_it_and_not_through_it() -> None:
    *ahead, last = board_flight()[:4]
    pipeline = Pipeline()
    before = directions_of(pipeline)
    assert not before.up_known and not any(before.free_m) and not any(before.blocked_m)
    pipeline.fly(ahead)
    at_board = directions_of(pipeline)
    assert at_board.up_known
    np.testing.assert_allclose(list(at_board.up_camera), WORLD_FROM_CAMERA.T @ UP_WORLD, atol=1e-9)
    assert max(at_board.free_m) > 20.0 and max(at_board.blocked_m) > 20.0
    pipeline.fly([replace(last, words=np.full_like(last.words, INVALID))])
    assert not any(directions_of(pipeline).free_m)


def test_python_and_c_agree_on_the_columns() -> None:
    assert (Directions.FIRST_DEG, Directions.COLUMNS) == (FIRST_DEG, lib.VISTA_DIRECTIONS)


def test_null_is_refused() -> None:
    status = lib.vista_pipeline_directions(ffi.NULL, ffi.new("vista_directions *"))
    assert status_name(status) == "VISTA_ERROR_ARGUMENT"


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_wall_that_the_border_cuts_off_ends_on_its_other_side_where_it_is_seen_to_end(side: float) -> None:
    """A front 20 m wide at 10 m reaches 4 m into the view from one side. Its obstacle is about its middle."""
    half_view_m = 10.0 * np.tan(np.radians(HALF_VIEW_DEG))
    inner_m = half_view_m - 4.0
    x_m = sorted((side * inner_m, side * (inner_m + 20.0)))
    space = Space()
    space.watch(scene([Wall(10.0, tuple(x_m))], GROUND_M), up_camera=UP)
    thing = {
        "confirmed": True,
        "position_m": [side * (inner_m + 10.0), 0.0, 10.0],
        "extent_m": [20.0, 20.0],
        "ellipse": seen_ellipse(space.frame, (side * (half_view_m - 2.0), 0.0, 10.0), (4.0, 20.0)),
    }
    free_m, blocked_m = directions(space, thing)
    before_deg = np.degrees(np.arctan((inner_m - 2.0) / 10.0))
    beside = inside & (side * middles_deg < before_deg)
    within = inside & (side * middles_deg > np.degrees(np.arctan((inner_m + 1.0) / 10.0)))
    assert beside.sum() > 10 and within.sum() > 5
    assert free_m[beside].min() > 30.0 and not blocked_m[beside].any()
    np.testing.assert_allclose(blocked_m[within], 10.0, rtol=0.3)
