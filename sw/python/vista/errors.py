"""The one exception that means "the user's input is at fault"."""

from __future__ import annotations

from pathlib import Path


class InputError(Exception):
    """Bad input in one line: the command line prints `vista: <culprit>: <reason>` and exits with status 2.

    culprit: what is wrong - a file, `file:line`, or an option.
    reason: what is wrong with it, without a full stop.
    """

    def __init__(self, culprit: str | Path, reason: str) -> None:
        self.culprit = str(culprit)
        self.reason = " ".join(reason.split())
        super().__init__(f"{self.culprit}: {self.reason}")
