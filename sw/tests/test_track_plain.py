"""A track told by its outline alone: what is seen of its edges later does not clear what is between them."""

from __future__ import annotations

import numpy as np
import pytest
from track_library import Tracker, seen_at

DT, POINT, EXTENT = 0.1, np.array([0.0, 0.0, 30.0]), (16.0, 9.0)
EDGE = np.array([5.0, 0.0, 30.0])  # out of the collision volume, within the extent and at its depth


def updated(tracker: Tracker, first: int, count: int, point: np.ndarray, **changes: object) -> object:
    for frame in range(first, first + count):
        extent = EXTENT if point is POINT else (1.0, 8.0)
        detection = seen_at(point, extent=extent) | changes
        assert tracker.update(DT * frame, [detection]) == "VISTA_OK"
    return tracker.tracks[1]


def test_edges_do_not_say_whether_a_plain_track_is_in_the_volume() -> None:
    tracker = Tracker()
    whole = updated(tracker, 0, 6, POINT, plain=True)
    assert whole.plain and not whole.edges_only and whole.volume_window == 0b111111
    edge = updated(tracker, 6, 4, EDGE)
    assert edge.hits == 10 and edge.plain and edge.edges_only and edge.volume_window == 0b111111
    again = updated(tracker, 10, 1, POINT, plain=True, volume_pixels=0)
    assert not again.edges_only and again.volume_window == 0b1111110


def test_the_range_is_as_uncertain_as_the_foot_that_told_it_last() -> None:
    """The error stays what it was in metres while the foot is out of view."""
    tracker = Tracker()
    disparity_px = seen_at(POINT)["disparity_px"]
    whole = updated(tracker, 0, 6, POINT, plain=True, lasting_sigma_px=0.3)
    told_m = POINT[2] * 0.3 / disparity_px
    assert whole.lasting_sigma_m == pytest.approx(told_m)
    assert updated(tracker, 6, 4, EDGE).lasting_sigma_m == pytest.approx(told_m)
    assert updated(tracker, 10, 1, POINT, plain=True, lasting_sigma_px=0.1).lasting_sigma_m < 0.5 * told_m


def test_where_a_plain_track_is_met_stays_there_without_detections() -> None:
    """Its range was told nearer and nearer, as if it moved; other things go on moving."""
    for plain in (True, False):
        tracker = Tracker()
        for frame in range(8):
            point = np.array([0.0, 0.0, 30.0 + 0.1 * frame])
            met = {"met": True, "met_camera_m": point.tolist(), "met_sigma_m": 0.3, "plain": plain}
            assert tracker.update(DT * frame, [seen_at(point, extent=EXTENT) | met]) == "VISTA_OK"
        before = tracker.tracks[1]
        met_m, moves_m_s = np.array(list(before.met_m)), before.velocity_m_s[2]
        assert moves_m_s > 0.1 and before.met_sigma_m == pytest.approx(0.3)
        assert tracker.update(DT * 8, []) == "VISTA_OK"
        moved_m = np.array(list(tracker.tracks[1].met_m)) - met_m
        assert moved_m == pytest.approx([0.0, 0.0, 0.0 if plain else DT * moves_m_s], abs=1e-6)


def test_a_line_is_met_where_it_is_and_not_where_a_region_around_it_was() -> None:
    """Such as the bar between two panes: an earlier region took in the panes, and told of their surface."""
    disparity_px = seen_at(POINT)["disparity_px"]
    limit_m = POINT[2] * disparity_px / (disparity_px + 1.5)
    for met_m, holds in ((limit_m + 0.3, True), (limit_m - 0.3, False)):
        tracker = Tracker()
        met = {"met": True, "met_camera_m": [0.5, 0.0, met_m], "met_sigma_m": 0.3}
        assert updated(tracker, 0, 6, POINT, **met).met
        assert updated(tracker, 6, 1, POINT).met  # a region without a cell that tells
        assert updated(tracker, 7, 1, POINT, line=True).met == holds
        again = updated(tracker, 8, 1, POINT, **met)
        assert again.met and list(again.met_m) == pytest.approx([0.5, 0.0, met_m], abs=0.01)


def test_other_tracks_are_judged_by_every_hit() -> None:
    tracker = Tracker()
    updated(tracker, 0, 6, POINT)
    track = updated(tracker, 6, 4, EDGE)
    assert track.hits == 10 and not track.plain and not track.edges_only
    assert track.volume_window == 0b1111110000
