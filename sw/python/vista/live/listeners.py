"""What listens to a live run: lines of JSON, and an autopilot."""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path
from threading import Condition, Thread

from vista.errors import InputError
from vista.live.latency import Latencies
from vista.live.loop import Seen
from vista.mavlink.link import Link
from vista.mavlink.replay import NAMES
from vista.mavlink.sighting import sighting_of
from vista.mavlink.transport import Transport
from vista.obstacle_line import obstacle_line
from vista.output import LineFile

POLL_S = 0.005


class Lines:
    """Each frame as a line of obstacles.jsonl. A disk that is full ends the file, not the flight."""

    def __init__(self, path: Path) -> None:
        """path: "-" is stdout. Raises InputError for a file that cannot be written."""
        self._file = None if str(path) == "-" else LineFile(path)
        self._over = False

    def take(self, seen: Seen) -> None:
        if self._over:
            return
        line = obstacle_line(seen.record)
        if self._file is None:
            print(line, flush=True)
        else:
            try:
                self._file.write_line(line)
            except InputError as error:
                self._over = True
                print(f"vista: {error}; the run goes on without it", file=sys.stderr)

    def close(self) -> None:
        if self._file is not None:
            self._file.close()


class Autopilot:
    """Sends in a thread of its own: an autopilot hears of us 10 times a second whatever the frames do."""

    def __init__(self, link: Link, transport: Transport) -> None:
        self.messages: Counter[str] = Counter()
        self.latency = Latencies()  # from the exposure until the first message that tells of the frame is out
        self.transport = transport
        self._link = link
        self._changed = Condition()
        self._untold_ns: int | None = None  # when the frame was exposed that no message has told of
        self._error: BaseException | None = None
        self._over = False
        self._thread = Thread(target=self._send, name="autopilot", daemon=True)
        self._thread.start()

    def take(self, seen: Seen) -> None:
        """Raises what ended the thread."""
        sighting = sighting_of(seen.record)
        with self._changed:
            if self._error is not None:
                raise self._error
            self._link.update(sighting, seen.exposed_ns)
            self._untold_ns = seen.exposed_ns
            self._changed.notify()

    def close(self) -> None:
        with self._changed:
            self._over = True
            self._changed.notify()
        self._thread.join()
        self.transport.close()

    def _send(self) -> None:
        try:
            while not self._over:
                with self._changed:
                    messages = list(self._link.due(time.monotonic_ns()))
                    untold_ns = self._untold_ns
                    if not messages:
                        self._changed.wait(POLL_S)
                for message in messages:  # a slow line holds up nobody but this thread
                    self._send_one(message, untold_ns)
        except BaseException as error:
            self._error = error

    def _send_one(self, message: bytes, untold_ns: int | None) -> None:
        self.transport.send(message)
        name = NAMES[int.from_bytes(message[7:10], "little")]
        self.messages[name] += 1
        if not name.startswith("OBSTACLE_DISTANCE") or untold_ns is None:
            return
        with self._changed:
            if self._untold_ns == untold_ns:
                self._untold_ns = None
                self.latency.add(1e-6 * (time.monotonic_ns() - untold_ns))
