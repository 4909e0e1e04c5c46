"""How far many jobs are, by tqdm, and which of them fail."""

from __future__ import annotations

import sys

from tqdm import tqdm

BAR_EVERY_S = 0.5
LINE_EVERY_S = 60.0  # where there is no terminal, such as the log of a batch system
MOST_LINES = 20  # of failures; after that, only their number


class Progress(tqdm):
    """Counts jobs as they are done, and names those that fail at once."""

    def __init__(self, title: str, unit: str, total: int, kept: int) -> None:
        every_s = BAR_EVERY_S if sys.stderr.isatty() else LINE_EVERY_S
        super().__init__(
            desc=title,
            total=total,
            initial=kept,
            unit=unit,
            file=sys.stderr,
            mininterval=every_s,
            delay=every_s,
        )
        self.failed = 0

    def count(self, problem: str | None) -> None:
        """One more job is done; problem: what is wrong with it, in one line."""
        if problem is not None:
            self.failed += 1
            self.set_postfix_str(f"{self.failed} failed", refresh=False)
            if self.failed <= MOST_LINES:
                tqdm.write(f"vista: {problem}", file=sys.stderr)
        self.update()
