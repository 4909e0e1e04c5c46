"""Poses of the left camera from odometry that keeps coming, between its samples. Needs no ROS."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from random_seed import seeded
from vista.errors import InputError
from vista.geometry import Pose, rotation_from_quaternion
from vista.ros.poses import HELD, LivePoses

START_NS = 1_700_000_000 * 10**9
STILL_WXYZ = (1.0, 0.0, 0.0, 0.0)
MOUNTING = Pose(rotation_from_quaternion(np.array([0.5, -0.5, 0.5, -0.5])), np.array([0.3, 0.0, -0.1]))


def odometry(
    t_ns: int, position_m: Any, wxyz: tuple[float, ...] = STILL_WXYZ, child: str = "base_link"
) -> SimpleNamespace:
    """A nav_msgs/Odometry, as far as it is read."""
    now_ns = START_NS + t_ns
    stamp = SimpleNamespace(sec=now_ns // 10**9, nanosec=now_ns % 10**9)
    position = SimpleNamespace(**dict(zip("xyz", map(float, position_m), strict=True)))
    orientation = SimpleNamespace(**dict(zip("wxyz", wxyz, strict=True)))
    pose = SimpleNamespace(pose=SimpleNamespace(position=position, orientation=orientation))
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), child_frame_id=child, pose=pose)


def about_z(angle_rad: float) -> tuple[float, ...]:
    return math.cos(0.5 * angle_rad), 0.0, 0.0, math.sin(0.5 * angle_rad)


def at(poses: LivePoses, t_ns: int, camera: str = "left_optical") -> Pose | None:
    return poses.at(START_NS + t_ns, camera)


def reach(poses: LivePoses, t_ns: int) -> bool:
    return poses.reach(START_NS + t_ns)


def assert_at(pose: Pose | None, position_m: Any, wxyz: tuple[float, ...] = STILL_WXYZ) -> None:
    assert pose is not None
    np.testing.assert_allclose(pose.translation_m, position_m, atol=1e-9)
    np.testing.assert_allclose(pose.rotation, rotation_from_quaternion(np.array(wxyz)), atol=1e-9)


def test_between_two_samples_the_pose_is_interpolated() -> None:
    random = seeded(1)
    for _ in range(20):
        begin_m, end_m = random.uniform(-50.0, 50.0, (2, 3))
        turn_rad, share = random.uniform(-3.0, 3.0), random.uniform()
        poses = LivePoses("/odometry", Pose())
        poses.add(odometry(0, begin_m))
        poses.add(odometry(1_000_000, end_m, about_z(turn_rad)))
        found = at(poses, round(1e6 * share))
        share = round(1e6 * share) / 1e6
        assert_at(found, begin_m + share * (end_m - begin_m), about_z(share * turn_rad))


def test_nothing_is_extrapolated() -> None:
    poses = LivePoses("/odometry", Pose())
    assert not reach(poses, 0)
    poses.add(odometry(0, (1.0, 2.0, 3.0)))
    assert reach(poses, 0) and not reach(poses, 1)
    assert at(poses, -1) is None and at(poses, 1) is None
    assert_at(at(poses, 0), (1.0, 2.0, 3.0))


def test_the_camera_is_where_it_is_mounted_on_the_body() -> None:
    poses = LivePoses("/odometry", MOUNTING)
    body = Pose(rotation_from_quaternion(np.array(about_z(0.5 * math.pi))), np.array([10.0, 20.0, 30.0]))
    poses.add(odometry(0, body.translation_m, about_z(0.5 * math.pi)))
    found = at(poses, 0)
    assert found is not None
    # Half a metre ahead of the camera lies 0.3 + 0.5 m ahead of the body, which looks along y of the world.
    np.testing.assert_allclose(found.apply(np.array([0.0, 0.0, 0.5])), (10.0, 20.8, 29.9), atol=1e-9)
    np.testing.assert_allclose(found.rotation, (body @ MOUNTING).rotation)


@pytest.mark.parametrize("child", ["left_optical", "/left_optical"])
def test_poses_of_the_camera_itself_need_no_mounting(child: str) -> None:
    poses = LivePoses("/odometry", None)
    poses.add(odometry(0, (1.0, 0.0, 0.0), child=child))
    assert_at(at(poses, 0), (1.0, 0.0, 0.0))


def test_poses_of_another_body_without_a_mounting_are_refused() -> None:
    poses = LivePoses("/odometry", None)
    poses.add(odometry(0, (1.0, 0.0, 0.0)))
    with pytest.raises(InputError, match=r"/odometry: holds poses of 'base_link'.*'left_optical', is on it"):
        at(poses, 0)


BAD = {
    "a quaternion that is none": (odometry(5, (0, 0, 0), (0.0, 0.0, 0.0, 0.0)), "quaternion of length 0"),
    "a position that is no number": (odometry(5, (math.nan, 0, 0)), "not finite"),
    "an infinite quaternion": (odometry(5, (0, 0, 0), (math.inf, 0.0, 0.0, 0.0)), "not finite"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_pose_that_is_none_is_refused_and_changes_nothing(name: str) -> None:
    message, text = BAD[name]
    poses = LivePoses("/odometry", Pose())
    poses.add(odometry(0, (1.0, 0.0, 0.0)))
    with pytest.raises(InputError, match=f"^/odometry: .*{text}"):
        poses.add(message)
    assert not reach(poses, 1)
    assert_at(at(poses, 0), (1.0, 0.0, 0.0))


def test_a_time_that_is_repeated_changes_nothing() -> None:
    poses = LivePoses("/odometry", Pose())
    poses.add(odometry(0, (1.0, 0.0, 0.0)))
    poses.add(odometry(0, (2.0, 0.0, 0.0)))
    assert_at(at(poses, 0), (1.0, 0.0, 0.0))


def test_a_clock_that_goes_back_begins_anew() -> None:
    poses = LivePoses("/odometry", Pose())
    for k in range(3):
        poses.add(odometry(1000 * k, (k, 0.0, 0.0)))
    poses.add(odometry(500, (9.0, 0.0, 0.0)))
    assert not reach(poses, 1000)
    assert at(poses, 400) is None
    assert_at(at(poses, 500), (9.0, 0.0, 0.0))
    poses.clear()
    assert not reach(poses, 500)


def test_the_oldest_samples_are_forgotten() -> None:
    poses = LivePoses("/odometry", Pose())
    for k in range(HELD + 2):
        poses.add(odometry(1000 * k, (k, 0.0, 0.0)))
    assert at(poses, 1999) is None
    assert_at(at(poses, 2000), (2.0, 0.0, 0.0))
    assert_at(at(poses, 1000 * (HELD + 1)), (HELD + 1.0, 0.0, 0.0))
