"""An autopilot on the loopback interface, played by pymavlink."""

from __future__ import annotations

import socket
import time
from collections import Counter
from dataclasses import dataclass, field
from threading import Event, Thread
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect


@dataclass
class Autopilot:
    """Listens on a port of its own, and answers to whom it has heard of."""

    port: int = 0
    times_s: dict[str, list[float]] = field(default_factory=dict)
    messages: list[tuple[float, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", self.port))
        self.socket.settimeout(0.05)
        self.port = self.socket.getsockname()[1]
        self.address: tuple[str, int] | None = None
        self.link = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
        self._stopped, self._decoder = Event(), dialect.MAVLink(None)
        self._thread = Thread(target=self._listen, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._stopped.set()
        self._thread.join()
        self.socket.close()

    def _listen(self) -> None:
        while not self._stopped.is_set():
            try:
                data, self.address = self.socket.recvfrom(4096)
            except TimeoutError:
                continue
            now_s = time.monotonic()
            for message in self._decoder.parse_buffer(data) or []:
                self.messages.append((now_s, message))
                self.times_s.setdefault(message.get_type(), []).append(now_s)

    @property
    def target(self) -> str:
        return f"udp:127.0.0.1:{self.port}"

    @property
    def counts(self) -> Counter[str]:
        return Counter({name: len(times) for name, times in self.times_s.items()})

    def of_kind(self, kind: str) -> list[tuple[float, Any]]:
        return [(t_s, message) for t_s, message in self.messages if message.get_type() == kind]

    def send(self, message: Any) -> None:
        if self.address is not None:
            self.socket.sendto(message.pack(self.link), self.address)
