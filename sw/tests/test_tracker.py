"""The life of tracks: confirmation, ids, association, what is out of sight, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import Arena, ffi, lib, status_name
from track_library import SECOND, SIGMAS, Tracker, detection, measure, motion, seen_at, state

DT = 0.1
POINT = np.array([1.0, 0.5, 40.0])


INSIDE = 1.9  # sigmas in u, v and d: together within the gate, as 99 of 100 measurements are


def noisy(
    random: np.random.Generator, point, position=(0.0, 0.0, 0.0), most: float = np.inf, **keywords
) -> dict:
    """most: sigmas by which a number may be off."""
    noise = np.clip(random.normal(size=3), -most, most) * SIGMAS
    return detection(measure(point, position) + noise, **keywords)


def beside(measurement: np.ndarray, du_px: float) -> np.ndarray:
    return measurement + np.array([du_px, 0, 0])


def feed(tracker: Tracker, pattern: str, start: int = 0) -> list[list[int]]:
    """One frame a letter, a detection of POINT where it is `x`; the confirmed ids after each."""
    confirmed = []
    for frame, letter in enumerate(pattern, start):
        assert tracker.update(DT * frame, [seen_at(POINT)] if letter == "x" else []) == "VISTA_OK"
        confirmed.append(tracker.confirmed)
    return confirmed


# ---- M of N ----


@pytest.mark.parametrize(
    ("pattern", "confirmed_at"), [("xxx", 2), ("x.xx", 3), ("x..xx", 4), ("x.x.x", 4), ("xx..x", 4)]
)
def test_confirmed_with_the_third_hit_in_five_frames(pattern: str, confirmed_at: int) -> None:
    tracker = Tracker()
    for frame, confirmed in enumerate(feed(tracker, pattern)):
        assert confirmed == ([1] if frame >= confirmed_at else [])
    assert tracker.tracks[1].age_frames == len(pattern)
    assert tracker.tracks[1].hits == pattern.count("x")


def test_a_tentative_track_dies_as_soon_as_it_cannot_be_confirmed() -> None:
    tracker = Tracker()
    feed(tracker, "x..")
    assert list(tracker.tracks) == [1]
    feed(tracker, ".", start=3)
    assert not tracker.tracks
    feed(tracker, "x", start=4)
    assert list(tracker.tracks) == [2]  # an id is never used again


@pytest.mark.parametrize(("hits", "window"), [(1, 1), (2, 2), (4, 6), (32, 32)])
def test_other_m_of_n(hits: int, window: int) -> None:
    tracker = Tracker(confirm_hits=hits, confirm_window=window)
    for frame, confirmed in enumerate(feed(tracker, "x" * hits)):
        assert bool(confirmed) == (frame == hits - 1)


def test_a_confirmed_track_survives_miss_max_frames_and_no_more() -> None:
    tracker = Tracker(miss_max=5)
    feed(tracker, "xxx.....")
    track = tracker.tracks[1]
    assert (track.misses, track.coasting, track.label) == (5, True, -1)
    assert feed(tracker, "x", start=8) == [[1]]
    assert tracker.tracks[1].misses == 0
    feed(tracker, "......", start=9)
    assert not tracker.tracks


def test_window_shows_the_last_frames() -> None:
    tracker = Tracker()
    feed(tracker, "xxx.x..x")
    assert tracker.tracks[1].window == 0b11101001
    assert tracker.tracks[1].seen_frames == 8


# ---- ids ----


def test_ids_hold_through_misses_on_a_moving_platform() -> None:
    random = seeded(1)
    points = {i: np.array([4.0 * i - 8, (i % 2) * 3.0 - 1.5, 70.0 + 5 * i]) for i in range(5)}
    tracker, owner, missed = Tracker(), {}, dict.fromkeys(points, 0)
    for frame in range(60):
        position = np.array([0.0, 0.0, 0.5 * frame])
        seen = [i for i in points if frame < 5 or missed[i] == 3 or random.random() < 0.7]
        missed = {i: 0 if i in seen else missed[i] + 1 for i in points}
        order = random.permutation(seen) if seen else []
        # What lies outside of the gate begins a track of its own, and is no matter of this test.
        found = [noisy(random, points[i], position, INSIDE, label=i) for i in order]
        tracker.update(DT * frame, found, position)
        for id_, track in tracker.tracks.items():
            if track.confirmed and not track.coasting:
                assert owner.setdefault(id_, track.label) == track.label
    assert sorted(owner.values()) == sorted(points)


def test_crossing_obstacles_keep_their_ids() -> None:
    """Two obstacles pass each other; neither takes the other's detections."""
    tracker = Tracker(velocity_sigma_m_s=5.0)
    random = seeded(2)
    owner: dict[int, int] = {}
    for frame in range(60):
        x = -3 + 0.1 * frame
        left = noisy(random, (x, -0.35, 30.0), label=1)
        right = noisy(random, (-x, 0.35, 30.0), label=2)
        tracker.update(DT * frame, [left, right] if frame % 2 else [right, left])
        for id_ in tracker.confirmed:
            track = tracker.tracks[id_]
            assert track.coasting or owner.setdefault(id_, track.label) == track.label
    assert sorted(owner.values()) == [1, 2]


def crossing_m(frame: int) -> np.ndarray:
    """Across at 9 m/s, far out of the gate of what stands."""
    return np.array([-9.0, 0.5, 60.0]) + CROSSING_M_S * DT * frame


CROSSING_M_S = np.array([9.0, 0.0, -3.0])


def test_what_moves_fast_is_one_track_of_its_velocity() -> None:
    """It takes two hits more than what stands needs."""
    tracker = Tracker()
    for frame in range(20):
        tracker.update(DT * frame, [detection(measure(crossing_m(frame)))])
        assert len(tracker.confirmed) == (frame >= 4)
    (id_,) = tracker.confirmed
    track = tracker.tracks[id_]
    assert track.moved and track.hits == 20
    assert list(track.velocity_m_s) == pytest.approx(CROSSING_M_S, abs=1.5)
    assert tracker.raw()[1] == 1


def test_noise_seldom_delays_what_moves_fast() -> None:
    """Now and then a detection falls out of the gates that link the first two: the track starts later."""
    random, confirmed_at, velocities, runs = seeded(7), [], [], 100
    for _ in range(runs):
        tracker, confirmed = Tracker(), []
        for frame in range(20):
            assert tracker.update(DT * frame, [noisy(random, crossing_m(frame))]) == "VISTA_OK"
            confirmed.append(len(tracker.confirmed))
        confirmed_at.append(confirmed.index(1))
        assert confirmed[-1] == 1
        (id_,) = tracker.confirmed
        assert tracker.tracks[id_].moved
        velocities.append(list(tracker.tracks[id_].velocity_m_s))
    assert np.abs(np.mean(velocities, axis=0) - CROSSING_M_S).max() < 0.3
    assert np.abs(np.subtract(velocities, CROSSING_M_S)).max() < 3.0
    assert min(confirmed_at) == 4 and max(confirmed_at) <= 9
    assert confirmed_at.count(4) >= 0.85 * runs


def test_what_may_have_moved_takes_nothing_from_what_stands() -> None:
    """Things of one size in a row, each seen now and then: as many are followed as if nothing could move."""
    random, trackers, followed = seeded(8), [Tracker(), Tracker(moving_sigma_m_s=0.0)], [0, 0]
    points = [np.array([1.5 * i - 6, 0.0, 30.0]) for i in range(9)]
    for frame in range(200):
        items = [noisy(random, p, label=i) for i, p in enumerate(points) if random.random() < 0.6]
        for k, tracker in enumerate(trackers):
            tracker.update(DT * frame, items)
            seen = [t for t in tracker.tracks.values() if t.confirmed and not t.coasting]
            assert all(abs(t.position_m[0] - points[t.label][0]) < 0.75 for t in seen)
            followed[k] += len({t.label for t in seen})
    assert followed[0] > 0.97 * followed[1] > 200


def test_association_is_global() -> None:
    """A suits both tracks, B only the first: the nearest pair taken first would strand the second."""
    tracker, thin = Tracker(attitude_sigma_deg=0.0), {"extent": (0.1, 0.1)}
    base = measure(POINT)
    for frame in range(6):
        pair = [detection(base, label=1, **thin), detection(beside(base, 5.0), label=2, **thin)]
        tracker.update(DT * frame, pair)
    assert tracker.confirmed == [1, 2]
    moved = [detection(beside(base, 2.4), label=1, **thin), detection(beside(base, -2.0), label=3, **thin)]
    tracker.update(DT * 6, moved)
    labels = {id_: track.label for id_, track in tracker.tracks.items()}
    assert labels == {1: 3, 2: 1}


@pytest.mark.parametrize("order", [1, -1])
def test_extent_decides_between_equals(order: int) -> None:
    tracker, base = Tracker(), measure(POINT)
    low, high = {"extent": (0.05, 0.5), "label": 1}, {"extent": (0.05, 4.0), "label": 2}
    for frame in range(5):
        tracker.update(DT * frame, [detection(base, **low), detection(beside(base, 9.0), **high)])
    assert tracker.confirmed == [1, 2]
    tracker.update(
        DT * 5, [detection(beside(base, 4.7), **low), detection(beside(base, 4.3), **high)][::order]
    )
    assert {id_: track.label for id_, track in tracker.tracks.items()} == {1: 1, 2: 2}


def test_a_split_region_neither_moves_the_id_nor_starts_a_second_obstacle() -> None:
    tracker = Tracker()
    base, extent = measure((0.0, 0.0, 30.0)), (4.0, 2.0)
    half_px = 0.25 * extent[0] * 1000.0 / 30.0  # centre of either half
    for frame in range(60):
        whole = [detection(base, extent=extent)]
        halves = [detection(beside(base, side * half_px), extent=(2.0, 2.0)) for side in (-1, 1)]
        tracker.update(DT * frame, halves if frame > 5 and frame % 3 == 0 else whole)
        assert len(tracker.tracks) == 1
    track = tracker.tracks[1]
    assert track.confirmed
    assert track.hits == 60
    assert abs(track.position_m[0]) < 0.3
    assert track.extent_m[0] == pytest.approx(4.0, rel=0.25)


def test_a_region_that_changes_for_good_keeps_its_id() -> None:
    tracker = Tracker()
    base = measure((0.0, 0.0, 30.0))
    for frame in range(10):
        tracker.update(DT * frame, [detection(base, extent=(4.0, 2.0))])
    for frame in range(10, 60):
        tracker.update(DT * frame, [detection(beside(base, -33.0), extent=(2.0, 2.0))])
        assert list(tracker.tracks) == [1]
    assert tracker.tracks[1].position_m[0] == pytest.approx(-1.0, abs=0.15)
    assert tracker.tracks[1].extent_m[0] == pytest.approx(2.0, rel=0.1)


def test_neighbours_and_what_stands_behind_are_obstacles_of_their_own() -> None:
    tracker = Tracker()
    wide = {"extent": (2.0, 2.0)}
    for frame in range(6):
        tracker.update(DT * frame, [seen_at((0, 0, 25.0), **wide)])
    for frame in range(6, 12):
        items = [
            seen_at((0, 0, 25.0), **wide),
            seen_at((2.5, 0, 25.0), **wide),
            seen_at((0.3, 0, 45.0), **wide),
        ]
        tracker.update(DT * frame, items)
    assert tracker.confirmed == [1, 2, 3]


def test_tracks_that_converge_become_the_older_one() -> None:
    tracker = Tracker()
    for frame in range(6):
        tracker.update(DT * frame, [seen_at((x, 0, 20.0), extent=(2.0, 2.0)) for x in (-1.4, 1.4)])
    assert tracker.confirmed == [1, 2]
    for frame in range(6, 40):
        x = max(0.0, 1.4 - 0.1 * (frame - 5))
        tracker.update(DT * frame, [seen_at((s * x, 0, 20.0), extent=(2.0, 2.0)) for s in (-1, 1)])
    assert list(tracker.tracks) == [1]
    assert tracker.tracks[1].age_frames == 40


# ---- out of sight ----


def fly(tracker: Tracker, point, frames: range, speed: float, seen) -> dict[int, list[int]]:
    """Straight along z; `seen(frame, measurement)` says whether there is a detection. Ids alive by frame."""
    alive = {}
    for frame in frames:
        position = np.array([0.0, 0.0, speed * DT * frame])
        visible = point[2] > position[2] + 0.1 and seen(frame, measure(point, position))
        items = [seen_at(point, position)] if visible else []
        assert tracker.update(DT * frame, items, position) == "VISTA_OK"
        alive[frame] = list(tracker.tracks)
    return alive


def test_the_blind_zone_keeps_an_obstacle_until_it_is_passed() -> None:
    tracker, speed, point = Tracker(), 9.144, np.array([0.3, 0.2, 40.0])
    alive = fly(tracker, point, range(60), speed, lambda _, z: z[2] < 31)
    for frame, ids in alive.items():
        assert ids == ([1] if speed * DT * frame < 40.0 - 0.05 else []), frame


def test_the_blind_zone_ends_after_a_set_time() -> None:
    tracker, hover = Tracker(), (0.0, 0.0, 2.2)
    fly(tracker, np.array([0.0, 0.0, 15.5]), range(12), 2.0, lambda _, z: z[2] < 31)
    track = tracker.tracks[1]
    assert (track.in_blind_zone, track.coasting, track.confirmed, track.misses) == (True, True, True, 0)
    alive = 0
    for frame in range(12, 330):
        tracker.update(DT * frame, [], hover)
        hidden_ns = round(DT * frame * SECOND) - track.visible_t_ns
        if abs(hidden_ns - 30 * SECOND) > 0.5 * DT * SECOND:
            assert bool(tracker.tracks) == (hidden_ns < 30 * SECOND)
        alive += bool(tracker.tracks)
    assert 290 < alive < 300


@pytest.mark.parametrize(("gap_s", "lives"), [(1.0, True), (1e7, False)])
def test_a_track_that_went_on_to_where_nothing_is_matched_is_lost(gap_s: float, lives: bool) -> None:
    tracker = Tracker()
    for frame in range(20):
        tracker.update(DT * frame, [seen_at((0.2, 0.1, 30.0 + 6.0 * DT * frame))])
    assert tracker.tracks[1].velocity_m_s[2] > 1.0
    tracker.update(DT * 19 + gap_s, [])
    assert bool(tracker.tracks) == lives


def test_out_of_view_is_not_blamed_but_ends() -> None:
    tracker, still = Tracker(), (0.0, 0.0, 0.0)
    for frame in range(5):
        tracker.update(DT * frame, [seen_at(POINT) | {"volume_pixels": 0}], still)
    turned = np.array([[np.cos(0.6), 0, np.sin(0.6)], [0, 1, 0], [-np.sin(0.6), 0, np.cos(0.6)]])
    for frame in range(5, 7):
        tracker.update(DT * frame, [], still, turned)
        track = tracker.tracks[1]
        assert (track.in_view, track.misses, track.coasting) == (False, 0, True)
    tracker.update(0.8, [], still, turned)
    assert not tracker.tracks


def test_what_is_in_the_way_is_kept_out_of_view_until_it_is_passed() -> None:
    """1.5 m to the right, so it leaves the view before it is in the blind zone of 2 m."""
    tracker, speed, point = Tracker(disparity_max_px=230.0), 3.0, np.array([1.5, 0.0, 12.0])
    alive = fly(tracker, point, range(60), speed, lambda _, z: z[0] < 634)
    for frame, ids in alive.items():
        assert ids == ([1] if speed * DT * frame < 12.0 - 0.05 else []), frame


def test_back_in_view_it_is_the_same_obstacle() -> None:
    tracker, still = Tracker(), (0.0, 0.0, 0.0)
    turned = np.array([[np.cos(0.6), 0, np.sin(0.6)], [0, 1, 0], [-np.sin(0.6), 0, np.cos(0.6)]])
    for frame in range(20):
        away = 6 <= frame < 14
        tracker.update(DT * frame, [] if away else [seen_at(POINT)], still, turned if away else None)
    assert tracker.confirmed == [1]
    assert tracker.tracks[1].hits == 12


def test_columns_without_disparity_are_out_of_view() -> None:
    tracker = Tracker()
    z = measure(POINT)
    for frame in range(4):
        tracker.update(DT * frame, [detection([38.0, z[1], z[2]])])
    assert tracker.tracks[1].in_view
    sideways = (0.2, 0.0, 0.0)  # 5 px to the left
    for frame in range(4, 6):
        tracker.update(DT * frame, [], sideways)
    assert (tracker.tracks[1].in_view, tracker.tracks[1].misses) == (False, 0)


def test_far_detections_start_nothing() -> None:
    tracker = Tracker(range_max_m=60.0)
    for frame in range(5):
        tracker.update(DT * frame, [seen_at((0, 0, 59.0)), seen_at((9, 0, 61.0))])
    assert list(tracker.tracks) == [1]


# ---- capacity ----


def test_a_full_table_gives_up_its_least_certain_tentative_track() -> None:
    tracker = Tracker(max_tracks=3)
    far, middle, near, nearest = (
        seen_at((x, 0, z)) for x, z in ((-9, 90.0), (0, 60.0), (6, 40.0), (-2, 20.0))
    )
    for frame in range(3):
        tracker.update(DT * frame, [far])
    tracker.update(DT * 3, [far, middle, near])
    assert list(tracker.tracks) == [1, 2, 3]
    tracker.update(DT * 4, [far, near, nearest])  # `middle` missed, as certain by hits, less by variance
    assert list(tracker.tracks) == [1, 3, 4]
    assert lib.vista_tracker_dropped(tracker.handle) == 1
    for frame in range(5, 8):
        tracker.update(DT * frame, [far, near, nearest, middle])
    assert tracker.confirmed == [1, 3, 4]
    assert lib.vista_tracker_dropped(tracker.handle) == 4  # confirmed tracks are never given up


# ---- what is refused ----


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        ((SECOND, [], motion()), "VISTA_ERROR_ORDER"),
        ((SECOND - 1, [], motion()), "VISTA_ERROR_ORDER"),
        ((2 * SECOND, [seen_at(POINT) | {"u_px": NAN}], motion()), "VISTA_ERROR_NUMBER"),
        ((2 * SECOND, [seen_at(POINT), seen_at(POINT) | {"sigma_u_px": 0.0}], motion()), "VISTA_ERROR_RANGE"),
        ((2 * SECOND, [seen_at(POINT) | {"disparity_px": -1.0}], motion()), "VISTA_ERROR_RANGE"),
        ((2 * SECOND, [seen_at(POINT) | {"extent_m": [INF, 1.0]}], motion()), "VISTA_ERROR_NUMBER"),
        ((2 * SECOND, [seen_at(POINT)] * 33, motion()), "VISTA_ERROR_CAPACITY"),
    ],
)
def test_on_errors_nothing_changes(arguments, status: str) -> None:
    tracker = Tracker()
    for frame in range(11):
        tracker.update(DT * frame, [seen_at(POINT), seen_at((-3, 0, 25.0))])
    before = tracker.memory()
    assert tracker.update_raw(*arguments) == status
    assert tracker.memory() == before
    assert tracker.update_raw(2 * SECOND, [seen_at(POINT)], motion()) == "VISTA_OK"


def test_capacities_out_of_range_are_refused() -> None:
    out = ffi.new("vista_tracker **")
    for sizes in ((0, 5), (5, 0), (lib.VISTA_TRACKER_MAX + 1, 5)):
        arena = Arena(lambda arena, s=sizes: lib.vista_tracker_layout(*s, arena, out))
        assert status_name(arena.status) == "VISTA_ERROR_RANGE"


# ---- the rest of the contract ----


def test_a_pose_that_was_carried_on_adds_to_the_uncertainty() -> None:
    given, carried_on = Tracker(), Tracker()
    for tracker in (given, carried_on):
        tracker.update(0.0, [seen_at(POINT)])
    assert given.update_raw(SECOND, [], motion()) == "VISTA_OK"
    assert carried_on.update_raw(SECOND, [], motion(known=False, drift_m=0.5)) == "VISTA_OK"
    (mean, covariance), (other_mean, other) = (state(t.tracks[1]) for t in (given, carried_on))
    assert other_mean.tolist() == mean.tolist()
    assert other - covariance == pytest.approx(np.diag([0.25] * 3 + [0.0] * 3))


def test_reset_forgets_tracks_and_time_but_not_ids() -> None:
    tracker = Tracker()
    feed(tracker, "xxx")
    lib.vista_tracker_reset(tracker.handle)
    assert not tracker.tracks
    assert feed(tracker, "xxx")[-1] == [2]


def test_extreme_numbers_leave_only_finite_tracks() -> None:
    random, tracker = seeded(4), Tracker(range_max_m=1e5)
    for frame in range(400):
        scale = 10.0 ** random.uniform(-9, 9)
        items = [
            detection(
                np.append(random.normal(0, 300 * scale, 2), 10.0 ** random.uniform(-6, 6)),
                extent=(10.0 ** random.uniform(-9, 9, 2)).tolist(),
                sigmas=(10.0 ** random.uniform(-9, 9, 3)).tolist(),
            )
            for _ in range(random.integers(0, 20))
        ]
        position = random.normal(0, scale, 3)
        assert tracker.update(0.1 * frame + random.uniform(0, 0.09), items, position) == "VISTA_OK"
        for track in tracker.tracks.values():
            mean, covariance = state(track)
            assert np.isfinite(mean).all()
            assert np.isfinite(covariance).all()
            assert np.isfinite([*track.extent_m, *track.extent_variance]).all()


def test_an_obstacle_being_passed_takes_no_detection_from_far_ones() -> None:
    """Close to the camera a pixel is millimetres: in pixels everything would lie in the gate or extent."""
    tracker, passed, ahead = Tracker(), np.array([0.4, 0.3, 20.0]), np.array([-0.5, 0.0, 60.0])
    for frame in range(40):
        position = np.array([0.0, 0.0, 0.5 * frame])
        items = (
            [seen_at(passed, position, label=1, extent=(2.0, 2.0))] if passed[2] - position[2] > 14.8 else []
        )
        if position[2] >= 18.5:  # the far one appears while the near one is beside the camera
            items.append(seen_at(ahead, position, label=2))
        tracker.update(DT * frame, items, position)
    assert tracker.tracks[1].coasting
    assert tracker.tracks[1].position_m[2] == pytest.approx(20.0, abs=0.1)
    assert tracker.tracks[2].label == 2


def test_what_leaves_the_view_sideways_is_not_in_the_blind_zone() -> None:
    tracker, point = Tracker(), np.array([6.0, 0.0, 30.0])
    alive = fly(tracker, point, range(58), 5.0, lambda _, z: 36 < z[0] < 634)
    left = next(frame for frame in alive if measure(point, (0, 0, 0.5 * frame))[0] >= 634)
    assert measure(point, (0, 0, 0.5 * left))[2] < 31
    kept = [frame for frame, ids in alive.items() if ids]
    assert kept in (list(range(left + 2)), list(range(left + 3)))  # 0.3 s


# ---- ids ----

POINTS = [np.array([x, 0.0, 40.0]) for x in (-6.0, 0.0, 6.0)]


def set_next_id(tracker: Tracker, value: int) -> None:
    ffi.cast("int32_t *", tracker.handle)[3] = value  # max_tracks, max_detections, count, next_id


def test_used_up_ids_start_again_and_pass_those_that_live() -> None:
    tracker, last = Tracker(), 2**31 - 1
    assert tracker.update(0.0, [seen_at(POINTS[0])]) == "VISTA_OK"
    assert list(tracker.tracks) == [1]
    set_next_id(tracker, last)
    assert tracker.update(0.1, [seen_at(point) for point in POINTS]) == "VISTA_OK"
    assert list(tracker.tracks) == [1, last, 2]  # oldest first; 1 lives
    for frame in range(2, 8):
        assert tracker.update(0.1 * frame, [seen_at(point) for point in POINTS]) == "VISTA_OK"
    assert list(tracker.tracks) == [1, last, 2] and tracker.confirmed == [1, last, 2]


def test_a_reset_with_used_up_ids_is_not_fatal() -> None:
    tracker = Tracker()
    set_next_id(tracker, 2**31 - 1)
    lib.vista_tracker_reset(tracker.handle)
    assert tracker.update(0.0, [seen_at(point) for point in POINTS]) == "VISTA_OK"
    assert list(tracker.tracks) == [2**31 - 1, 1, 2]
