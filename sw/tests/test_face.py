"""The face of an obstacle against points of its ellipse, and where it is while nothing is detected."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from stage_library import ffi, frame_view, lib, parameters
from track_library import CENTER, FOCAL, Tracker, camera, detection, measure, motion, pose

UP = np.array([0.0, -1.0, 0.0])
MIDDLE_PX = np.array(CENTER)


def seen_from(position, turn):
    """The view of a camera, whose turn is a world-from-camera matrix."""
    moved = motion(pose(position, turn))
    return frame_view(parameters(), camera(), motion=moved, up_camera=(turn.T @ UP).tolist())


def rim_px(ellipse) -> np.ndarray:
    """Points of an ellipse: center, semi-axes, angle."""
    u, v, a, b, angle_deg = ellipse
    t, angle = np.linspace(0.0, 2.0 * np.pi, 721), np.radians(angle_deg)
    x, y = a * np.cos(t), b * np.sin(t)
    return np.stack([u + x * np.cos(angle) - y * np.sin(angle), v + x * np.sin(angle) + y * np.cos(angle)])


def test_it_is_level_faces_the_camera_and_is_as_large_as_the_ellipse() -> None:
    """The camera is turned in any way. Level and upright lines of the image are those through the middle."""
    random = seeded(1)
    for _ in range(200):
        turn = Rotation.from_euler("yxz", random.uniform(-50, 50, 3), degrees=True).as_matrix()
        position = random.uniform(-20, 20, 3)
        a, b = sorted(random.uniform(2.0, 150.0, 2), reverse=True)
        ellipse = (*(MIDDLE_PX + random.uniform(-150, 150, 2)), a, b, random.uniform(-89.0, 90.0))
        depth_m = random.uniform(3.0, 60.0)
        beside = turn @ np.array([*random.uniform(-30, 30, 2), depth_m]) + position
        obstacle = ffi.new("vista_obstacle *", {"position_m": beside.tolist(), "ellipse": list(ellipse)})
        face = lib.vista_face_of(seen_from(position, turn), obstacle)
        rays = np.stack([*((rim_px(ellipse) - MIDDLE_PX[:, None]) / FOCAL), np.ones(721)])
        middle_ray = np.array([*((np.array(ellipse[:2]) - MIDDLE_PX) / FOCAL), 1.0])
        middle_m = position + depth_m * turn @ middle_ray
        assert list(face.middle_m) == pytest.approx(middle_m)
        assert face.range_m == pytest.approx(np.linalg.norm(middle_m - position))
        axes = np.array([list(face.aside), list(face.up), list(face.sight)])
        assert axes @ axes.T == pytest.approx(np.eye(3)) and np.linalg.det(axes) == pytest.approx(-1.0)
        assert list(face.sight) == pytest.approx((middle_m - position) / face.range_m)
        level = np.cross(turn[:, 2], UP)  # of the image
        upright = np.cross(turn[:, 2], level / np.linalg.norm(level))
        rim_m = depth_m * (turn @ (rays - middle_ray[:, None]))
        for axis, half_m, along in (
            (face.aside, face.half_m[0], level / np.linalg.norm(level)),
            (face.up, face.half_m[1], -upright),
        ):
            assert half_m == pytest.approx(np.max(along @ rim_m) * (along @ np.array(list(axis))), rel=1e-3)


def test_a_camera_that_looks_straight_down_has_rows_for_level_lines() -> None:
    down = Rotation.from_euler("x", -90.0, degrees=True).as_matrix()
    below = {"position_m": [0.0, 20.0, 0.0], "ellipse": [*CENTER, 40.0, 10.0, 0.0]}
    obstacle = ffi.new("vista_obstacle *", below)
    face = lib.vista_face_of(seen_from((0.0, 0.0, 0.0), down), obstacle)
    assert list(face.half_m) == pytest.approx([40.0 * 20.0 / FOCAL, 10.0 * 20.0 / FOCAL])
    assert list(face.aside) == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)


def test_what_is_cut_off_by_the_border_stays_where_it_was_seen() -> None:
    """Ever less of a front is seen, so the middle of its track stays behind. Without a detection its ellipse
    is about what was seen last, from wherever that is looked at."""
    tracker, depth_m = Tracker(), 30.0
    inner_m = 6.0
    for k in range(8):
        width_m = 9.0 - 0.5 * k
        middle = measure((inner_m + 0.5 * width_m, 0.0, depth_m))
        half_px = 0.5 * width_m * FOCAL / depth_m
        seen = detection(middle, (width_m, 4.0), (half_px, 2.0, 0.1), cut=(True, False))
        assert tracker.update(0.1 * k, [seen]) == "VISTA_OK"
    (track,) = tracker.tracks.values()
    assert track.position_m[0] > inner_m + 0.5 * width_m + 0.3
    seen_m = np.array(list(track.position_m)) + list(track.seen_off_m)
    assert seen_m[:2] == pytest.approx([inner_m + 0.5 * width_m, 0.0], abs=0.05)
    position, turn = (2.0, 0.0, 3.0), Rotation.from_euler("y", 20.0, degrees=True).as_matrix()
    assert tracker.update(0.8, [], position, turn) == "VISTA_OK"
    (track,) = tracker.tracks.values()
    assert track.coasting
    obstacle, frame = ffi.new("vista_obstacle *"), seen_from(position, turn)
    assert lib.vista_track_obstacle(frame, track, obstacle)
    ellipse = obstacle.ellipse
    expected = measure(np.array(list(track.position_m)) + list(track.seen_off_m), position, turn)
    assert [ellipse.center_u_px, ellipse.center_v_px] == pytest.approx(expected[:2])
    face = lib.vista_face_of(frame, obstacle)
    assert face.middle_m[0] == pytest.approx(inner_m + 0.5 * width_m, abs=0.5)
