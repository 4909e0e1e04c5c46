"""A camera for tests: shots that were made beforehand, handed over at the moments that the test says."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from threading import Event

from vista.live.loop import Totals
from vista.live.source import Shot
from vista.sequence import Frame, Sequence


class ListedShots:
    """totals: of the loop; each shot then waits until the one before is done with. Otherwise period_s lies
    between two."""

    def __init__(self, shots: Iterable[Shot], period_s: float = 0.0, error: Exception | None = None) -> None:
        self.skipped = 0
        self.totals: Totals | None = None
        self._shots, self._period_s, self._error = list(shots), period_s, error

    def shots(self, stopped: Event) -> Iterator[Shot]:
        for k, shot in enumerate(self._shots):
            if stopped.wait(self._period_s) or not self._wait(k, stopped):
                return
            yield replace(shot, exposed_ns=time.monotonic_ns())
        if self._error is not None:
            raise self._error

    def _wait(self, count: int, stopped: Event) -> bool:
        while self.totals is not None and self.totals.processed + self.totals.duplicates < count:
            if stopped.wait(0.001):
                return False
        return True


def frames_of(recorded: Sequence) -> list[Frame]:
    return [recorded.read(files) for files in recorded.frames]
