"""Courses of sampled flights: what they lead to can be told from how they have been flown."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from vista_eval.metrics.rules import STRICT
from vista_eval.render.course import Course
from vista_eval.worlds.sampled.catalog import FAMILIES

pytestmark = pytest.mark.slow

LATEST_S = 0.6  # of the flight, from which a detector may take the direction of flight
MISSED_M = 2.0  # radius of the collision volume
FLIGHTS = 10  # of each family


def misses_m(course: Course) -> list[float]:
    """The misses of each frame in which a hit is asked for: how far the latest velocity, extended to x = 0
    along the manoeuvre in still air, misses the point that the flight meets."""
    near_m, far_m = STRICT.band_m(course.speed_m_s)
    found = []
    for frame in range(course.frames):
        left_s = -course.before_meeting_s(frame)
        if near_m <= left_s * course.speed_m_s <= far_m:
            now, before = (blown_m(course, k) for k in (frame, frame - LATEST_S * course.rate_hz))
            missed_m = now + (now - before) / LATEST_S * left_s
            found.append(float(np.hypot(*missed_m[1:])))
    return found


def blown_m(course: Course, frame: float) -> np.ndarray:
    """Off the path in still air."""
    place_m: np.ndarray = course.state_at(frame).world_from_body[:3, 3]
    return place_m - course.path_m(course.before_meeting_s(frame))


def test_gusts_leave_what_is_met_predictable() -> None:
    random = seeded(1)
    courses = [
        family.courses.draw(int(seed))
        for family in FAMILIES.values()
        for seed in random.integers(1 << 31, size=FLIGHTS)
    ]
    gusty = [course for course in courses if course.gusts.sigma_m_s > 0.0]
    assert len(gusty) > 0.2 * len(courses)
    missed = np.concatenate([misses_m(course) for course in gusty]) > MISSED_M
    assert missed.mean() < 0.02, f"{missed.sum()} of {len(missed)} frames"
