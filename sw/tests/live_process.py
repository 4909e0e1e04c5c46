"""`vista live` in a process of its own, and what its page says."""

from __future__ import annotations

import http.client
import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

READY_S = 60.0


class Live:
    """A run in a process of its own, and its page."""

    def __init__(self, *arguments: object) -> None:
        command = [sys.executable, "-m", "vista", "live", "--page", "0", *map(str, arguments)]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        self.url = self.process.stderr.readline().split()[-1]
        self.port = int(self.url.rstrip("/").rpartition(":")[2])

    def get(self, path: str, host: str | None = None) -> tuple[int, str, bytes]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=READY_S)
        connection.request("GET", path, headers={"Host": host or f"127.0.0.1:{self.port}"})
        answer = connection.getresponse()
        result = answer.status, answer.getheader("Content-Type", ""), answer.read()
        connection.close()
        return result

    def stop(self) -> tuple[int, str]:
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(READY_S), self.process.stderr.read() if self.process.stderr else ""


@contextmanager
def running(*arguments: object) -> Iterator[Live]:
    live = Live(*arguments)
    try:
        until(lambda: json.loads(live.get("/state")[2])["frame"] is not None)
        yield live
    finally:
        live.process.kill()
        live.process.wait()


def until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + READY_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)
