"""The vote on places ahead, on words made by hand."""

from __future__ import annotations

from collections import deque

import numpy as np
import pytest
from fake_pipeline import fake_motion, fake_obstacle, fake_record
from vista.engine import INVALID, SCALE, Disparity
from vista.geometry import Calibration, Pose
from vista_eval.baselines.place_vote import FRAMES, first_place_m, votes, with_warning

CAMERA = Calibration(320, 240, 500.0, 159.5, 119.5, 0.4572)


def words_at(depth_m: float, part: slice = slice(None)) -> Disparity:
    """Words of a wall across the view; only in these columns."""
    words = np.full((CAMERA.height, CAMERA.width), INVALID, np.int16)
    words[:, part] = round(SCALE * CAMERA.focal_px * CAMERA.baseline_m / depth_m)
    return words


def flown(empty: int = 0) -> deque:
    """A flight at a wall 30 m ahead, a metre nearer in each frame; the newest ones have no words."""
    kept: deque = deque(maxlen=FRAMES)
    for k in range(FRAMES):
        words = words_at(35.0 - k) if k < FRAMES - empty else words_at(1e9, slice(0))
        kept.append((words, Pose(np.eye(3), np.array([0.0, 0.0, float(k)]))))
    return kept


@pytest.mark.parametrize(("empty", "found"), [(0, True), (2, True), (3, False)])
def test_four_of_six_frames_agree(empty: int, found: bool) -> None:
    """The first place that agrees lies at 28 or 29 m: 0.75 px are 2.8 m there."""
    place_m = first_place_m(CAMERA, flown(empty))
    assert (place_m is not None) == found
    if place_m is not None:
        assert place_m[2] - (FRAMES - 1) == pytest.approx(28.5, abs=1.0)


def test_a_camera_that_stands_has_no_places() -> None:
    standing = deque([(words_at(30.0), Pose())] * FRAMES, maxlen=FRAMES)
    assert first_place_m(CAMERA, standing) is None


def test_what_a_vote_takes() -> None:
    """Two of a hundred pixels around the place; the disc has a radius of 26.7 px at 30 m."""
    place_m = np.array([0.0, 0.0, 30.0])
    assert votes(CAMERA, words_at(30.0), Pose(), place_m)
    assert not votes(CAMERA, words_at(34.0), Pose(), place_m)  # 0.9 px less
    assert votes(CAMERA, words_at(30.0, slice(160, 162)), Pose(), place_m)
    assert not votes(CAMERA, words_at(30.0, slice(135, 136)), Pose(), place_m)  # a chord of 20 px
    assert not votes(CAMERA, words_at(30.0, slice(187, None)), Pose(), place_m)  # all beside it
    assert not votes(CAMERA, words_at(30.0), Pose(), -place_m)


def test_one_warning_takes_the_place_of_all() -> None:
    before = fake_obstacle(1, 20.0, CAMERA, in_collision_volume=True)
    record = fake_record(0, 0, [before, before], motion=fake_motion(Pose()), path_seen_m=30.0)
    told = with_warning(record, CAMERA, np.array([0.0, 0.0, 25.0]))
    (warning,) = told.obstacles
    assert (warning.distance_m, warning.confirmed, warning.in_collision_volume) == (25.0, True, True)
    assert told.nearest_collision is not None and told.nearest_collision.id == warning.id
    assert told.path_seen_m == 0.0
    silent = with_warning(record, CAMERA, None)
    assert (silent.obstacles, silent.nearest_collision) == ([], None)
