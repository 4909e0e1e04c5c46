"""A queue of one: what was not taken in time gives way to what is newer."""

from __future__ import annotations

from threading import Condition
from typing import Generic, TypeVar

Item = TypeVar("Item")


class Latest(Generic[Item]):
    """Holds the newest item, between a thread that puts and one that takes."""

    def __init__(self) -> None:
        self.dropped = 0  # items that were never taken
        self._changed = Condition()
        self._item: Item | None = None
        self._error: BaseException | None = None
        self._closed = False

    def put(self, item: Item) -> None:
        with self._changed:
            self.dropped += self._item is not None
            self._item = item
            self._changed.notify_all()

    def close(self, error: BaseException | None = None) -> None:
        """No more items come; error: why, to be raised by `take` once the last item was taken."""
        with self._changed:
            self._closed, self._error = True, error
            self._changed.notify_all()

    @property
    def ended(self) -> bool:
        """Closed, and nothing is left to take. Raises what it was closed with."""
        with self._changed:
            if self._closed and self._item is None and self._error is not None:
                raise self._error
            return self._closed and self._item is None

    def take(self, timeout_s: float) -> Item | None:
        """Waits for an item. None: nothing came in time, or nothing comes any more."""
        with self._changed:
            self._changed.wait_for(lambda: self._item is not None or self._closed, timeout_s)
            item, self._item = self._item, None
            return item
