"""Flies a recording in vista-fly again and again, for hours of flight, as fast as the machine can.

Each pass must give what the first one gave, to the byte but for the times and the numbers of obstacles, which
are counted on; the times must go on from pass to pass by the same step; and the program's memory, open files
and threads must be at the end what they were after the first tenth. Messages go to a socket that is read.
Prints what happened; exit status 1 if something did not hold.
"""

from __future__ import annotations

import argparse
import re
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Thread

FLY = Path(__file__).resolve().parents[1] / "build/bin/vista-fly"
NUMBER = re.compile(rb'"id": (\d+)')
TIMES = re.compile(rb'"t_ns": (\d+), "processing_ms": [\d.]+')
GROWTH_KB = 512
BETWEEN_PASSES_S = 1.0


@dataclass(frozen=True)
class Held:
    """What a process holds."""

    memory_kb: int
    files: int
    threads: int

    def grew_to(self, later: Held) -> bool:
        return later.memory_kb > self.memory_kb + GROWTH_KB or (later.files, later.threads) != (
            self.files,
            self.threads,
        )


def held_by(pid: int) -> Held:
    status = Path(f"/proc/{pid}/status").read_text()
    numbers = {name: int(number) for name, number in re.findall(r"^(\w+):\s+(\d+)", status, re.MULTILINE)}
    files = len(list(Path(f"/proc/{pid}/fd").iterdir()))
    return Held(memory_kb=numbers["VmRSS"], files=files, threads=numbers["Threads"])


def without_times(line: bytes) -> tuple[int, bytes]:
    found = TIMES.search(line)
    assert found is not None, line
    return int(found[1]), line[: found.start()] + line[found.end() :]


def counted_anew(lines: list[bytes]) -> list[bytes]:
    """The lines with their obstacles numbered in the order in which they come, from 0."""
    numbers: dict[bytes, int] = {}

    def anew(found: re.Match[bytes]) -> bytes:
        return b'"id": %d' % numbers.setdefault(found[1], len(numbers))

    return [NUMBER.sub(anew, line) for line in lines]


def passes_of(lines: Iterator[bytes], frames: int) -> Iterator[tuple[list[int], list[bytes]]]:
    times, rest = [], []
    for line in lines:
        t_ns, what = without_times(line)
        times.append(t_ns)
        rest.append(what)
        if len(rest) == frames:
            yield times, counted_anew(rest)
            times, rest = [], []
    if rest:
        yield times, counted_anew(rest)


def one_pass(recording: Path) -> tuple[list[int], list[bytes]]:
    command = [str(FLY), "--recording", str(recording), "--all-frames", "--out", "-"]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    pairs = [without_times(line) for line in done.stdout.splitlines(keepends=True)]
    return [t_ns for t_ns, _ in pairs], counted_anew([what for _, what in pairs])


def listen(here: socket.socket, counted: list[int]) -> None:
    while here.recv(4096):
        counted[0] += 1


def watch(fly: subprocess.Popen[bytes], recording: Path, passes: int) -> list[str]:
    """What did not hold while the program flew these passes."""
    first_times, first = one_pass(recording)
    step_ns = first_times[-1] - first_times[0] + int(1e9 * BETWEEN_PASSES_S)
    wrong, settled, now, done = [], None, None, 0
    assert fly.stdout is not None
    for times, rest in passes_of(iter(fly.stdout), len(first)):
        if rest != first:
            wrong.append(f"pass {done}: its lines are not those of the first")
        if times != [t_ns + done * step_ns for t_ns in first_times]:
            wrong.append(f"pass {done}: its times do not go on")
        done += 1
        if done < passes:  # while it is still there
            now = held_by(fly.pid)
        if done == max(1, passes // 10):
            settled = now
    if fly.wait() != 0 or done != passes:
        wrong.append(f"it ended with status {fly.returncode} after {done} of {passes} passes")
    print(f"{done} passes of {len(first)} frames; after a tenth {settled}, at the end {now}")
    if settled is None or now is None or settled.grew_to(now):
        wrong.append("it holds more than after a tenth")
    return wrong


def soak(recording: Path, hours: float, threads: int) -> list[str]:
    times, _ = one_pass(recording)
    flight_ns = times[-1] - times[0]
    passes = -int(-3.6e12 * hours // flight_ns)
    counted = [0]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as here, tempfile.TemporaryFile() as said:
        here.bind(("127.0.0.1", 0))
        Thread(target=listen, args=(here, counted), daemon=True).start()
        command = [
            str(FLY),
            "--recording",
            str(recording),
            "--all-frames",
            "--out",
            "-",
            "--passes",
            str(passes),
        ]
        command += ["--threads", str(threads), "--to", f"udp:127.0.0.1:{here.getsockname()[1]}"]
        start_s = time.monotonic()
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=said) as fly:
            wrong = watch(fly, recording, passes)
        print(
            f"{passes * flight_ns / 3.6e12:.2f} h of flight in {time.monotonic() - start_s:.0f} s, ", end=""
        )
        print(f"{counted[0]} messages read")
        said.seek(0)
        sys.stdout.write(said.read().decode())
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument(
        "recording", type=Path, metavar="FRAMES.vista", help="of `vista prepare`, with its frames"
    )
    parser.add_argument("--hours", type=float, default=10.0, help="of flight (default 10)")
    parser.add_argument("--threads", type=int, default=1, help="of the host (default 1)")
    args = parser.parse_args()
    wrong = soak(args.recording, args.hours, args.threads)
    for line in wrong[:10]:
        print(f"FAILED: {line}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
