"""A stop inside a frame, and what has to come of it."""

from __future__ import annotations

import numpy as np
from raw_frames import RawFrame, written
from registers import BUSY, CONTROL, ENABLE, ERRORS, FRAMES_IN, INTERRUPT, STATUS, STOPPED
from verilated import PACES, Rtl

NOTHING = np.zeros(0, np.uint32)


def stopped_inside(rtl: Rtl, frame: RawFrame, rng: np.random.Generator, seed: int) -> None:
    """The stop comes anywhere in the frame; another one, behind it, is dropped."""
    written(rtl, frame.writes())
    rtl.write(CONTROL, ENABLE)
    begun = rtl.read(FRAMES_IN)
    expected, stream = frame.words(), np.concatenate([frame.stream, frame.stream])
    rtl.queue_write(int(rng.integers(1, frame.left.size)), frame.left.size, CONTROL, 0)
    waiting = int(rng.integers(1, 3))
    paces = PACES[rng.integers(len(PACES))], PACES[rng.integers(len(PACES))]
    first = rtl.stream(stream, len(expected) - waiting, *paces, seed, quiet=6000)
    assert first.taken == len(stream), "the input hung"
    assert (rtl.read(STATUS), rtl.read(INTERRUPT) & STOPPED) == (BUSY, 0), "its last words wait"
    last = rtl.stream(NOTHING, waiting + 10, quiet=2000)
    assert (np.concatenate([first.words, last.words]) == expected).all()
    assert (rtl.read(STATUS), rtl.read(INTERRUPT) & STOPPED) == (0, STOPPED)
    assert (rtl.read(FRAMES_IN) - begun, rtl.read(ERRORS)) == (1, 0)
    rtl.write(INTERRUPT, STOPPED)
