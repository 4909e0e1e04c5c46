"""Measures of a drive on a path and obstacles made up here."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from vista_eval.metrics import street
from vista_eval.metrics.street import Thing

# Ten frames, 2 m apart: five ahead along z, then a quarter turn to the right, and 10 m along x.
PATH_M = np.array([[0.0, 0.0, 2.0 * k] for k in range(5)] + [[2.0 * k, 0.0, 8.0] for k in range(1, 6)])


def obstacle(x: float, z: float, *, id: int = 1, y: float = 0.0, width: float = 1.0, **flags: bool):
    state = {"confirmed": True, "coasting": False, "in_collision_volume": True} | flags
    position = np.array([x, y, z])
    return SimpleNamespace(
        id=id, position_m=position, distance_m=float(np.hypot(x, z)), extent_m=(width, 2.0), **state
    )


def frames(*obstacles_of_frame):
    return [SimpleNamespace(obstacles=list(obstacles)) for obstacles in obstacles_of_frame]


def test_a_warning_is_judged_by_the_path_driven_next() -> None:
    """Straight ahead of the first frame, 18 m away, but the car turned 10 m before it."""
    results = frames([obstacle(0.0, 18.0)])
    (aside,) = street.warnings_beside_the_path(results, PATH_M)
    assert (aside.frame, aside.id, aside.distance_m) == (0, 1, 18.0)
    assert aside.aside_m == pytest.approx(10.0, abs=0.02)  # its width hardly matters


def test_what_stands_on_the_path_is_no_false_warning() -> None:
    assert street.warnings_beside_the_path(frames([obstacle(7.0, 8.5)]), PATH_M) == []
    assert (
        street.warnings_beside_the_path(frames([obstacle(2.4, 4.0)]), PATH_M) == []
    )  # its edge is 1.9 m away


def test_the_path_behind_the_camera_does_not_count() -> None:
    """The eighth frame, at (6, 8), has something beside the path of the first."""
    results = frames(*[[]] * 7, [obstacle(0.0, 3.0)])
    (aside,) = street.warnings_beside_the_path(results, PATH_M)
    assert aside.frame == 7 and aside.aside_m > 7.0


def aside_m(obstacle, path=PATH_M[:5]) -> float:
    return street.aside_of(obstacle, path, street.last_direction(path))


def test_a_wide_obstacle_reaches_the_path() -> None:
    assert aside_m(obstacle(5.0, 4.0, width=0.1)) == pytest.approx(5.0, abs=0.1)
    assert aside_m(obstacle(5.0, 0.2, width=0.1)) == pytest.approx(5.0, abs=0.1)
    assert aside_m(obstacle(5.0, 0.2, width=8.0)) > 4.6  # its width lies along the path: it faces the camera
    assert aside_m(obstacle(3.0, 7.0, width=6.0)) < 0.5


def test_height_counts_beyond_the_upper_edge() -> None:
    assert aside_m(obstacle(0.0, 4.0, y=-6.0), PATH_M) == pytest.approx(5.0)


def test_the_path_goes_on_straight_where_the_recording_ends() -> None:
    results = frames(*[[]] * 9, [obstacle(30.0, 8.5, id=3), obstacle(30.0, 14.0, id=4)])
    (aside,) = street.warnings_beside_the_path(results, PATH_M)
    assert (aside.frame, aside.id, aside.beyond) == (9, 4, True)
    assert aside.aside_m == pytest.approx(5.5, abs=0.1)
    (seen,) = street.warnings_beside_the_path(frames([obstacle(0.0, 18.0)]), PATH_M)
    assert not seen.beyond


def test_only_confirmed_obstacles_in_the_collision_volume_warn() -> None:
    quiet = [obstacle(0.0, 18.0, confirmed=False), obstacle(0.0, 18.0, in_collision_volume=False)]
    results = frames(quiet, [obstacle(0.0, 18.0)])
    assert street.warned_frames(results) == 1
    assert {aside.frame for aside in street.warnings_beside_the_path(results, PATH_M)} == {1}


def test_coasting_share_is_of_confirmed_obstacle_frames() -> None:
    seen, held = obstacle(0.0, 9.0), obstacle(0.0, 9.0, coasting=True)
    unconfirmed = obstacle(0.0, 9.0, coasting=True, confirmed=False)
    assert street.coasting_share(frames([seen, held, unconfirmed], [seen], [seen])) == 0.25
    assert math.isnan(street.coasting_share(frames([unconfirmed])))


def test_ids_of_a_thing() -> None:
    thing = Thing("post", 0.0, 20.0, 0, 2)
    results = frames(
        [obstacle(0.1, 20.0, id=1), obstacle(9.0, 20.0, id=7)],
        [obstacle(0.1, 20.3, id=1), obstacle(0.2, 20.0, id=2)],
        [obstacle(0.1, 20.0, id=2)],
    )
    assert street.common_ids(thing, results, PATH_M) == set()
    assert street.ids_of(thing, results, PATH_M) == {1, 2}
