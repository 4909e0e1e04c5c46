"""Exit statuses, and the one exception that means "the user's input is at fault"."""

from __future__ import annotations

from pathlib import Path

EXIT_OK = 0
EXIT_INPUT = 2
EXIT_JOBS = 3
EXIT_INTERRUPTED = 130  # 128 + SIGINT


class InputError(Exception):
    """Bad input in one line: the command line prints `vista: <culprit>: <reason>` and exits with status 2.

    culprit: what is wrong - a file, `file:line`, or an option.
    reason: what is wrong with it, without a full stop.
    """

    def __init__(self, culprit: str | Path, reason: str) -> None:
        self.culprit = str(culprit)
        self.reason = " ".join(reason.split())
        super().__init__(f"{self.culprit}: {self.reason}")

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str]]:
        """Exceptions are rebuilt from their arguments when they come back from another process."""
        return InputError, (self.culprit, self.reason)


class JobsError(Exception):
    """Some of many jobs failed, and a line on stderr has named each; the others are done.

    status: the exit status, that of bad input if nothing else was wrong."""

    def __init__(self, title: str, failed: int, total: int, status: int) -> None:
        self.failed = failed
        self.status = status
        super().__init__(f"{title}: {failed} of {total} failed")
