"""An obstacle that is not detected has gone where the engine sees something else."""

from __future__ import annotations

import numpy as np
import pytest
from track_library import Tracker, measure, seen_at
from vista.engine import INVALID

DT = 0.1
POINT = np.array([0.0, 0.0, 30.0])
OWN = round(16 * measure(POINT)[2])
BEHIND, NEARER = OWN // 2, OWN + 64
MISSES = 20  # more than miss_max


def words(value: int) -> np.ndarray:
    return np.full((480, 640), value, np.int16)


HOLD_S, HOLD_PX = 0.3, 0.6  # of tracker.h and track_life.c


def followed(hits: int = 6, **changes: object) -> Tracker:
    tracker = Tracker()
    for frame in range(hits):
        assert tracker.update(DT * frame, [seen_at(POINT) | changes]) == "VISTA_OK"
    return tracker


def miss(tracker: Tracker, image: np.ndarray | None, first: int = 6) -> list[int]:
    """MISSES frames without a detection; the ids that are left."""
    for frame in range(first, first + MISSES):
        assert tracker.update(DT * frame, words=image) == "VISTA_OK"
    return list(tracker.tracks)


@pytest.mark.parametrize("own", [OWN, OWN + 8])
def test_followed_while_its_own_disparity_is_seen(own: int) -> None:
    """It is in the way: until it is passed. The words correct its range."""
    tracker = followed()
    assert miss(tracker, words(own)) == [1]
    track = tracker.tracks[1]
    assert track.followed and not track.coasting and not track.held and track.confirmed
    assert track.label == -1 and track.misses == 0
    expected_m = 1000.0 * 0.4572 * 16.0 / own
    assert track.position_m[2] == pytest.approx(expected_m, abs=0.3)
    assert track.position_m[0] == pytest.approx(POINT[0], abs=0.05)


def test_what_is_not_in_the_way_is_followed_for_a_set_time() -> None:
    tracker, follow_s = followed(volume_pixels=0), 1.0
    for frame in range(6, 40):
        assert tracker.update(DT * frame, words=words(OWN)) == "VISTA_OK"
        since_s = DT * (frame - 5)
        if since_s < follow_s - 0.01:
            assert tracker.tracks[1].followed
        if since_s > follow_s + 0.01 and tracker.tracks:
            assert tracker.tracks[1].coasting
    assert not tracker.tracks


def test_without_words_it_is_held_for_a_short_time() -> None:
    tracker = followed()
    for frame in range(6, 6 + MISSES):
        assert tracker.update(DT * frame, words=words(INVALID)) == "VISTA_OK"
        if not tracker.tracks:
            break
        track, hidden_s = tracker.tracks[1], DT * (frame - 5)
        assert track.coasting and not track.followed
        if abs(hidden_s - HOLD_S) > 0.01:
            assert track.held == (hidden_s < HOLD_S)
    assert not tracker.tracks


@pytest.mark.parametrize(("speed_m_s", "waits"), [(9.144, True), (0.0, False), (2.0, False)])
def test_between_two_whole_disparities_it_is_waited_for(speed_m_s: float, waits: bool) -> None:
    """Seen twice at 65 m, not confirmed. On approach its disparity moves on: without words it is waited for
    up to HOLD_PX. What moves on too slowly, or not at all, is missed at once."""
    tracker, thing = Tracker(), np.array([0.0, 0.0, 65.0])
    for frame in range(14):
        camera = np.array([0.0, 0.0, speed_m_s * DT * frame])
        seen = [seen_at(thing, camera)] if frame < 2 else []
        assert tracker.update(DT * frame, seen, camera, words=words(INVALID)) == "VISTA_OK"
        if frame < 2 or not tracker.tracks:
            continue
        moved_px = measure(thing, camera)[2] - measure(thing, np.array([0.0, 0.0, speed_m_s * DT]))[2]
        if abs(moved_px - HOLD_PX) > 0.05:
            assert tracker.tracks[1].held == (waits and moved_px < HOLD_PX)
        if waits and moved_px < 0.9 * HOLD_PX:
            assert tracker.tracks[1].misses == 0
    assert not tracker.tracks


def test_what_its_outline_told_is_held_without_words() -> None:
    """It never had any: until the time of the blind zone is over."""
    tracker = followed(plain=True)
    assert miss(tracker, words(INVALID)) == [1]
    assert tracker.tracks[1].held
    blind_s = 30.0
    assert tracker.update(DT * 5 + blind_s - 0.1, words=words(INVALID)) == "VISTA_OK"
    assert list(tracker.tracks) == [1]
    assert tracker.update(DT * 5 + blind_s + 0.1, words=words(INVALID)) == "VISTA_OK"
    assert list(tracker.tracks) == []


@pytest.mark.parametrize("value", [BEHIND, NEARER])
def test_gone_when_something_else_is_seen(value: int) -> None:
    assert miss(followed(), words(value)) == []
    assert miss(followed(plain=True), words(value)) == []


def test_gone_without_words_at_all() -> None:
    assert miss(followed(), None) == []


def test_half_of_the_face_decides() -> None:
    """Left of a line what lies behind, right of it the track's own disparity."""
    u = round(measure(POINT)[0])
    for shift, left in ((-3, [1]), (3, [])):
        image = words(OWN)
        image[:, : u + shift] = BEHIND
        assert miss(followed(), image) == left


def test_a_detection_ends_it() -> None:
    tracker = followed()
    miss(tracker, words(OWN))
    assert tracker.update(DT * (6 + MISSES), [seen_at(POINT)], words=words(OWN)) == "VISTA_OK"
    track = tracker.tracks[1]
    assert not (track.held or track.followed or track.coasting) and track.label == 0


def test_what_is_not_credible_is_not_followed() -> None:
    assert miss(followed(hits=2), words(OWN), first=2) == []
