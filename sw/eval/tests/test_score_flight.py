"""Scores of a flight against cases worked out by hand: obstacles are put where hits, misses, false alarms, id
switches and errors are known."""

from __future__ import annotations

from pathlib import Path

import cv2
import flight_on_disk as disk
import numpy as np
import pytest
from fake_pipeline import fake_motion, fake_obstacle, fake_record
from vista import parameters
from vista.errors import InputError
from vista.geometry import Calibration, Pose
from vista.pipeline import Obstacle
from vista_eval.dataset.truth import read_truth
from vista_eval.metrics.flight_score import FOOT_M, FlightScore, score_records
from vista_eval.metrics.frame_truth import Points, flight_frames, thinned
from vista_eval.pose_noise import ATTITUDE_SIGMA_DEG, POSITION_SIGMA_M, noisy_poses

pytestmark = pytest.mark.slow

FRAMES, LAST_RANGE_M = 45, 10.0  # ranges 54, 53, ... 10 m: 14.5 to 45 m are frames 9 to 39
BAND = range(9, 40)


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return disk.write_flight(
        tmp_path_factory.mktemp("flights") / "sign", frames=FRAMES, last_range_m=LAST_RANGE_M
    )


CAMERA = Calibration(disk.WIDTH, disk.HEIGHT, disk.FOCAL_PX, disk.CU, disk.CV, disk.BASELINE_M)


def obstacle(position_m: np.ndarray, **changes: object) -> Obstacle:
    """A warning; its distance and ellipse play no part in the score of the target."""
    usual = {
        "position_m": np.asarray(position_m, float),
        "covariance_m2": np.eye(3),
        "extent_m": (1.6, 1.2),
        "in_collision_volume": True,
    }
    return fake_obstacle(1, 30.0, CAMERA, **(usual | changes))


def one_level() -> parameters.Values:
    """More see nearer than these flights go."""
    values = parameters.defaults()
    return values | {"stereo": values["stereo"] | {"levels": 1}}


def score(
    folder: Path, obstacles: dict[int, list[Obstacle]], poses: dict[int, Pose] | None = None
) -> FlightScore:
    """obstacles of each frame by its number; poses: as the chain believes them."""
    _, frames = flight_frames(folder)
    records = [
        fake_record(
            k,
            frame.t_ns,
            obstacles.get(k, ()),
            motion=fake_motion((poses or {}).get(k, frame.world_from_camera)),
            stage_ms={"host": 3.0},
        )
        for k, frame in enumerate(frames)
    ]
    return score_records(folder, records, one_level())


def everywhere(*obstacles: Obstacle) -> dict[int, list[Obstacle]]:
    return {frame: list(obstacles) for frame in range(FRAMES)}


SIGN_M = np.array(disk.SIGN.center_m)


def test_a_perfect_flight(flight: Path) -> None:
    result = score(flight, everywhere(obstacle(SIGN_M)))
    assert (result.hits, result.band_frames, result.missed) == (len(BAND), len(BAND), ())
    assert result.first_detection_m == pytest.approx(54.0)
    assert (result.false_alarm_frames, result.id_switches) == ((), 0)
    assert (result.within_2dz, result.rms_ft, result.error_at_50_ft) == (1.0, 0.0, 0.0)


def test_hits_and_misses_are_counted_in_their_ranges(flight: Path) -> None:
    """Nothing before frame 5 (49 m), none in frames 20 and 21, and the last four, at 13 to 10 m."""
    seen = {k: [obstacle(SIGN_M)] for k in range(5, FRAMES - 4) if k not in (20, 21)}
    result = score(flight, seen)
    assert (result.hits, result.band_frames) == (len(BAND) - 2, len(BAND))
    assert result.missed == (20, 21, *range(FRAMES - 4, FRAMES))
    assert result.first_detection_m == pytest.approx(49.0)


def test_a_first_detection_has_to_stay(flight: Path) -> None:
    seen = {k: [obstacle(SIGN_M)] for k in (2, 3, *range(12, FRAMES))}
    assert score(flight, seen).first_detection_m == pytest.approx(54.0 - 12)


def test_tracked_before_it_is_warned_of(flight: Path) -> None:
    """The sign is tracked from frame 4 on, confirmed from frame 6 and in the collision volume from frame 11
    on; an obstacle 4 m beside it agrees with nothing."""
    beside = obstacle(SIGN_M + np.array([0.0, 4.0, 0.0]), id=7, in_collision_volume=False)
    seen = everywhere(beside)
    for k in range(4, FRAMES):
        seen[k].append(obstacle(SIGN_M, confirmed=k >= 6, in_collision_volume=k >= 11))
    result = score(flight, seen)
    assert result.begins_m == pytest.approx(54.0)
    assert result.tracked_from_m == pytest.approx(54.0 - 6)
    assert result.first_detection_m == pytest.approx(54.0 - 11)
    assert [frame.tracked for frame in result.frames] == [k >= 6 for k in range(FRAMES)]
    assert result.hits == len(BAND) - 2  # frames 9 and 10: tracked, not warned of
    assert result.false_alarm_frames == ()


def test_tracking_has_to_stay_too(flight: Path) -> None:
    """One gap in the next five frames is granted, two are not."""
    aside = obstacle(SIGN_M, in_collision_volume=False)
    for gaps, expected in (({5}, 2), ({5, 6}, 6 + 1), ({4, 7}, 5)):
        seen = {k: [aside] for k in range(2, FRAMES) if k not in gaps}
        result = score(flight, seen)
        assert result.tracked_from_m == pytest.approx(54.0 - expected)
        assert result.first_detection_m is None


def test_what_is_too_thin_for_a_pixel_is_no_false_alarm(tmp_path: Path) -> None:
    """No pixel's centre shows the sign in the first frames; later ones do."""
    folder = disk.write_flight(tmp_path / "sign", frames=FRAMES, last_range_m=LAST_RANGE_M)
    truth = read_truth(folder)
    (sign,) = (thing.label for thing in truth.targets)
    for t_ns in truth.times_ns[:6]:
        hidden = truth.labels(t_ns) == sign
        for kind in ("disparity", "label"):
            path = folder / "truth" / kind / f"{t_ns}.png"
            image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
            cv2.imwrite(str(path), np.where(hidden, 0, image).astype(image.dtype))
    nowhere = obstacle(SIGN_M + np.array([0.0, 0.0, 2.2]), id=9)
    result = score(folder, {2: [obstacle(SIGN_M)], 4: [nowhere]})
    assert result.false_alarm_frames == (4,)
    assert result.hits == 0 and result.frames[2].target is None


@pytest.mark.parametrize("changes", [{"confirmed": False}, {"in_collision_volume": False}])
def test_what_is_not_warned_of_is_no_hit_and_no_alarm(flight: Path, changes: dict[str, object]) -> None:
    result = score(flight, everywhere(obstacle(SIGN_M, **changes)))
    assert (result.hits, result.matched_frames) == (0, 0)
    assert score(flight, everywhere(obstacle(SIGN_M - [9.0, 0, 0], **changes))).false_alarm_frames == ()


def test_false_alarms(flight: Path) -> None:
    """One stands 12 m in front of the sign in frames 10 to 12, two do in frame 12; in frame 20 one is on the
    wall beside the path: something is there, but not in the way."""
    ghost = obstacle(SIGN_M - [12.0, 0.0, 0.0], id=7)
    beside = obstacle(np.array(disk.WALL.center_m), id=9, extent_m=(2.0, 2.0))
    seen = everywhere(obstacle(SIGN_M))
    for k in (10, 11, 12):
        seen[k].append(ghost)
    seen[12].append(ghost.but(id=8))
    seen[20].append(beside)
    result = score(flight, seen)
    assert result.false_alarm_frames == (10, 11, 12, 20)
    assert result.false_alarm_obstacles == 3
    assert result.ghost_frames == 3
    assert result.hits == len(BAND)


@pytest.mark.parametrize(("offset_m", "false"), [(-0.5, ()), (0.5, (20,))])
def test_a_false_alarm_by_the_tolerance(flight: Path, offset_m: float, false: tuple[int, ...]) -> None:
    """The sign 34 m ahead, a warning nearer by 2 dz(r) and half a metre less, or more."""
    dz_per_m2 = 1.0 / (disk.FOCAL_PX * disk.BASELINE_M)
    range_m = (np.sqrt(1.0 + 8.0 * dz_per_m2 * (34.0 - offset_m)) - 1.0) / (4.0 * dz_per_m2)
    assert range_m + 2.0 * dz_per_m2 * range_m**2 + offset_m == pytest.approx(34.0)
    place_m = disk.camera_m(20, FRAMES, LAST_RANGE_M)
    place_m[0] += range_m
    assert score(flight, {20: [obstacle(place_m)]}).false_alarm_frames == false


def test_id_switches_are_those_of_the_target(flight: Path) -> None:
    """1 1 2 2 . 2 1: two switches; the gap is none."""
    ids = {30: 1, 31: 1, 32: 2, 33: 2, 35: 2, 36: 1}
    seen = {k: [obstacle(SIGN_M, id=number)] for k, number in ids.items()}
    assert score(flight, seen).id_switches == 2


def test_the_match_stays_while_it_agrees(flight: Path) -> None:
    """The nearer of two warnings to the sign's centre counts, until it is gone; then the other one, also when
    the first comes back."""
    first, second = (
        obstacle(SIGN_M + np.array([0.1, 0, 0]), id=1),
        obstacle(SIGN_M - np.array([0.5, 0, 0]), id=2),
    )
    seen = {30: [second, first], 31: [second, first], 32: [second], 33: [second, first]}
    result = score(flight, seen)
    assert [result.frames[k].matched_id for k in range(30, 34)] == [1, 1, 2, 2]
    assert result.id_switches == 1


def test_errors_by_hand(flight: Path) -> None:
    """0.6 m behind the sign at every range: RMS, error at 50 ft, and NEES with sigmas 0.3, 1, 1 m."""
    covariance_m2 = np.diag([0.09, 1.0, 1.0])
    behind_m = SIGN_M + np.array([0.6, 0.0, 0.0])
    result = score(flight, everywhere(obstacle(behind_m, covariance_m2=covariance_m2)))
    dz_m = np.array([r**2 / (disk.FOCAL_PX * disk.BASELINE_M) for r in range(54, 9, -1)])
    assert result.rms_ft == pytest.approx(0.6 / FOOT_M)
    assert result.error_at_50_ft == pytest.approx(0.6 / FOOT_M)
    assert result.median_dz == pytest.approx(np.median(0.6 / dz_m))
    assert result.within_2dz == pytest.approx(np.mean(2 * dz_m >= 0.6))
    assert result.consistency.average == pytest.approx(4.0)


def test_a_wrong_pose_is_carried_through_the_camera(flight: Path) -> None:
    """The chain believes to be 1 m to the left and turned by 2 degrees: an obstacle that it has at the right
    place before the camera counts as right."""
    _, frames = flight_frames(flight)
    turn = np.array([[np.cos(0.035), -np.sin(0.035), 0], [np.sin(0.035), np.cos(0.035), 0], [0, 0, 1]])
    error = Pose(turn, np.array([0.0, 1.0, 0.0]))
    poses = {k: error @ frame.world_from_camera for k, frame in enumerate(frames)}
    right = obstacle(turn @ SIGN_M + error.translation_m, covariance_m2=turn @ np.diag([4.0, 1, 1]) @ turn.T)
    result = score(flight, everywhere(right), poses)
    assert result.hits == len(BAND)
    assert result.rms_ft == pytest.approx(0.0, abs=1e-6)


def test_the_blind_zone(tmp_path: Path) -> None:
    """f B = 228.6, 64 candidates: blind nearer than 3.63 m. It ends at 2 m, the last frame silent."""
    folder = disk.write_flight(tmp_path / "near", frames=10, last_range_m=2.0)
    seen = {k: [obstacle(SIGN_M)] for k in range(9)}
    result = score(folder, seen)
    assert (result.blind_frames, result.blind_reported) == (2, 1)
    assert result.missed == (9,)


def test_too_near_to_match_is_a_warning_without_an_estimate(tmp_path: Path) -> None:
    """Id 0 says "up to 3.6 m": right at 3 and 2 m, a false alarm at 12 m; no error, no switch of ids."""
    folder = disk.write_flight(tmp_path / "near", frames=11, last_range_m=2.0)
    _, frames = flight_frames(folder)
    seen = {k: [obstacle(SIGN_M)] for k in range(1, 9)}
    for k in (0, 9, 10):
        place_m = frames[k].world_from_camera.translation_m + np.array([3.6, 0.0, 0.0])
        seen[k] = [obstacle(place_m, id=0, extent_m=(4.0, 4.0))]
    result = score(folder, seen)
    assert (result.blind_frames, result.blind_reported) == (2, 2)
    assert result.false_alarm_frames == (0,)
    assert (result.matched_frames, result.id_switches, result.missed) == (8, 0, (0,))


def test_a_large_target_counts_by_its_surface(tmp_path: Path) -> None:
    """A wall 16 m wide: 3 m aside of the path on it is no error, 0.5 m before it is one of 0.5 m; no NEES."""
    wall = disk.Board("wall", "facade", (0.0, 0.0, 6.0), (16.0, 10.0), target=True)
    folder = disk.write_flight(tmp_path / "wall", (wall,), frames=6, last_range_m=30.0)
    on_it = obstacle(np.array([-0.5, 3.0, 6.0]), extent_m=(12.0, 6.0))
    result = score(folder, everywhere(on_it))
    assert result.hits == 6
    assert [frame.error_m for frame in result.frames] == pytest.approx([0.5] * 6, abs=0.05)
    assert result.consistency is None


def test_without_a_target_nothing_is_missed(tmp_path: Path) -> None:
    folder = disk.write_flight(tmp_path / "free", (disk.WALL,), frames=4)
    result = score(folder, everywhere(obstacle(SIGN_M)))
    assert (result.band_frames, result.hits, result.missed, result.hit_rate) == (0, 0, (), None)
    assert result.false_alarm_frames == (0, 1, 2, 3)


def test_noisy_poses_have_the_sigmas_and_drift_slowly() -> None:
    count = 40_000
    times_ns = [round(k * 1e8) for k in range(count)]
    noisy = noisy_poses([Pose()] * count, times_ns, seed=3)
    shift_m = np.array([pose.translation_m for pose in noisy])
    assert shift_m.std(axis=0) == pytest.approx([POSITION_SIGMA_M] * 3, rel=0.15)
    angle_deg = np.degrees([np.arccos((np.trace(p.rotation) - 1) / 2) for p in noisy])
    assert np.sqrt(np.mean(angle_deg**2)) == pytest.approx(np.sqrt(3) * ATTITUDE_SIGMA_DEG, rel=0.15)
    assert np.abs(np.diff(shift_m, axis=0)).max() < POSITION_SIGMA_M
    again = noisy_poses([Pose()] * 3, times_ns[:3], seed=3)
    np.testing.assert_array_equal(again[2].translation_m, noisy[2].translation_m)


@pytest.mark.parametrize(
    ("content", "problem"),
    [("{", "not readable as JSON"), ('{"version": 7}', "version 7"), ('{"version": 2}', "not the truth")],
)
def test_a_bad_truth_is_named(tmp_path: Path, content: str, problem: str) -> None:
    (tmp_path / "truth.json").write_text(content)
    with pytest.raises(InputError, match=problem):
        read_truth(tmp_path)


def test_thin_parts_of_large_things_are_kept() -> None:
    """A board of 72 x 60 pixels on a pole one pixel wide, in all places against the grid of points."""
    for shift in range(3):
        label = np.zeros((480, 640), np.uint16)
        label[200:260, 300 + shift : 372 + shift] = 1
        label[260:480, 337 + shift] = 1
        v, u = np.nonzero(label)
        blank = np.zeros(len(u), np.float32)
        kept = thinned(Points(None, u, v, label[v, u], blank, blank, blank, blank))
        assert np.array_equal(np.unique(v[kept & (v >= 260)]), np.arange(260, 480))
        assert kept.sum() < len(u) / 4
