"""How far many jobs are, by tqdm, and which of them fail."""

from __future__ import annotations

import sys

from tqdm import tqdm

BAR_EVERY_S = 0.5
LINE_EVERY_S = 60.0  # where there is no terminal, such as the log of a batch system
LINE = "{l_bar}{r_bar}\n"
MOST_LINES = 20  # of failures; after that, only their number


class Progress(tqdm):
    """Counts jobs as they are done, and names those that fail at once."""

    def __init__(self, title: str, unit: str, total: int, kept: int) -> None:
        self.shown = sys.stderr.isatty()
        every_s, form = (BAR_EVERY_S, None) if self.shown else (LINE_EVERY_S, LINE)
        super().__init__(
            desc=title,
            total=total,
            initial=kept,
            unit=unit,
            file=sys.stderr,
            mininterval=every_s,
            delay=every_s,
            bar_format=form,
        )
        self.failed = 0

    def count(self, problem: str | None) -> None:
        """One more job is done; problem: what is wrong with it, in one line."""
        if problem is not None:
            self.failed += 1
            self.set_postfix_str(f"{self.failed} failed", refresh=False)
            if self.failed <= MOST_LINES:
                write = tqdm.write if self.shown else print  # the former takes the bar away meanwhile
                write(f"vista: {problem}", file=sys.stderr)
        self.update()
