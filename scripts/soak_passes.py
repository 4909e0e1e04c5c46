"""Flies a recording in vista-fly again and again, as fast as the machine can: hours of flight.

Each pass must give what the first one gave, to the byte but for the times and the numbers of obstacles, which
are counted on. The times must go on from pass to pass by the same step. After the last pass the program must
hold as much memory, and as many open files and threads, as after a tenth of the passes. Messages go to a
socket that is read. Prints what happened; exit status 1 if something did not hold.
"""

from __future__ import annotations

import argparse
import re
import socket
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from threading import Thread
from typing import NamedTuple

from soak_live import FLY_GROWTH_MB, resident_mb

FLY = Path(__file__).resolve().parents[1] / "build/bin/vista-fly"
NUMBER = re.compile(rb'"id": (\d+)')
FRAME = re.compile(rb'"frame": (\d+), "t_ns": (\d+), "processing_ms": [\d.]+')


class Pass(NamedTuple):
    """The lines of one pass without their times, its obstacles numbered from 0, and the times."""

    lines: list[bytes]
    times_ns: list[int]


class Held(NamedTuple):
    """What a process holds."""

    memory_mb: float
    files: int
    threads: int


def held_by(pid: int) -> Held | None:
    """None: it has ended."""
    memory_mb = resident_mb(pid)
    if memory_mb == 0.0:
        return None
    files, threads = (len(list(Path(f"/proc/{pid}/{what}").iterdir())) for what in ("fd", "task"))
    return Held(memory_mb, files, threads)


def pass_of(shown: list[tuple[int, bytes]]) -> Pass:
    numbers: dict[bytes, bytes] = {}

    def anew(found: re.Match[bytes]) -> bytes:
        return numbers.setdefault(found[1], b'"id": %d' % len(numbers))

    return Pass([NUMBER.sub(anew, line) for _, line in shown], [t_ns for t_ns, _ in shown])


def passes_of(lines: Iterable[bytes]) -> Iterator[Pass]:
    """A pass ends where the numbers of the frames begin anew."""
    shown: list[tuple[int, bytes]] = []
    last = -1
    for line in lines:
        found = FRAME.search(line)
        if found is None:
            raise ValueError(f"no line of a frame: {line!r}")
        frame = int(found[1])
        if frame <= last:
            yield pass_of(shown)
            shown = []
        shown.append((int(found[2]), FRAME.sub(b'"frame": %d' % frame, line)))
        last = frame
    if shown:
        yield pass_of(shown)


def faults_of(flown: Iterable[tuple[Pass, Held | None]], passes: int) -> Iterator[str]:
    """What did not hold in so many passes. Each comes with what the program held then, if it was there."""
    first: Pass | None = None
    settled: Held | None = None
    held: Held | None = None
    step_ns = done = 0
    for done, (one, now) in enumerate(flown, 1):
        held = now or held
        if done == max(1, passes // 10):
            settled = held
        if first is None:
            first = one
        if done == 2:
            step_ns = one.times_ns[0] - first.times_ns[0]
        if one.lines != first.lines:
            yield f"pass {done}: its lines are not those of the first"
        if one.times_ns != [t_ns + (done - 1) * step_ns for t_ns in first.times_ns]:
            yield f"pass {done}: its times do not go on by the same step"
    print(f"{done} passes; held after a tenth: {settled}; at the end: {held}")
    if done != passes:
        yield f"it ended after {done} of {passes} passes"
    if settled is None or held is None:
        return
    if held.memory_mb - settled.memory_mb > FLY_GROWTH_MB or held[1:] != settled[1:]:
        yield "it holds more at the end than after a tenth of the passes"


def watched(fly: subprocess.Popen[bytes]) -> Iterator[tuple[Pass, Held | None]]:
    assert fly.stdout is not None
    for one in passes_of(fly.stdout):
        yield one, held_by(fly.pid)


def listen(here: socket.socket, counted: list[int]) -> None:
    while here.recv(4096):
        counted[0] += 1


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("recording", metavar="FRAMES.vista", help="recording that `vista prepare` wrote")
    parser.add_argument("--passes", type=int, default=1000, help="how often it is flown (default 1000)")
    parser.add_argument("--threads", type=int, default=1, help="threads of the host (default 1)")
    args = parser.parse_args()
    counted = [0]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as here:
        here.bind(("127.0.0.1", 0))
        Thread(target=listen, args=(here, counted), daemon=True).start()
        command = [str(FLY), "--recording", args.recording, "--all-frames", "--out", "-"]
        command += ["--passes", str(args.passes), "--threads", str(args.threads)]
        command += ["--to", f"udp:127.0.0.1:{here.getsockname()[1]}"]
        start_s = time.monotonic()
        with subprocess.Popen(command, stdout=subprocess.PIPE) as fly:
            faults = list(faults_of(watched(fly), args.passes))
    print(f"{time.monotonic() - start_s:.0f} s, {counted[0]} messages read")
    for fault in faults[:10]:
        print(f"FAILED: {fault}")
    return 1 if faults or fly.returncode != 0 else 0


if __name__ == "__main__":
    sys.exit(main())
