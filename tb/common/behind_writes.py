"""Frames that come right behind writes to the registers, and what has to come of them."""

from __future__ import annotations

import numpy as np
from frames import random_pair
from raw_frames import random_one, written
from registers import CONTROL, ENABLE, ERRORS, FRAMES_IN, SOFT_RESET
from verilated import PACES, Pace, Rtl

LAST = ["commit", "enable", "soft reset"]  # the write that the frame is right behind


def right_behind(rtl: Rtl, rng: np.random.Generator, last: str, seed: int) -> None:
    """A frame is being taken, whole if the last write is the commit; the writes come, and the next frame."""
    before, frame = random_one(rng, rtl.config), random_one(rng, rtl.config)
    rtl.write(CONTROL, ENABLE)
    written(rtl, before.writes())
    rtl.write(CONTROL, ENABLE if last != "enable" else 0)
    at = int(rng.integers(before.left.size + 1))
    goes_on = last == "soft reset" and at > 0 and bool(rng.integers(2))  # the video, behind the reset
    sent = before.stream if last == "commit" or goes_on else before.stream[:at]
    writes = frame.writes()
    if last == "soft reset" and not goes_on and rng.integers(2):
        writes.append((CONTROL, ENABLE | SOFT_RESET))
    elif last == "soft reset":
        writes.insert(0, (CONTROL, ENABLE | SOFT_RESET))
    elif last == "enable":
        writes.append((CONTROL, ENABLE))
    for address, data in writes:
        rtl.queue_write(at if goes_on else len(sent), len(sent), address, data)
    begun = rtl.read(FRAMES_IN)
    stream = np.concatenate([sent, frame.stream])
    expected, flags = frame.words(), frame.flags()
    most = len(before.words()) + len(expected) + 10
    paces = Pace(), PACES[rng.integers(len(PACES))]
    got = rtl.stream(stream, most, *paces, seed, quiet=6000)
    assert got.taken == len(stream), "the input hung"
    assert len(got.words) >= len(expected), "the frame is lost"
    assert (got.words[-len(expected) :] == expected).all()
    assert (got.flags[-len(expected) :] == flags).all()
    if last == "commit":
        assert (got.words[: -len(expected)] == before.words()).all()
    assert rtl.read(FRAMES_IN) - begun == {"commit": 2, "enable": 1, "soft reset": 1 + (len(sent) > 0)}[last]
    assert rtl.read(ERRORS) == 0


def behind_the_first_pixel(rtl: Rtl, rng: np.random.Generator, seed: int) -> None:
    """Two frames have one set. That of each further frame, and its map, are committed once the first pixel of
    the frame before it is offered, which may wait at the input since the reader stalls."""
    front_end = bool(rtl.config.rows)
    frames = [random_one(rng, rtl.config) for _ in range(3 if front_end else 6)]
    before, frame = frames[:2]
    frame.parameters = before.parameters
    frame.narrow, frame.confidence = before.narrow, before.confidence
    if front_end:
        frame.smooth, frame.levels, frame.grids = before.smooth, before.levels, before.grids
    height, width = before.shape
    frame.left, frame.right = random_pair(rng, "noise", height, width)
    rtl.write(CONTROL, ENABLE)
    written(rtl, before.writes())
    ends = np.cumsum([frame.left.size for frame in frames]).tolist()
    for number, after in enumerate(frames[2:]):
        *sets, commit = after.writes()
        first, end = ends[number : number + 2]  # of the frame in which it is committed
        if front_end:
            written(rtl, sets)
        else:  # while one of its last pixels is held back, so that the reader's stall has reached the input
            waiting = first - int(rng.choice([0, 1, 1, 2, 2, 2]))
            for address, data in [*sets, *sets]:
                rtl.queue_write(waiting, waiting, address, data)
        behind = first + int(rng.integers(3))  # beat that is offered, or was taken
        rtl.queue_write(behind, end, *commit)
    stream = np.concatenate([part.stream for part in frames])
    expected = np.concatenate([part.words() for part in frames])
    paces = [Pace(1000, 16), *PACES] if front_end else [Pace(200, 40), Pace(200, 40), Pace(20, 5), Pace()]
    pace_out = paces[rng.integers(len(paces))]
    got = rtl.stream(stream, len(expected) + 10, Pace(), pace_out, seed, quiet=6000)
    assert got.taken == len(stream), "the input hung"
    assert len(got.words) == len(expected)
    assert (got.words == expected).all()
    assert (got.flags == np.concatenate([part.flags() for part in frames])).all()
    assert rtl.read(ERRORS) == 0
