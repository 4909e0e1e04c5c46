"""Sources of the frames of a live run: each is handed over when it is exposed, not before."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from threading import Event, Thread
from typing import Protocol

from vista import sequence
from vista.live.latest import Latest
from vista.sequence import Frame, FrameFiles

BETWEEN_PASSES_NS = 1_000_000_000
POLL_S = 0.1


@dataclass(frozen=True)
class Shot:
    """A frame that was taken."""

    frame: Frame  # raw; its time counts for the motion of things, and is the source's own
    exposed_ns: int  # the same moment on this machine's time.monotonic_ns()
    continues: bool = True  # False: what came before was another flight


class Source(Protocol):
    """A camera, or what stands for one."""

    @property
    def skipped(self) -> int:
        """Frames that the source itself left out, as because it came too late with them."""
        ...

    def shots(self, stopped: Event) -> Iterator[Shot]:
        """Blocks until the next frame is there. Ends when there are no more, or soon after `stopped`.
        Raises InputError for a frame that cannot be read."""
        ...


def newest_shots(source: Source, queue: Latest[Shot], interrupted: Callable[[], bool]) -> Iterator[Shot]:
    """Gives the newest of the shots that have come, each time that one is asked for; a thread takes them all.
    Ends when the source ends or `interrupted` says so. Raises what the source raises."""
    stopped = Event()

    def read() -> None:
        try:
            for shot in source.shots(stopped):
                queue.put(shot)
            queue.close()
        except BaseException as error:  # whatever it is, who waits must hear of it
            queue.close(error)

    reader = Thread(target=read, name="source", daemon=True)
    reader.start()
    try:
        while not interrupted() and not queue.ended:
            shot = queue.take(POLL_S)
            if shot is not None:
                yield shot
    finally:
        stopped.set()
        reader.join(5.0 * POLL_S)  # a camera that hangs is not waited for


class Replay:
    """A recording, as fast as it was taken: the frame of each moment, read beforehand."""

    def __init__(
        self,
        recorded: sequence.Sequence,
        frames: Sequence[FrameFiles],
        speed: float = 1.0,
        repeat: bool = False,
    ) -> None:
        """speed: of the clock of the recording; repeat: begin again after the last frame, until stopped."""
        self.skipped = 0
        self._recorded, self._frames = recorded, frames
        self._speed, self._repeat = speed, repeat
        self._pass_ns = frames[-1].t_ns - frames[0].t_ns + BETWEEN_PASSES_NS

    def shots(self, stopped: Event) -> Iterator[Shot]:
        self._recorded.read(self._frames[0])  # what a first reading takes is not counted as lateness
        start_ns, passes = time.monotonic_ns(), 0
        while not stopped.is_set():
            yield from self._pass(start_ns, passes, stopped)
            if not self._repeat:
                return
            passes += 1

    def _pass(self, start_ns: int, passes: int, stopped: Event) -> Iterator[Shot]:
        later_ns = passes * self._pass_ns
        passed_ns = (f.t_ns - self._frames[0].t_ns + later_ns for f in self._frames)
        due_ns = [start_ns + int(passed / self._speed) for passed in passed_ns]
        continues = passes == 0
        for k, files in enumerate(self._frames):
            continues = continues and not files.anew
            if k + 1 < len(due_ns) and time.monotonic_ns() >= due_ns[k + 1]:
                self.skipped += 1
                continue
            frame = self._recorded.read(files)
            if stopped.wait(max(1e-9 * (due_ns[k] - time.monotonic_ns()), 0.0)):
                return
            yield Shot(replace(frame, t_ns=frame.t_ns + later_ns), due_ns[k], continues)
            continues = True
