"""Frames from another process through shared memory: in order, whole, and from a ring that goes and comes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import struct
import time
from pathlib import Path

import numpy as np
import pytest
from flight_on_disk import HEIGHT, WIDTH
from fly_process import fly
from fly_shared import Flight, flying, ring_name, shared_ring
from random_seed import seeded
from vista.errors import InputError
from vista.shared_frames import SharedFrames

pytestmark = [pytest.mark.native, pytest.mark.slow]


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Flight:
    return Flight(tmp_path_factory.mktemp("shared"))


@pytest.fixture(autouse=True)
def no_lines(flight: Flight) -> None:
    flight.lines.unlink(missing_ok=True)


def test_each_frame_gives_its_line(flight: Flight) -> None:
    name = ring_name()
    with (
        shared_ring(name) as ring,
        flying("--rig", flight.rig, "--shared", name, "--out", flight.lines) as process,
    ):
        for k in range(8):
            flight.put(ring, k)
            flight.wait(k + 1)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert [line["t_ns"] for line in flight.read()] == [flight.frame(k).t_ns for k in range(8)]
    assert [line["frame"] for line in flight.read()] == list(range(8))
    assert {line["motion"] for line in flight.read()} == {"known"}
    assert any(line["obstacles"] for line in flight.read())
    assert "8 frames processed, 0 dropped" in err and "0 duplicates, 0 restarts" in err


def test_sizes_that_somebody_else_wrote_into_the_ring_are_not_read_again() -> None:
    """Whoever can open the memory can write there; the writer goes on with the sizes that it knows."""
    name = ring_name()
    with shared_ring(name) as ring:
        place = Path("/dev/shm") / name
        sound = place.read_bytes()
        with place.open("r+b") as file:
            file.seek(12)
            file.write(struct.pack("<3I", 8192, 8192, 1 << 30))  # width, height, bytes of a slot
        image = np.full((HEIGHT, WIDTH), 7, np.uint8)
        ring.put(image, image, 1)
        written = place.read_bytes()
        assert len(written) == len(sound)
        assert written.count(image.tobytes()) == 2
        with pytest.raises(InputError):
            ring.put(np.zeros((8192, 8192), np.uint8), np.zeros((8192, 8192), np.uint8), 2)


def test_a_ring_that_comes_later_and_one_that_is_made_anew(flight: Flight) -> None:
    name = ring_name()
    with flying("--rig", flight.rig, "--shared", name, "--out", flight.lines) as process:
        assert process.stderr is not None and "waiting for it" in process.stderr.readline()
        for turn in range(2):
            with shared_ring(name) as ring:
                assert "there" in process.stderr.readline()
                for k in range(3):
                    flight.put(ring, k)
                    flight.wait(3 * turn + k + 1)
            assert "gone" in process.stderr.readline()
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=30)
    assert "6 frames processed" in err and "1 restarts" in err


def produce(name: str, count: int) -> None:
    """Writes in a process of its own, as fast as it can: each image has one grey level, with which its time
    goes."""
    ring = SharedFrames(name, WIDTH, HEIGHT)
    for k in range(1, count + 1):
        left = np.full((HEIGHT, WIDTH), k % 256, np.uint8)
        ring.put(left, left, k)


def test_a_writer_that_is_killed_and_comes_back(flight: Flight) -> None:
    """Killed in the midst of writing, most probably: what it left is not taken for a frame."""
    name = ring_name()
    random = seeded(1)
    with flying("--rig", flight.rig, "--shared", name, "--out", flight.lines):
        for _ in range(3):
            writer = multiprocessing.get_context("fork").Process(target=produce, args=(name, 10**6))
            writer.start()
            time.sleep(random.uniform(0.3, 0.6))
            os.kill(writer.pid or 0, signal.SIGKILL)
            writer.join()
        before = len(flight.read())
        with shared_ring(name) as ring:
            for k in range(4):
                flight.put(ring, k)
                time.sleep(0.5)
            flight.wait(before + 3)


def test_images_of_another_size_are_refused(flight: Flight) -> None:
    name = ring_name()
    ring = SharedFrames(name, WIDTH, HEIGHT + 2)
    try:
        run = fly("--rig", flight.rig, "--shared", name)
    finally:
        ring.close()
    assert run.returncode == 2
    assert f"images are {WIDTH}x{HEIGHT + 2}, the rig says {WIDTH}x{HEIGHT}" in run.stderr


@pytest.mark.parametrize("seed", range(3))
def test_a_damaged_ring_never_ends_the_flight(flight: Flight, seed: int) -> None:
    """Whatever is written over it, or cut off, while it is read; then the ring is made anew."""
    name = ring_name()
    random = seeded(10 + seed)
    path = Path("/dev/shm") / name
    with flying("--rig", flight.rig, "--shared", name, "--out", flight.lines) as process:
        for k in range(20):
            with shared_ring(name) as ring:
                time.sleep(0.25 if k == 0 else 0.02)
                flight.put(ring, k)
                content = bytearray(path.read_bytes())
                for at in random.integers(0, 300, 40):
                    content[at] = random.integers(0, 256)
                path.write_bytes(content[: random.integers(0, len(content))])
                time.sleep(0.02)
                with path.open("r+b") as file:  # as large as it was, so that its writer can close it
                    file.truncate(len(content))
        assert process.poll() is None
        before = len(flight.read())
        with shared_ring(name) as ring:
            for k in range(4):
                flight.put(ring, k)
                time.sleep(0.4)
            flight.wait(before + 2)


@pytest.mark.parametrize("name", ["", ".hidden", "a/b", "x" * 65, "blank space"])
def test_bad_names_are_refused(flight: Flight, name: str) -> None:
    with pytest.raises(InputError):
        SharedFrames(name, WIDTH, HEIGHT)
    if name != "blank space":
        assert fly("--rig", flight.rig, "--shared", name).returncode == 2


def test_other_images_are_refused(flight: Flight) -> None:
    with shared_ring(ring_name()) as ring, pytest.raises(InputError):
        ring.put(np.zeros((HEIGHT, WIDTH), np.uint8), np.zeros((HEIGHT, WIDTH + 1), np.uint8), 1)
