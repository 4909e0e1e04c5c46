"""An obstacle that is not detected has gone only if the engine sees what lies behind it."""

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


def followed(hits: int = 6) -> Tracker:
    tracker = Tracker()
    for frame in range(hits):
        assert tracker.update(DT * frame, [seen_at(POINT)]) == "VISTA_OK"
    return tracker


def miss(tracker: Tracker, image: np.ndarray | None, first: int = 6) -> list[int]:
    """MISSES frames without a detection; the ids that are left."""
    for frame in range(first, first + MISSES):
        assert tracker.update(DT * frame, words=image) == "VISTA_OK"
    return list(tracker.tracks)


@pytest.mark.parametrize("value", [OWN, NEARER, INVALID])
def test_held_while_nothing_is_seen_behind_it(value: int) -> None:
    tracker = followed()
    assert miss(tracker, words(value)) == [1]
    track = tracker.tracks[1]
    assert track.held and track.coasting and track.confirmed and track.misses == 0


def test_gone_when_what_lies_behind_is_seen() -> None:
    assert miss(followed(), words(BEHIND)) == []
    assert miss(followed(), None) == []


def test_half_of_the_face_decides() -> None:
    """Left of a line what lies behind, right of it the track's own disparity."""
    u = round(measure(POINT)[0])
    for shift, left in ((-3, [1]), (3, [])):
        image = words(OWN)
        image[:, : u + shift] = BEHIND
        assert miss(followed(), image) == left


def test_held_no_longer_than_in_the_blind_zone() -> None:
    tracker = followed()
    blind_s = tracker.params.blind_zone_s
    assert tracker.update(DT * 5 + blind_s - 0.1, words=words(OWN)) == "VISTA_OK"
    assert list(tracker.tracks) == [1]
    assert tracker.update(DT * 5 + blind_s + 0.1, words=words(OWN)) == "VISTA_OK"
    assert list(tracker.tracks) == []


def test_a_detection_ends_it() -> None:
    tracker = followed()
    miss(tracker, words(OWN))
    assert tracker.update(DT * (6 + MISSES), [seen_at(POINT)], words=words(OWN)) == "VISTA_OK"
    assert not tracker.tracks[1].held and not tracker.tracks[1].coasting


def test_what_is_not_credible_is_not_held() -> None:
    assert miss(followed(hits=2), words(OWN), first=2) == []


def test_words_of_another_size_are_refused() -> None:
    tracker = followed()
    before = tracker.memory()
    assert tracker.update(1.0, words=np.zeros((480, 639), np.int16)) == "VISTA_ERROR_SIZE"
    assert tracker.memory() == before
