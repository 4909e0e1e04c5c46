"""Frames that a test hands to vista-fly through shared memory, and lines that come back."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from subprocess import Popen
from typing import Any

from flight_on_disk import HEIGHT, WIDTH, write_flight
from fly_process import prepare, start
from vista.geometry import Pose
from vista.sequence import Frame, open_sequence
from vista.shared_frames import SharedFrames

WAIT_S = 20.0
PERIOD_NS = 100_000_000


def ring_name() -> str:
    return f"vista-test-{os.getpid()}-{time.monotonic_ns()}"


class Flight:
    """A flight on disk, its frames, and its rig."""

    def __init__(self, folder: Path, frames: int = 12) -> None:
        recorded = open_sequence(write_flight(folder / "flight", frames=frames))
        self.frames = [recorded.read(files) for files in recorded.frames]
        self.up_world = recorded.up_world
        prepare(folder / "prepared", folder / "flight")
        self.rig = folder / "prepared" / "rig.vista"
        self.lines = folder / "lines.jsonl"

    def frame(self, k: int) -> Frame:
        """There and back again, at times that increase."""
        count = len(self.frames)
        place = k % (2 * count - 2)
        frame = self.frames[place if place < count else 2 * count - 2 - place]
        pose = frame.world_from_camera
        assert pose is not None
        return replace(
            frame, t_ns=(k + 1) * PERIOD_NS, world_from_camera=Pose(pose.rotation, pose.translation_m)
        )

    def put(self, ring: SharedFrames, k: int, with_pose: bool = True, **more: Any) -> None:
        frame = self.frame(k)
        pose = frame.world_from_camera if with_pose else None
        ring.put(frame.left, frame.right, frame.t_ns, pose=pose, up_world=self.up_world, **more)

    def read(self) -> list[dict[str, Any]]:
        text = self.lines.read_text() if self.lines.exists() else ""
        return [json.loads(line) for line in text.splitlines(keepends=True) if line.endswith("\n")]

    def wait(self, count: int) -> list[dict[str, Any]]:
        deadline_s = time.monotonic() + WAIT_S
        while len(lines := self.read()) < count:
            assert time.monotonic() < deadline_s
            time.sleep(0.01)
        return lines


@contextmanager
def shared_ring(name: str) -> Iterator[SharedFrames]:
    ring = SharedFrames(name, WIDTH, HEIGHT)
    try:
        yield ring
    finally:
        ring.close()


@contextmanager
def flying(*arguments: object, **more: str) -> Iterator[Popen[str]]:
    process = start(*arguments, **more)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()
