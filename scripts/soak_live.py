"""Flies a recording as `vista live` or vista-fly does, for minutes, while camera and receiver fail.

A virtual camera shows the frames of the recording, to and fro, at the rate of a video, each with a little
noise of its own as of a sensor. It is unplugged for a while, delivers frames again and again, and its clock
leaps forward and back; the receiver of the messages disappears and comes back. What must hold: the process
goes on, its memory stays what it was, and no message tells of distances when the newest frame is older than
mavlink.stale_s. With --fly the camera hands its frames to vista-fly through shared memory, and that is killed
now and then, and started again. Prints what happened and the latencies; exit status 1 if something did not
hold.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from threading import Event, Thread

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as dialect
from vista import native, parameters
from vista.chain import make_chain
from vista.live.listeners import Autopilot
from vista.live.loop import LiveLoop, Seen
from vista.live.source import Shot
from vista.mavlink.link import Link
from vista.mavlink.transport import open_transport
from vista.recording import head_bytes
from vista.rectify import Rectifier
from vista.sequence import Frame, Sequence, open_sequence
from vista.shared_frames import SharedFrames

UNKNOWN = 65535
SLACK_NS = 150_000_000  # of a message that was on its way, and of a machine that does other things
NOISE_IMAGES = 8
FAULT_EVERY_S = 8.0
MOST_DUPLICATES = 30
SETTLED = 0.1  # of the run: the memory of the rest is compared with that at this time
GROWTH_MB = 8.0
FLY_GROWTH_MB = 0.5
SETTLING_S = 10.0


class FailingCamera:
    """What stands for the camera, and keeps when it exposed its last frame."""

    def __init__(self, frames: list[Frame], rate_hz: float, duration_s: float, seed: int) -> None:
        self.skipped, self.exposed_ns, self.faults = 0, 0, Counter[str]()
        self._frames, self._period_ns = frames, int(1e9 / rate_hz)
        self._end_s = time.monotonic() + duration_s
        self._random = np.random.default_rng(seed)
        shape = (NOISE_IMAGES, *frames[0].left.shape)
        self._noise = self._random.integers(0, 2, shape, dtype=np.uint8)

    def shots(self, stopped: Event) -> Iterator[Shot]:
        there_and_back = self._frames + self._frames[-2:0:-1]
        step_ns = self._frames[1].t_ns - self._frames[0].t_ns
        t_ns, due_ns, fault_ns, count = 0, time.monotonic_ns(), 0, 0
        shot = None
        while time.monotonic() < self._end_s and not stopped.is_set():
            due_ns, t_ns = due_ns + self._period_ns, t_ns + step_ns
            fault = None
            if time.monotonic_ns() > fault_ns:
                fault_ns = time.monotonic_ns() + int(1e9 * self._random.exponential(FAULT_EVERY_S))
                fault = str(self._random.choice(["unplugged", "duplicates", "clock forward", "clock back"]))
                self.faults[fault] += 1
            if fault == "unplugged":
                stopped.wait(self._random.uniform(0.2, 5.0))
                due_ns = time.monotonic_ns()
            if fault == "clock forward":
                t_ns += int(1e9 * self._random.uniform(0.5, 3600.0))
            if fault == "clock back":
                t_ns = max(0, t_ns - int(1e9 * self._random.uniform(0.5, 3600.0)))
            stopped.wait(max(0.0, 1e-9 * (due_ns - time.monotonic_ns())))
            if fault == "duplicates" and shot is not None:
                for _ in range(self._random.integers(1, MOST_DUPLICATES)):
                    due_ns += self._period_ns
                    stopped.wait(max(0.0, 1e-9 * (due_ns - time.monotonic_ns())))
                    yield replace(
                        shot, frame=replace(shot.frame, t_ns=shot.frame.t_ns + 1), exposed_ns=due_ns
                    )
                continue
            frame = there_and_back[count % len(there_and_back)]
            noise = self._noise[count % NOISE_IMAGES]
            count += 1
            frame = replace(frame, t_ns=t_ns, index=count, left=frame.left | noise, right=frame.right | noise)
            shot = Shot(frame, due_ns)
            self.exposed_ns = due_ns
            yield shot


class Receiver:
    """A receiver of MAVLink, which is there for a while and then is not; it judges each message when it
    comes."""

    def __init__(self, camera: FailingCamera, stale_s: float, seed: int) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.received, self.stale, self.broken, self.away = Counter[str](), 0, 0, 0
        self.longest_silence_s = 0.0
        self._camera, self._stale_ns = camera, int(1e9 * stale_s)
        self._random = np.random.default_rng(seed)
        self._over = False
        self._thread = Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._over = True
        self._thread.join()

    def _run(self) -> None:
        while not self._over:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as here:
                here.bind(("127.0.0.1", self.port))
                here.settimeout(0.1)
                self._listen(here, time.monotonic() + self._random.uniform(5.0, 30.0))
            self.away += 1
            time.sleep(self._random.uniform(0.5, 3.0))

    def _listen(self, here: socket.socket, until_s: float) -> None:
        decoder, before_s = dialect.MAVLink(None), time.monotonic()
        decoder.robust_parsing = True
        while time.monotonic() < until_s and not self._over:
            try:
                data = here.recv(4096)
            except TimeoutError:
                continue
            now_s = time.monotonic()
            self.longest_silence_s = max(self.longest_silence_s, now_s - before_s)
            before_s = now_s
            age_ns = time.monotonic_ns() - self._camera.exposed_ns
            for message in decoder.parse_buffer(data) or []:
                kind = message.get_type()
                self.received[kind] += 1
                self.broken += kind == "BAD_DATA"
                if kind == "OBSTACLE_DISTANCE" and set(message.distances) != {UNKNOWN}:
                    self.stale += age_ns > self._stale_ns + SLACK_NS


class Flying:
    """vista-fly in a process of its own, killed now and then, and the ring that gives it frames."""

    def __init__(
        self, folder: Path, recorded: Sequence, receiver: Receiver, kill_every_s: float, seed: int
    ) -> None:
        rig = folder / "rig.vista"
        rig.write_bytes(head_bytes(recorded, Rectifier(recorded.calibration), parameters.defaults()))
        camera = recorded.calibration.left
        self._name = f"vista-soak-{os.getpid()}"
        self.ring = SharedFrames(self._name, camera.width, camera.height)
        self._command: list[str] = [str(native.build_folder() / "bin" / "vista-fly"), "--rig", str(rig)]
        self._command += ["--shared", self._name, "--to", f"udp:127.0.0.1:{receiver.port}"]
        self._command += ["--out", str(folder / "lines.jsonl")]
        self._random = np.random.default_rng(seed)
        self._kill_every_s = kill_every_s
        self.kills, self.growth_mb, self.ended_itself = 0, 0.0, 0
        self._start()

    def _start(self) -> None:
        self.process = subprocess.Popen(self._command, stderr=subprocess.PIPE, text=True)
        self._started_s, self._settled_mb = time.monotonic(), 0.0
        self._until_s = self._started_s + SETTLING_S + self._random.exponential(self._kill_every_s)

    def watch(self) -> None:
        """Memory since the process has settled; kills it, when its time has come."""
        now_s = time.monotonic()
        if self.process.poll() is not None:
            self.ended_itself += 1
            print("vista-fly ended:", self.process.communicate()[1], file=sys.stderr)
            self._start()
        elif now_s > self._started_s + SETTLING_S:
            self._settled_mb = self._settled_mb or resident_mb(self.process.pid)
            self.growth_mb = max(self.growth_mb, resident_mb(self.process.pid) - self._settled_mb)
        if now_s > self._until_s:
            self.kills += 1
            self.process.kill()
            self.process.communicate()
            self._start()

    def close(self) -> str:
        """What it says at its end."""
        self.process.send_signal(signal.SIGINT)
        said = self.process.communicate(timeout=30)[1]
        self.ring.close()
        return said


def fly(
    recorded: Sequence, camera: FailingCamera, receiver: Receiver, kill_every_s: float, seed: int
) -> bool:
    """True: it held."""
    with tempfile.TemporaryDirectory() as folder:
        flying = Flying(Path(folder), recorded, receiver, kill_every_s, seed)
        for shot in camera.shots(Event()):
            frame = shot.frame
            flying.ring.put(
                frame.left,
                frame.right,
                frame.t_ns,
                shot.exposed_ns,
                frame.world_from_camera,
                recorded.up_world,
                begins=not shot.continues,
            )
            flying.watch()
        print(flying.close(), end="")
        lines = (Path(folder) / "lines.jsonl").read_text().splitlines()
        print(f"{len(lines)} lines; killed {flying.kills} times, ended {flying.ended_itself} times by itself")
        print(f"memory grew by {flying.growth_mb:.2f} MB at most")
        whole = all("directions" in json.loads(line) for line in lines)
        return whole and flying.ended_itself == 0 and flying.growth_mb < FLY_GROWTH_MB


class Memory:
    """A listener that notes the resident memory once the run has settled, and at the end."""

    def __init__(self, settled_s: float) -> None:
        self._settled_s = time.monotonic() + settled_s
        self.settled_mb = 0.0

    def take(self, _seen: Seen) -> None:
        if self.settled_mb == 0.0 and time.monotonic() > self._settled_s:
            self.settled_mb = resident_mb()


def resident_mb(process: int | str = "self") -> float:
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 2**20


def live(
    recorded: Sequence,
    camera: FailingCamera,
    receiver: Receiver,
    values: parameters.Values,
    duration_s: float,
) -> bool:
    """True: its memory stayed what it was."""
    loop = LiveLoop(make_chain(recorded, "golden", values, 1, every_pair=False), camera)
    autopilot = Autopilot(Link(values), open_transport(f"udp:127.0.0.1:{receiver.port}"))
    memory = Memory(SETTLED * duration_s)
    loop.run([autopilot, memory], lambda: False)
    end_mb, totals = resident_mb(), loop.totals
    autopilot.close()
    print(f"{totals.processed} frames processed, {totals.dropped} dropped, {totals.duplicates} duplicates")
    print(f"{totals.restarts} restarts")
    print(f"exposure to result {totals.latency.summary()}")
    print(f"exposure to message {autopilot.latency.summary()}")
    print(f"memory {memory.settled_mb:.1f} MB after {SETTLED * duration_s:.0f} s, {end_mb:.1f} MB at the end")
    return end_mb - memory.settled_mb < GROWTH_MB


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sequence", type=Path)
    parser.add_argument("--rate", type=float, default=30.0, metavar="HZ")
    parser.add_argument("--duration", type=float, default=600.0, metavar="S")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--fly", action="store_true", help="vista-fly in place of vista live")
    parser.add_argument(
        "--kill-every", type=float, default=1e9, metavar="S", help="kill vista-fly, on average"
    )
    args = parser.parse_args()
    values = parameters.defaults()
    recorded = open_sequence(args.sequence)
    frames = [recorded.read(files) for files in recorded.frames]
    camera = FailingCamera(frames, args.rate, args.duration, args.seed)
    receiver = Receiver(camera, values["mavlink"]["stale_s"], args.seed + 1)
    if args.fly:
        held = fly(recorded, camera, receiver, args.kill_every, args.seed + 2)
    else:
        held = live(recorded, camera, receiver, values, args.duration)
    receiver.close()
    print(f"{args.duration:.0f} s at {args.rate:g} Hz, seed {args.seed}; receiver away {receiver.away} times")
    print("faults:", ", ".join(f"{count} {name}" for name, count in sorted(camera.faults.items())))
    print("received:", ", ".join(f"{count} {name}" for name, count in sorted(receiver.received.items())))
    print(f"{receiver.stale} stale, {receiver.broken} broken")
    print(f"longest silence {receiver.longest_silence_s:.2f} s")
    held = held and receiver.stale == 0 and receiver.broken == 0
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
