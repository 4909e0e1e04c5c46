"""Ctrl-C and SIGTERM: one line and status 130, at whatever moment they come. Loads nothing but `signal`."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def stopping_at_once() -> Iterator[None]:
    """Ends the process at Ctrl-C while modules load, where an exception could be taken for a module that
    fails."""
    before = signal.signal(signal.SIGINT, _stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _stop(_number: int, _frame: Any) -> None:
    from vista.errors import EXIT_INTERRUPTED

    sys.stderr.write("vista: interrupted\n")
    sys.stderr.flush()
    os._exit(EXIT_INTERRUPTED)


class Interruption:
    """Set by the first Ctrl-C or SIGTERM; a second one ends the program at once."""

    def __init__(self) -> None:
        self.requested = False

    @contextmanager
    def watch(self) -> Iterator[None]:
        before = {number: signal.signal(number, self._request) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _request(self, number: int, _frame: Any) -> None:
        self.requested = True
        signal.signal(number, signal.SIG_DFL)
