"""Images that come one by one are paired by their times; what finds no partner is counted. Needs no ROS."""

from __future__ import annotations

from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from random_seed import seeded
from vista.errors import InputError
from vista.ros.pairs import HELD, LEFT, RIGHT, LivePairs, TopicImage
from vista.sequence.pairing import pair_by_time

MS = 1_000_000
PERIOD_NS = 50 * MS
START_NS = 1_700_000_000 * 10**9


def image(side: int, t_ns: int, number: int = 0) -> TopicImage:
    stamp = SimpleNamespace(sec=t_ns // 10**9, nanosec=t_ns % 10**9)
    message = SimpleNamespace(header=SimpleNamespace(stamp=stamp))
    return TopicImage(("/left", "/right")[side], message, number, 0)


def add(pairs: LivePairs, side: int, t_ns: int) -> tuple[int, int] | None:
    """Times of the pair that is completed."""
    found = pairs.add(side, image(side, START_NS + t_ns))
    return None if found is None else (found[LEFT].t_ns - START_NS, found[RIGHT].t_ns - START_NS)


@pytest.mark.parametrize("first", [LEFT, RIGHT])
def test_the_second_image_completes_the_pair_whichever_side_it_is_of(first: int) -> None:
    pairs = LivePairs(5.0)
    times_ns = {LEFT: 0, RIGHT: 3 * MS}
    assert add(pairs, first, times_ns[first]) is None
    assert add(pairs, 1 - first, times_ns[1 - first]) == (0, 3 * MS)
    assert pairs.skipped == 0


@pytest.mark.parametrize("tolerance_ms", [0.0, 2.5])
def test_the_tolerance_that_was_given_is_the_last_difference_that_is_taken(tolerance_ms: float) -> None:
    limit_ns = round(tolerance_ms * MS)
    for apart_ns, paired in (
        (limit_ns, True),
        (-limit_ns, True),
        (limit_ns + 1, False),
        (-limit_ns - 1, False),
    ):
        pairs = LivePairs(tolerance_ms)
        assert pairs.tolerance_ns == limit_ns
        add(pairs, LEFT, 0)
        assert (add(pairs, RIGHT, apart_ns) is not None) == paired


def test_the_tolerance_is_a_tenth_of_the_period_of_the_left_images_and_5_ms_at_most() -> None:
    pairs = LivePairs(None)
    assert pairs.tolerance_ns == 5 * MS  # nothing is known of the period
    for k in range(4):
        add(pairs, LEFT, 10 * MS * k)
        add(pairs, RIGHT, 10 * MS * k)
    assert pairs.tolerance_ns == MS
    assert add(pairs, LEFT, 40 * MS) is None
    assert add(pairs, RIGHT, 40 * MS + MS + 1) is None
    slow = LivePairs(None)
    for k in range(4):
        add(slow, LEFT, 200 * MS * k)
    assert slow.tolerance_ns == 5 * MS


def test_the_tolerance_follows_a_period_that_changes() -> None:
    pairs = LivePairs(None)
    for k in range(30):
        add(pairs, LEFT, 10 * MS * k)
    for k in range(30):
        add(pairs, LEFT, 300 * MS + 20 * MS * k)
    assert pairs.tolerance_ns == 2 * MS


def test_the_nearest_of_those_that_wait_is_the_partner_and_older_ones_are_skipped() -> None:
    pairs = LivePairs(8.0)
    for t_ns in (0, 10 * MS, 20 * MS):
        assert add(pairs, LEFT, t_ns) is None
    assert add(pairs, RIGHT, 13 * MS) == (10 * MS, 13 * MS)
    assert pairs.skipped == 1  # the first left one
    assert add(pairs, RIGHT, 20 * MS) == (20 * MS, 20 * MS)  # the third still waits
    assert pairs.skipped == 1


def test_what_waits_on_the_own_side_is_skipped_when_a_later_image_is_paired() -> None:
    pairs = LivePairs(5.0)
    assert add(pairs, RIGHT, 50 * MS) is None
    assert add(pairs, LEFT, 0) is None
    assert add(pairs, LEFT, 50 * MS) == (50 * MS, 50 * MS)
    assert pairs.skipped == 1


def test_a_silent_side_holds_no_more_than_so_many_images() -> None:
    pairs = LivePairs(5.0)
    for k in range(HELD + 3):
        add(pairs, RIGHT, PERIOD_NS * k)
    assert pairs.skipped == 3
    assert add(pairs, LEFT, 2 * PERIOD_NS) is None  # its partner was dropped
    assert add(pairs, LEFT, 3 * PERIOD_NS) == (3 * PERIOD_NS, 3 * PERIOD_NS)


def test_clearing_forgets_what_waits_and_the_period() -> None:
    pairs = LivePairs(None)
    for k in range(3):
        add(pairs, LEFT, 10 * MS * k)
    pairs.clear()
    assert pairs.skipped == 3
    assert pairs.tolerance_ns == 5 * MS
    assert add(pairs, RIGHT, 20 * MS) is None


def test_live_images_are_paired_as_those_of_a_recording_are() -> None:
    """They come with jitter, some are lost, and a side comes late."""
    random = seeded(1)
    for _ in range(20):
        times_ns = [
            np.unique(PERIOD_NS * np.flatnonzero(random.random(60) > 0.2) + random.integers(0, 4 * MS))
            for _ in (LEFT, RIGHT)
        ]
        times_ns = [one + random.integers(-MS, MS, len(one)) for one in times_ns]
        latest_ns = [one + random.integers(0, 5 * PERIOD_NS) for one in times_ns]
        arrivals = sorted(
            (arrived_ns, side, t_ns)
            for side in (LEFT, RIGHT)
            for arrived_ns, t_ns in zip(latest_ns[side].tolist(), times_ns[side].tolist(), strict=True)
        )
        pairs = LivePairs(6.0)
        live = [found for _, side, t_ns in arrivals if (found := add(pairs, side, t_ns)) is not None]
        recorded = pair_by_time(times_ns[LEFT].tolist(), times_ns[RIGHT].tolist(), 6.0, "")
        assert live == [(times_ns[LEFT][left], times_ns[RIGHT][right]) for left, right in recorded.indices]
        pairs.clear()
        assert pairs.skipped + 2 * len(live) == sum(map(len, times_ns))


# ---- one image ----


def test_an_image_knows_its_time_its_topic_and_its_pixels() -> None:
    pixels = np.arange(12, dtype=np.uint8).reshape(3, 4)
    taken = image(RIGHT, START_NS + 7)
    content = {"encoding": "mono8", "width": 4, "height": 3, "step": 4, "data": pixels.ravel()}
    vars(taken.message).update(content)
    assert (taken.t_ns, str(taken)) == (START_NS + 7, "/right")
    np.testing.assert_array_equal(taken.read_grey(), pixels)


@pytest.mark.parametrize(("extension", "within"), [(".png", 0), (".jpg", 4)])
def test_a_compressed_image_is_decoded(extension: str, within: int) -> None:
    v, u = np.indices((48, 64))
    pixels = (2 * u + v).astype(np.uint8)
    found = compressed(cv2.imencode(extension, pixels)[1].tobytes()).read_grey()
    assert np.abs(found.astype(int) - pixels).max() <= within


@pytest.mark.parametrize("content", [b"", b"no image", None])
def test_a_compressed_image_that_is_damaged_is_refused(content: bytes | None) -> None:
    """None: the end is missing."""
    whole = cv2.imencode(".jpg", np.zeros((48, 64), np.uint8))[1].tobytes()
    with pytest.raises(InputError, match=r"^/right: "):
        compressed(whole[:-10] if content is None else content).read_grey()


def compressed(content: bytes) -> TopicImage:
    taken = image(RIGHT, START_NS)
    vars(taken.message).update(format="mono8; jpeg compressed", data=np.frombuffer(content, np.uint8))
    return taken
