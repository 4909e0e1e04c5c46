"""The loop of a live run: of the frames that have come the newest is processed, and no queue grows."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from vista.chain import Chain, Step, finish, take
from vista.detector import Novelty
from vista.history import FrameRecord, StageClock
from vista.live.latency import Latencies
from vista.live.latest import Latest
from vista.live.source import Shot, Source, newest_shots
from vista.run import Announcer


@dataclass(frozen=True)
class Seen:
    """A frame that went through the chain."""

    step: Step
    record: FrameRecord  # with the health that the checks found
    exposed_ns: int  # on time.monotonic_ns()


class Listener(Protocol):
    """Takes each frame once it is done, in the thread of the loop: without delay."""

    def take(self, seen: Seen) -> None: ...


class Totals:
    """Counts of the run so far. Written by the loop alone."""

    def __init__(self, source: Source, queue: Latest[Shot]) -> None:
        self.processed = 0
        self.duplicates = 0  # both images as they were in the frame before: a camera that hangs
        self.restarts = 0  # another flight, or a clock that went back
        self.latency = Latencies()  # from the exposure until every listener has what was found
        self._source, self._queue = source, queue

    @property
    def dropped(self) -> int:
        """Frames that gave way to newer ones."""
        return self._queue.dropped + self._source.skipped


class LiveLoop:
    def __init__(self, chain: Chain, source: Source) -> None:
        self.chain, self._source = chain, source
        self._queue: Latest[Shot] = Latest()
        self.totals = Totals(source, self._queue)
        self._announcer = Announcer()

    def run(self, listeners: Sequence[Listener], interrupted: Callable[[], bool]) -> None:
        """Runs until the source ends or `interrupted` says so. Raises what the source raises."""
        for shot in newest_shots(self._source, self._queue, interrupted):
            novelty = take(self.chain, shot.frame, not shot.continues)
            self.totals.duplicates += novelty == Novelty.REPEATED
            self.totals.restarts += novelty == Novelty.RESTARTED
            if novelty != Novelty.REPEATED:
                self._process(shot, listeners)

    def _process(self, shot: Shot, listeners: Sequence[Listener]) -> None:
        step = finish(self.chain, shot.frame, StageClock())
        seen = Seen(step, step.record, shot.exposed_ns)
        for listener in listeners:
            listener.take(seen)
        self.totals.processed += 1
        self.totals.latency.add(1e-6 * (time.monotonic_ns() - shot.exposed_ns))
        self._announcer.announce(seen.record)
        sys.stderr.flush()
