"""Pairs left and right images by their times.

A left and a right image belong together when each is the nearest in time to the other, within a tolerance;
images without a partner are left out. Notes say how many.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vista.errors import InputError

PERIOD_SHARE = 0.1  # of the frame period: how far the times of a pair may lie apart, if not stated otherwise,
MAX_TOLERANCE_NS = 5_000_000  # and at most


@dataclass(frozen=True)
class Pairs:
    indices: tuple[tuple[int, int], ...]  # of the left and the right image
    notes: tuple[str, ...]


def pair_by_time(
    left_ns: Sequence[int], right_ns: Sequence[int], tolerance_ms: float | None, culprit: str | Path
) -> Pairs:
    """Both lists increase. tolerance_ms: None is a tenth of the frame period, at most 5 ms; culprit: where
    the right images are listed, for the error when nothing fits."""
    tolerance_ns = default_tolerance_ns(left_ns) if tolerance_ms is None else round(1e6 * tolerance_ms)
    found = []
    for index, t_ns in enumerate(left_ns):
        partner = _nearest(right_ns, t_ns)
        near = abs(right_ns[partner] - t_ns) <= tolerance_ns
        if near and left_ns[_nearest(left_ns, right_ns[partner])] == t_ns:
            found.append((index, partner))
    if not found:
        raise InputError(culprit, f"no right image within {tolerance_ns / 1e6:g} ms of any left one")
    apart_ns = [abs(right_ns[right] - left_ns[left]) for left, right in found]
    alone = len(left_ns) + len(right_ns) - 2 * len(found)
    notes = _notes(apart_ns, alone, len(left_ns) + len(right_ns), tolerance_ns)
    return Pairs(tuple(found), (*notes, *notes_on_drops(left_ns)))


def default_tolerance_ns(times_ns: Sequence[int]) -> int:
    if len(times_ns) < 2:
        return MAX_TOLERANCE_NS
    return min(round(PERIOD_SHARE * float(np.median(np.diff(times_ns)))), MAX_TOLERANCE_NS)


def _nearest(times_ns: Sequence[int], t_ns: int) -> int:
    """Its index."""
    after = bisect_left(times_ns, t_ns)
    around = range(max(after - 1, 0), min(after + 1, len(times_ns)))
    return min(around, key=lambda index: abs(times_ns[index] - t_ns))


def _notes(apart_ns: list[int], alone: int, images: int, tolerance_ns: int) -> tuple[str, ...]:
    notes = []
    differing = sum(ns > 0 for ns in apart_ns)
    if differing:
        furthest = f"they differ by up to {max(apart_ns) / 1e6:g} ms"
        notes.append(f"{differing} of {len(apart_ns)} pairs have images of two times; {furthest}")
    if alone:
        within = f"within {tolerance_ns / 1e6:g} ms"
        notes.append(f"{alone} of {images} images have no partner {within} and are left out")
    return tuple(notes)


def notes_on_drops(times_ns: Sequence[int]) -> tuple[str, ...]:
    """Notes on pairs that were never recorded, by the times of the left camera."""
    gaps_ns = np.diff(times_ns)
    if len(gaps_ns) < 2:
        return ()
    period_ns = float(np.median(gaps_ns))
    dropped = int(np.sum(np.rint(gaps_ns / period_ns) - 1, where=gaps_ns > period_ns))
    of_all = f"{dropped} of {len(times_ns) + dropped}"
    return (f"the left images have gaps: {of_all} were dropped before the recording",) if dropped else ()
