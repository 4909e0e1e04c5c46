"""How far many jobs are: a bar on a terminal, else a line now and then."""

from __future__ import annotations

import sys
from collections.abc import Callable
from threading import Event, Thread
from time import monotonic
from types import TracebackType

from tqdm import tqdm

LINE_EVERY_S = 60.0  # where there is no terminal, such as the log of a batch system
BAR_EVERY_S = 2.0
MOST_LINES = 20  # of failures; after that, only their number


class Progress:
    """Counts jobs as they are done, and names those that fail at once. `note` is asked for what else is worth
    knowing; it may take a moment."""

    def __init__(self, title: str, unit: str, total: int, kept: int) -> None:
        self.note: Callable[[], str] = str
        self._bar = tqdm(desc=title, total=total, initial=kept, unit=unit, file=sys.stderr, disable=None)
        self._title, self._total, self._kept, self._done = title, total, kept, kept
        self._failed = 0
        self._started_s = monotonic()
        self._over = Event()
        self._thread = Thread(target=self._show, daemon=True)

    def __enter__(self) -> Progress:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._thread.join()
        self._bar.close()

    def count(self, problem: str | None) -> None:
        """One more job is done; problem: what is wrong with it, in one line."""
        self._done += 1
        if problem is not None:
            self._failed += 1
            if self._failed <= MOST_LINES:
                tqdm.write(f"vista: {problem}", file=sys.stderr)
        self._bar.update()

    def line(self) -> str:
        spent_s = monotonic() - self._started_s
        left_s = spent_s / max(1, self._done - self._kept) * (self._total - self._done)
        return ", ".join(
            [
                f"{self._title}: {self._done} of {self._total} done",
                *self._notes(),
                f"{tqdm.format_interval(spent_s)} so far",
                f"about {tqdm.format_interval(left_s)} left" if self._done > self._kept else "none made yet",
            ]
        )

    def _notes(self) -> list[str]:
        return [f"{self._failed} failed"] * (self._failed > 0) + [self.note()] * (self.note is not str)

    def _show(self) -> None:
        """Also while no job ends."""
        while not self._over.wait(LINE_EVERY_S if self._bar.disable else BAR_EVERY_S):
            if self._bar.disable:
                print(self.line(), file=sys.stderr, flush=True)
            else:
                self._bar.set_postfix_str(", ".join(self._notes()))
