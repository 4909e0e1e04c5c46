"""Own motion: velocity and turn rate from poses, missing and impossible poses, the caller's word."""

from __future__ import annotations

import math

import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from stage_library import ffi, lib, status_name
from track_library import SECOND, parameters_with, pose

FORWARD = np.array([2.0, -1.0, 8.0])  # m/s


class Motion:
    """The stage with its state."""

    def __init__(self, **changes: float) -> None:
        self._parameters = parameters_with("motion", **changes)
        self.params, self.state = self._parameters.motion, ffi.new("vista_motion_state *")

    def update(self, t_s: float, raw_pose=ffi.NULL, velocity=None, stationary: bool = False):
        self.status, motion = self.try_update(round(t_s * SECOND), raw_pose, velocity, stationary)
        assert self.status == "VISTA_OK"
        return motion

    def try_update(self, t_ns: int, raw_pose=ffi.NULL, velocity=None, stationary: bool = False):
        c_velocity = ffi.NULL if velocity is None else ffi.new("double[3]", [float(x) for x in velocity])
        given = ffi.new("vista_motion_input *", [raw_pose, c_velocity, stationary, t_ns])
        motion = ffi.new("vista_motion *")
        return status_name(
            lib.vista_motion_update(ffi.addressof(self.params), given, self.state, motion)
        ), motion

    def path(self, motion, length_m: float = 100.0, radius_m: float = 2.0):
        return lib.vista_motion_path(self.state, motion, length_m, radius_m)


def source(motion) -> str:
    return ffi.string(lib.vista_motion_source_name(motion.source)).decode()


def place(motion) -> np.ndarray:
    return np.array(list(motion.pose.translation_m))


def rotation(motion) -> np.ndarray:
    return np.array(list(motion.pose.rotation)).reshape(3, 3)


def fly(stage: Motion, times, velocity=FORWARD):
    """Poses along a straight line; the last motion."""
    for t_s in times:
        motion = stage.update(t_s, pose(velocity * t_s))
    return motion


# ---- poses ----


def test_velocity_from_poses_is_smoothed() -> None:
    random, stage = seeded(2), Motion(velocity_smoothing_s=0.5)
    for frame in range(40):
        motion = stage.update(0.1 * frame, pose(FORWARD * 0.1 * frame + random.normal(0, 0.01, 3)))
        assert motion.known and source(motion) == "POSE" and motion.drift_m == 0.0
    assert list(motion.velocity_m_s) == pytest.approx(FORWARD, abs=0.25)
    assert motion.speed_m_s == pytest.approx(np.linalg.norm(list(motion.velocity_m_s)))
    raw = Motion(velocity_smoothing_s=0.0)
    first = raw.update(0.0, pose((1, 2, 3)))
    assert first.known and not first.velocity_known and list(first.velocity_m_s) == [0, 0, 0]
    second = raw.update(0.5, pose((2, 2, 7)))
    assert second.velocity_known and list(second.velocity_m_s) == pytest.approx([2, 0, 8])
    assert list(raw.update(1.0, pose((3, 2, 3))).velocity_m_s) == pytest.approx([2, 0, -8])


@pytest.mark.parametrize("period_s", [0.05, 0.4])
def test_turn_rate_from_poses(period_s: float) -> None:
    random = seeded(4)
    rate, start = random.normal(0, 0.3, 3), Rotation.from_rotvec(random.normal(0, 1, 3))
    stage = Motion()
    for frame in range(5):
        turned = Rotation.from_rotvec(rate * period_s * frame) * start
        motion = stage.update(period_s * frame, pose((0, 0, 0), turned.as_matrix()))
    assert list(motion.turn_rate_rad_s) == pytest.approx(rate, abs=1e-9)
    ahead = stage.update(period_s * 4 + 0.7)  # without a pose: turned on
    expected = Rotation.from_rotvec(rate * (period_s * 4 + 0.7)) * start
    assert rotation(ahead) == pytest.approx(expected.as_matrix(), abs=1e-9)


def test_the_flight_direction() -> None:
    """It lies along the velocity, and along the optical axis when slower than VISTA_SPEED_MIN_M_S; so does
    the path."""
    turn = Rotation.from_euler("xyz", [4, -7, 3], degrees=True).as_matrix()
    stage = Motion()
    for t_s, velocity, expected in (
        (0.0, None, turn[:, 2]),
        (0.1, (3.0, 0.0, 4.0), [0.6, 0.0, 0.8]),
        (0.2, (0.3, 0.0, 0.0), turn[:, 2]),
    ):
        motion = stage.update(t_s, pose((1, 2, 3), turn), velocity)
        assert list(motion.direction) == pytest.approx(expected)
        path = stage.path(motion)
        assert list(path.start_m) == [1, 2, 3]
        assert (list(path.direction), path.curvature_1_m) == (list(motion.direction), 0.0)


# ---- the path flown next ----


def circle(radius_m: float, speed_m_s: float, t_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and rotation on a circle to the right, tangent to z at t = 0; y is the axis."""
    angle = speed_m_s * t_s / radius_m
    position = radius_m * np.array([1.0 - math.cos(angle), 0.0, math.sin(angle)])
    return position, Rotation.from_rotvec([0.0, angle, 0.0]).as_matrix()


def flown_circle(radius_m: float, speed_m_s: float, frames: int = 40, noise=None):
    stage = Motion()
    for frame in range(frames):
        position, turned = circle(radius_m, speed_m_s, 0.1 * frame)
        if noise is not None:
            position = position + noise.normal(0, 0.01, 3)
            turned = turned @ Rotation.from_rotvec(noise.normal(0, math.radians(0.03), 3)).as_matrix()
        motion = stage.update(0.1 * frame, pose(position, turned))
    return stage, motion


@pytest.mark.parametrize(("radius_m", "speed_m_s"), [(25.0, 10.0), (60.0, 12.0), (15.0, 3.0), (-25.0, 10.0)])
@pytest.mark.parametrize("noisy", [False, True])
def test_in_a_bend_the_path_is_the_arc(radius_m: float, speed_m_s: float, noisy: bool) -> None:
    """What is flown is near the arc within its length, and nearer than to the straight line."""
    stage, motion = flown_circle(radius_m, speed_m_s, noise=seeded(5) if noisy else None)
    path = stage.path(motion)
    assert path.curvature_1_m == pytest.approx(1.0 / abs(radius_m), rel=0.3 if noisy else 0.2)
    assert path.length_m <= 100.0 and path.length_m * path.curvature_1_m <= math.pi / 2 + 1e-9
    start, ahead, aside = (np.array(list(x)) for x in (path.start_m, path.direction, path.normal))
    assert abs(ahead @ aside) < 1e-9
    for share in (0.25, 0.5, 0.75, 1.0):
        along_m = share * path.length_m
        flown, _ = circle(radius_m, speed_m_s, 3.9 + along_m / speed_m_s)
        angle = path.curvature_1_m * along_m
        arc = start + (np.sin(angle) * ahead + (1.0 - np.cos(angle)) * aside) / path.curvature_1_m
        assert np.linalg.norm(flown - arc) < 2.0, share
        straight = start + along_m * np.array(list(motion.direction))
        assert np.linalg.norm(flown - arc) < np.linalg.norm(flown - straight) + 0.1, share


@pytest.mark.parametrize("noisy", [False, True])
def test_a_bend_is_known_half_a_second_after_the_first_pose(noisy: bool) -> None:
    """A recording that begins in a turn: there the slower mean is no older than the faster one."""
    for frames in range(6, 30):
        stage, motion = flown_circle(60.0, 12.0, frames, noise=seeded(frames) if noisy else None)
        path = stage.path(motion)
        if noisy:
            assert path.curvature_1_m < 1.7 / 60.0
        else:
            assert path.curvature_1_m == pytest.approx(1.0 / 60.0, rel=0.05)
            position, _ = circle(60.0, 12.0, 0.1 * (frames - 1))
            ahead, _ = circle(60.0, 12.0, 0.1 * (frames - 1) + 0.01)
            tangent = (ahead - position) / np.linalg.norm(ahead - position)
            assert np.array(list(path.direction)) @ tangent > math.cos(math.radians(0.3))


def test_a_long_slow_bend_is_known_though_the_camera_sways() -> None:
    """2.3 degrees a second, and a sway that turns the camera by as much to and fro about each axis. The mean
    over a second tells two thirds of the bend, whatever the phases; without it a fifth is told, and what lies
    30 m ahead is 1.8 m off."""
    phases, stage, found = seeded(6).uniform(0.0, 2.0 * math.pi, 3), Motion(), []
    for frame in range(45):
        t_s = 0.13 * frame
        position, turned = circle(200.0, 8.0, t_s)
        sway_rad = np.array([0.013, 0.007, 0.013]) * np.sin(np.array([4.1, 5.5, 3.3]) * t_s + phases)
        sway = Rotation.from_rotvec(sway_rad).as_matrix()
        motion = stage.update(t_s, pose(position, turned @ sway))
        found.append(stage.path(motion).curvature_1_m)
    assert 0.5 / 200.0 < np.mean(found[22:]) < 1.0 / 200.0
    assert max(found[22:]) < 1.3 / 200.0


def test_a_path_that_may_be_bending_is_not_believed_for_long() -> None:
    """A slow bend that has just begun to be seen: sway hides it, and the path still seems straight."""
    lengths_m, off_m = [], []
    for phases in seeded(8).uniform(0.0, 2.0 * math.pi, (20, 3)):
        stage = Motion()
        for frame in range(14):
            t_s = 0.13 * frame
            position, turned = circle(200.0, 8.0, t_s)
            sway_rad = 0.006 * np.sin(np.array([4.1, 5.5, 3.3]) * t_s + phases)
            sway = Rotation.from_rotvec(sway_rad).as_matrix()
            path = stage.path(stage.update(t_s, pose(position, turned @ sway)))
            if frame >= 6:
                lengths_m.append(path.length_m)
                off_m.append(0.5 * abs(1.0 / 200.0 - path.curvature_1_m) * path.length_m**2)
    assert np.mean(lengths_m) < 70.0 and np.median(off_m) < 4.0  # as if straight: 100 m and 25 m


@pytest.mark.parametrize("speed_m_s", [3.0, 12.0])
@pytest.mark.parametrize("seed", range(5))
def test_a_straight_flight_with_noisy_poses_stays_straight(speed_m_s: float, seed: int) -> None:
    """Noise of each pose, and an error that drifts as that of a navigation filter. Now and then a slight
    bend is seen; never one that leaves the collision volume within 20 m."""
    random, stage = seeded(seed), Motion()
    drift, turned_m, lengths_m = np.zeros(3), [], []
    for frame in range(120):
        drift = 0.99 * drift + random.normal(0, math.radians(0.3 * 0.14), 3)
        attitude = Rotation.from_rotvec(drift + random.normal(0, math.radians(0.05), 3)).as_matrix()
        position = np.array([0.0, 0.0, 0.1 * speed_m_s * frame]) + random.normal(0, 0.01, 3)
        path = stage.path(stage.update(0.1 * frame, pose(position, attitude)))
        turned_m.append(0.5 * path.curvature_1_m * 20.0**2)
        lengths_m.append(path.length_m)
    assert np.mean(np.array(turned_m) == 0.0) > 0.9
    assert max(turned_m) < 2.0
    assert np.median(lengths_m) == 100.0


def test_a_camera_that_looks_about_does_not_bend_the_path() -> None:
    stage = Motion()
    for frame in range(30):
        yaw = Rotation.from_rotvec([0.0, 0.3 * 0.1 * frame, 0.0]).as_matrix()
        motion = stage.update(0.1 * frame, pose((0, 0, 0.9 * frame), yaw))
    assert np.linalg.norm(list(motion.turn_rate_rad_s)) == pytest.approx(0.3, rel=0.01)
    assert stage.path(motion).curvature_1_m == 0.0


def test_wind_that_pushes_the_aircraft_aside_does_not_bend_the_path() -> None:
    """3 m/s, and to and fro by 0.1 m/s within 5 s. The camera's heading sways by 0.4 degrees a second."""
    for phase in seeded(7).uniform(0.0, 2.0 * math.pi, 20):
        stage = Motion()
        for frame in range(40):
            swing = 2.0 * math.pi / 5.0 * 0.1 * frame + phase
            yaw = Rotation.from_rotvec([0.0, math.radians(0.3) * math.sin(swing), 0.0]).as_matrix()
            aside_m = -0.1 * 5.0 / (2.0 * math.pi) * math.cos(swing)
            path = stage.path(stage.update(0.1 * frame, pose((aside_m, 0, 0.3 * frame), yaw)))
            assert path.curvature_1_m == 0.0


def test_how_well_the_direction_is_known_is_what_it_swayed_by() -> None:
    """A sway of 1 degree up and down within 5 s, whatever its phase; steady flight, straight or in a bend."""
    swing, sway = 2.0 * math.pi / 5.0, math.radians(1.0)
    for phase in seeded(8).uniform(0.0, 2.0 * math.pi, 20):
        stage, told_rad = Motion(), []
        for frame in range(60):
            t_s = 0.1 * frame
            up_m = -12.0 * sway / swing * math.cos(swing * t_s + phase)
            path = stage.path(stage.update(t_s, pose((0.0, up_m, 12.0 * t_s))))
            told_rad.append(path.sigma_rad)
        assert sway / 3.0 < np.mean(told_rad[20:]) < 1.5 * sway
    steady = Motion()
    for flown, motion in ((steady, fly(steady, np.arange(40) * 0.1)), flown_circle(60.0, 12.0)):
        assert math.radians(0.05) < flown.path(motion).sigma_rad < math.radians(0.3)


def test_a_direction_that_was_watched_for_a_moment_only_is_less_certain() -> None:
    """Steady flight: by half a degree and more in the first half second, by a fifth of one after 3 s."""
    for frames, least_deg, most_deg in ((5, 0.5, 0.9), (15, 0.2, 0.5), (31, 0.1, 0.2)):
        stage = Motion()
        sigma_rad = stage.path(fly(stage, np.arange(frames) * 0.1)).sigma_rad
        assert least_deg <= math.degrees(sigma_rad) <= most_deg


def test_what_stands_or_hardly_moves_has_a_straight_path() -> None:
    for speed_m_s in (0.0, 0.3):
        stage, motion = flown_circle(2.0, speed_m_s)
        assert stage.path(motion).curvature_1_m == 0.0
    stage, motion = flown_circle(25.0, 10.0)
    assert stage.path(stage.update(4.0, stationary=True)).curvature_1_m == 0.0


# ---- no pose ----


def test_after_frames_without_a_pose_the_velocity_is_right() -> None:
    """Ten metres a second, no pose in three frames: the displacement belongs to 0.4 s, not to 0.1 s."""
    for smoothing_s in (0.0, 0.3):
        stage = Motion(velocity_smoothing_s=smoothing_s)
        before = fly(stage, [0.0, 0.1, 0.2])
        for t_s in (0.3, 0.4, 0.5):
            missing = stage.update(t_s)
            assert not missing.known and not missing.velocity_known
            assert source(missing) == "CARRIED_ON"
            assert list(missing.velocity_m_s) == pytest.approx(FORWARD)
            assert place(missing) == pytest.approx(FORWARD * t_s)  # not the world's origin
            assert missing.drift_m == pytest.approx(0.05)
        after = stage.update(0.6, pose(FORWARD * 0.6))
        assert list(before.velocity_m_s) == pytest.approx(FORWARD)
        assert list(after.velocity_m_s) == pytest.approx(FORWARD)
        assert after.known and after.velocity_known and after.drift_m == 0.0


def test_a_pose_that_repeats_in_flight_is_an_old_one() -> None:
    """A navigation filter that has no new pose gives the last one again. The aircraft flies on."""
    stage = Motion()
    times = 0.1 * np.arange(20)
    fly(stage, times)
    for frame in range(20, 24):
        motion = stage.update(0.1 * frame, pose(FORWARD * times[-1]))
        assert source(motion) == "CARRIED_ON" and not motion.known
        assert place(motion) == pytest.approx(FORWARD * 0.1 * frame)
    motion = stage.update(2.4, pose(FORWARD * 2.4))
    assert source(motion) == "POSE" and list(motion.velocity_m_s) == pytest.approx(FORWARD)


def test_a_pose_that_repeats_for_long_is_believed() -> None:
    """The vehicle stands from a second on; it is not carried on any more, nor again."""
    stage = Motion()
    times = 0.1 * np.arange(20)
    fly(stage, times)
    sources = [source(stage.update(0.1 * frame, pose(FORWARD * times[-1]))) for frame in range(20, 60)]
    assert sources[:9] == ["CARRIED_ON"] * 9 and set(sources[10:]) == {"POSE"}
    motion = stage.update(6.0, pose(FORWARD * times[-1]))
    assert motion.speed_m_s < 0.1 and place(motion) == pytest.approx(FORWARD * times[-1])


def test_a_pose_that_repeats_while_the_vehicle_stands_is_a_pose() -> None:
    stage = Motion()
    assert {source(stage.update(0.1 * frame, pose((1, 2, 3)))) for frame in range(20)} == {"POSE"}


def test_without_any_pose_motion_is_not_known() -> None:
    stage = Motion()
    for t_s in (0.0, 1.0, 2.0):
        motion = stage.update(t_s)
        assert not motion.known and not motion.velocity_known and source(motion) == "UNTOLD"
        assert place(motion).tolist() == [0, 0, 0] and list(motion.direction) == [0, 0, 1]
        assert motion.speed_m_s == motion.drift_m == 0.0


def test_a_camera_that_stands_is_known_to() -> None:
    stage = Motion()
    for t_s in (0.0, 1.0):
        motion = stage.update(t_s, stationary=True)
        assert motion.known and motion.velocity_known and motion.speed_m_s == 0.0
        assert source(motion) == "STANDS"
    stage = Motion()
    last = fly(stage, [0.0, 0.1])
    motion = stage.update(5.0, stationary=True)  # landed
    assert place(motion).tolist() == place(last).tolist() and motion.speed_m_s == 0.0


def test_the_callers_velocity_counts() -> None:
    """It goes over that of the poses; without a pose it carries the camera on, which still is a guess."""
    stage, said = Motion(), (0.0, 0.0, 5.0)
    fly(stage, [0.0, 0.1])
    assert list(stage.update(0.2, pose(FORWARD * 0.2), said).velocity_m_s) == list(said)
    motion = stage.update(0.4, velocity=said)
    assert motion.velocity_known and not motion.known
    assert place(motion) == pytest.approx(FORWARD * 0.2 + np.array(said) * 0.2)


# ---- poses that cannot be ----


@pytest.mark.parametrize("jump_m", [1e200, 1e9, -5000.0, 40.0])
def test_one_absurd_pose_is_refused_and_forgotten(jump_m: float) -> None:
    stage, straight = Motion(), Motion()
    fly(stage, [0.0, 0.1, 0.2])
    fly(straight, [0.0, 0.1, 0.2])
    refused = stage.update(0.3, pose(FORWARD * 0.3 + [jump_m, 0, 0]))
    assert not refused.known and source(refused) == "REFUSED"
    assert place(refused) == pytest.approx(FORWARD * 0.3)
    for t_s in (0.4, 0.5, 0.6):
        motion, expected = stage.update(t_s, pose(FORWARD * t_s)), straight.update(t_s, pose(FORWARD * t_s))
        assert motion.known and not motion.restarted
        assert list(motion.velocity_m_s) == pytest.approx(list(expected.velocity_m_s))


def test_a_new_place_is_believed_after_a_few_poses() -> None:
    stage, jump = Motion(), np.array([5000.0, 0.0, 0.0])
    fly(stage, [0.0, 0.1, 0.2])
    for t_s in (0.3, 0.4):
        assert source(stage.update(t_s, pose(jump + FORWARD * t_s))) == "REFUSED"
    motion = stage.update(0.5, pose(jump + FORWARD * 0.5))
    assert motion.known and motion.restarted and not motion.velocity_known
    assert place(motion) == pytest.approx(jump + FORWARD * 0.5)
    motion = stage.update(0.6, pose(jump + FORWARD * 0.6))
    assert not motion.restarted and list(motion.velocity_m_s) == pytest.approx(FORWARD)


def test_poses_that_do_not_agree_are_never_believed() -> None:
    random, stage = seeded(5), Motion()
    fly(stage, [0.0, 0.1])
    for frame in range(2, 40):
        motion = stage.update(0.1 * frame, pose(random.normal(0, 1e6, 3)))
        assert source(motion) == "REFUSED"
    assert place(motion) == pytest.approx(FORWARD * 3.9)


def test_an_absurd_pose_at_the_start() -> None:
    stage = Motion()
    for frame in range(10):
        assert source(stage.update(0.1 * frame, pose((1e200, 0, 0)))) == "REFUSED"
    assert stage.update(1.0, pose((1, 2, 3))).known


# ---- errors ----


@pytest.mark.parametrize(
    ("given", "status"),
    [
        ({"t_ns": 200_000_000}, "VISTA_ERROR_ORDER"),
        ({"t_ns": 0, "raw_pose": pose((math.nan, 0, 0))}, "VISTA_ERROR_ORDER"),  # time comes first
        ({"raw_pose": pose((0, math.inf, 0))}, "VISTA_ERROR_NUMBER"),
        ({"raw_pose": pose((0, 0, 0), np.eye(3) * 2)}, "VISTA_ERROR_RANGE"),
        ({"velocity": (0, math.nan, 0)}, "VISTA_ERROR_NUMBER"),
        ({"velocity": (0, 1e300, 1e300)}, "VISTA_ERROR_NUMBER"),
        ({"velocity": (0, 151.0, 0)}, "VISTA_ERROR_RANGE"),
    ],
)
def test_on_errors_nothing_changes(given: dict, status: str) -> None:
    stage = Motion()
    fly(stage, [0.0, 0.1, 0.2])
    before = bytes(ffi.buffer(stage.state))
    assert stage.try_update(**{"t_ns": 300_000_000} | given)[0] == status
    assert bytes(ffi.buffer(stage.state)) == before
