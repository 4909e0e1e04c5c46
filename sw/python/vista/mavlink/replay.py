"""A recording of obstacles, sent to an autopilot as it was seen: each frame when its time has come."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from vista.mavlink.link import Link
from vista.mavlink.sighting import Sighting
from vista.mavlink.transport import Transport

POLL_NS = 10_000_000
TAIL_NS = 1_000_000_000  # after the last frame: time to tell that no more come
NAMES = {
    0: "HEARTBEAT",
    247: "COLLISION",
    253: "STATUSTEXT",
    330: "OBSTACLE_DISTANCE",
    11037: "OBSTACLE_DISTANCE_3D",
}


@dataclass
class Clock:
    """The clock of the machine, or of a test."""

    now_ns: Callable[[], int]
    sleep_ns: Callable[[int], None]


@dataclass
class Sent:
    """What went out: messages by name, and frames."""

    messages: Counter[str] = field(default_factory=Counter)
    frames: int = 0


def replay(
    sightings: Sequence[Sighting],
    link: Link,
    transport: Transport,
    clock: Clock,
    stopped: Callable[[], bool],
) -> Sent:
    """Ends a second after the last frame, or when `stopped` says so."""
    sent = Sent()
    start_ns = clock.now_ns()
    offset_ns = start_ns - sightings[0].t_ns
    for sighting in sightings:
        due_ns = sighting.t_ns + offset_ns
        _until(due_ns, link, transport, clock, stopped, sent)
        if stopped():
            return sent
        link.update(sighting, due_ns)
        sent.frames += 1
    _until(clock.now_ns() + TAIL_NS, link, transport, clock, stopped, sent)
    return sent


def _until(
    end_ns: int,
    link: Link,
    transport: Transport,
    clock: Clock,
    stopped: Callable[[], bool],
    sent: Sent,
) -> None:
    while not stopped():
        now_ns = clock.now_ns()
        for message in link.due(now_ns):
            transport.send(message)
            sent.messages[NAMES[int.from_bytes(message[7:10], "little")]] += 1
        if now_ns >= end_ns:
            return
        clock.sleep_ns(min(POLL_NS, end_ns - now_ns))
