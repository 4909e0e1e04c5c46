"""What the planner keeps of its surroundings, beside what stands there."""

from __future__ import annotations

import numpy as np
from plan_library import SIDE_M, Surroundings, distance_m
from random_seed import seeded
from scipy.spatial.transform import Rotation
from space_library import Wall
from stage_library import lib

CUBES = lib.VISTA_PLAN_CUBES
FREE = 2  # frames that agree
KEPT_S = 8.0


def turned(rad: float) -> np.ndarray:
    """World from a camera that has turned to the right."""
    c, s = np.cos(rad), np.sin(rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def random_walls(random: np.random.Generator) -> list[Wall]:
    walls = []
    for _ in range(random.integers(3, 9)):
        x_m, y_m, z_m = random.uniform((-4.0, -2.0, 3.0), (4.0, 2.0, 12.0))
        width_m, height_m = random.uniform(0.3, 3.0, 2)
        walls.append(
            Wall(z_m, (x_m - width_m / 2, x_m + width_m / 2), (y_m - height_m / 2, y_m + height_m / 2))
        )
    return walls


def test_what_stands_is_there_and_what_is_free_is_empty() -> None:
    """A vehicle that looks around and flies on past walls. What is kept of places it has left is true."""
    random, standing, free = seeded(1), 0, 0
    for _ in range(6):
        kept, walls = Surroundings(), random_walls(random)
        x_m, last_m = random.uniform(-1.0, 1.0), random.uniform(1.0, 6.0)
        for k in range(25):
            at = (x_m, 0.0, last_m * k / 24)
            kept.take(walls, at, 1.0 + 0.1 * k, turned(0.5 * np.sin(0.4 * k)))
        for point in kept.standing_m:
            assert min(distance_m(point, wall) for wall in walls) < 0.5 * SIDE_M
        places = np.flatnonzero(kept.agree >= FREE)
        for place in places:
            middle = kept.middle_m(place)
            assert middle[1] < 20.0 and all(distance_m(middle, wall) > 0.2 * SIDE_M for wall in walls)
        standing, free = standing + len(kept.standing_m), free + len(places)
    assert standing > 10 and free > 1000


def test_all_that_is_in_view_and_before_a_far_wall_is_free() -> None:
    """A cube whose sides end in the image, whichever way the camera looks and leans."""
    random = seeded(2)
    for _ in range(5):
        kept, turn = Surroundings(), Rotation.from_rotvec(random.uniform(-0.3, 0.3, 3)).as_matrix()
        at = random.uniform(-5.0, 5.0, 3)
        for k in range(FREE):
            kept.take([Wall(60.0)], at, 1.0 + 0.1 * k, turn, ground_y_m=None)
        lens, free = kept.space.camera, 0
        cubes = np.floor(at / SIDE_M) - CUBES // 2 + np.indices((CUBES,) * 3).reshape(3, -1).T
        for middle_m in (cubes + 0.5) * SIDE_M:
            x, y, z = turn.T @ (middle_m - at)
            half_px = lens.focal_px * 0.5 * SIDE_M / max(z, 1e-3)
            u_px, v_px = lens.center_u_px + lens.focal_px * x / z, lens.center_v_px + lens.focal_px * y / z
            in_view = half_px < min(u_px, lens.width_px - 5 - u_px, v_px, lens.height_px - 5 - v_px)
            if z > 4.0 * SIDE_M and in_view:
                assert kept.was_free(middle_m, 0.0), (x, y, z)
                free += 1
        assert free > 500


def test_what_is_beside_the_vehicle_stands_there_although_nothing_of_it_is_in_view() -> None:
    wall, kept = [Wall(5.0, (0.6, 1.4), (-0.5, 0.5))], Surroundings()
    for k in range(20):
        kept.take(wall, (0.0, 0.0, 0.25 * k), 1.0 + 0.1 * k)
    assert kept.stands_near((0.3, 0.0, 5.0), 0.5)
    assert not kept.stands_near((-0.3, 0.0, 5.0), 0.5)


def test_what_the_vehicle_gets_away_from_is_not_in_its_way() -> None:
    wall, kept = [Wall(5.0, (-0.5, 0.5), (-0.5, 0.5))], Surroundings()
    for k in range(18):
        kept.take(wall, (0.0, 0.0, 0.25 * k), 1.0 + 0.1 * k)
    assert kept.stands_near((0.0, 0.0, 4.4), 1.5)
    assert kept.stands_near((0.0, 0.0, 6.0), 1.5)  # straight through it
    assert not kept.stands_near((0.0, 0.0, 4.0), 1.5)


def test_a_pole_four_pixels_wide_stands() -> None:
    pole, kept = [Wall(5.0, (0.70, 0.76))], Surroundings()
    for k in range(3):
        kept.take(pole, (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
    assert kept.stands_near((0.73, 0.0, 4.9), 0.3)


def test_what_is_partly_hidden_is_not_free() -> None:
    """A board at half of the way hides a fifth of the cube."""
    for walls, free in (([], True), ([Wall(3.0, (-2.0, 0.05))], False)):
        kept = Surroundings()
        for k in range(3):
            kept.take(walls, (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
        assert kept.was_free((0.25, 0.25, 6.25), 0.0) == free


def test_all_is_let_go_of_after_some_seconds() -> None:
    wall, kept = [Wall(5.0, (0.6, 1.4), (-0.5, 0.5))], Surroundings()
    for k in range(3):
        kept.take(wall, (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
    for t_s, is_kept in ((1.1 + KEPT_S, True), (1.3 + KEPT_S, False)):
        kept.ask_at((0.0, 0.0, -20.0), t_s)
        assert kept.stands_near((1.0, 0.0, 4.9), 0.5) == is_kept
        assert kept.was_free((-1.0, 0.0, 4.0)) == is_kept


def test_one_frame_that_errs_neither_puts_a_thing_there_nor_calls_its_place_free() -> None:
    wall, kept = [Wall(5.0, (-0.5, 0.5), (-0.5, 0.5))], Surroundings()
    for k, walls in enumerate(([], [], wall, [])):
        kept.take(walls, (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
        assert not kept.stands_near((0.0, 0.0, 4.9), 0.5)
        assert kept.was_free((0.0, 0.0, 5.0)) == (k == 1)


def test_the_same_frame_is_taken_once() -> None:
    kept = Surroundings()
    kept.take([], (0.0, 0.0, 0.0), 1.0)
    before = kept.agree.copy()
    kept.ask_at((0.0, 0.0, 0.0), 1.05)
    np.testing.assert_array_equal(kept.agree, before)


def test_where_the_vehicle_was_is_known_for_some_seconds() -> None:
    kept = Surroundings()
    kept.take([], (10.0, 0.0, 0.0), 1.0)
    assert kept.stood_at((10.0, 0.1, -0.1)) and not kept.stood_at((10.0, 0.0, 0.3))
    kept.ask_at((10.0, 0.0, 5.0), 2.0 + KEPT_S)
    assert not kept.stood_at((10.0, 0.1, -0.1))


def test_a_cube_a_grid_away_is_another_one() -> None:
    kept = Surroundings()
    for k in range(3):
        kept.take([], (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
    assert kept.was_free((0.0, 0.0, 4.0)) and not kept.was_free((0.0, 0.0, 4.0 + CUBES * SIDE_M))
