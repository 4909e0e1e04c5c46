"""vista-fly as a program: watched over, killed and started again, and without heap in flight."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from fly_process import SANITIZED, allocations_of_one_pass_and_ten, prepare, timeless
from fly_shared import Flight, flying, ring_name, shared_ring
from random_seed import seeded
from shared_data import REPOSITORY

pytestmark = [pytest.mark.native, pytest.mark.slow]

UNIT = REPOSITORY / "sw" / "apps" / "fly" / "vista-fly.service"


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Flight:
    return Flight(tmp_path_factory.mktemp("program"), 10)


@pytest.fixture
def systemd(tmp_path: Path) -> Iterator[socket.socket]:
    """The socket that systemd would listen on."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as made:
        made.bind(str(tmp_path / "notify"))
        made.settimeout(10.0)
        yield made


def test_systemd_is_told(flight: Flight, systemd: socket.socket) -> None:
    name = ring_name()
    with (
        shared_ring(name),
        flying("--rig", flight.rig, "--shared", name, NOTIFY_SOCKET=systemd.getsockname()) as process,
    ):
        assert systemd.recv(100) == b"READY=1"
        times_s = []
        for _ in range(5):
            assert systemd.recv(100) == b"WATCHDOG=1"
            times_s.append(time.monotonic())
        assert times_s[-1] - times_s[0] < 4.0  # the unit asks for one every 5 s
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)
        said = b"WATCHDOG=1"
        while said == b"WATCHDOG=1":
            said = systemd.recv(100)
        assert said == b"STOPPING=1"


def test_an_abstract_socket(flight: Flight) -> None:
    address = f"\0{ring_name()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(address)
        listener.settimeout(10.0)
        arguments = ["--rig", flight.rig, "--shared", "nobody"]
        with flying(*arguments, NOTIFY_SOCKET=address.replace("\0", "@")):
            assert listener.recv(100) == b"READY=1"


def test_a_loop_that_stands_still_ends_the_program(
    flight: Flight, systemd: socket.socket, tmp_path: Path
) -> None:
    """Nobody reads the pipe that the lines go to: the watchdog hears no more of it, and it ends by itself."""
    name, pipe = ring_name(), tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    options = ["--rig", flight.rig, "--shared", name, "--out", pipe, "--watchdog", "1"]
    stopped = threading.Event()
    with shared_ring(name) as ring, flying(*options, NOTIFY_SOCKET=systemd.getsockname()) as process:

        def put() -> None:
            for k in range(10_000):
                if stopped.wait(0.01):
                    return
                flight.put(ring, k)

        thread = threading.Thread(target=put)
        thread.start()
        try:
            _, err = process.communicate(timeout=120)
        finally:
            stopped.set()
            thread.join()
    os.close(reader)
    assert process.returncode == 3
    assert "detection stands still for 1.0 s" in err


@pytest.mark.parametrize("turn", range(3))
def test_killed_and_started_again(flight: Flight, turn: int) -> None:
    """It goes on at once, at whatever moment it is killed, and the lines are whole. A frame comes once, but
    for the one that a program finds as the newest when it starts."""
    name, random = ring_name(), seeded(20 + turn)
    flight.lines.unlink(missing_ok=True)
    k, last_ns = 0, 0
    with shared_ring(name) as ring:
        for _ in range(3):
            with flying("--rig", flight.rig, "--shared", name, "--out", flight.lines) as process:
                before = len(flight.read())
                while len(flight.read()) < before + 3:
                    flight.put(ring, k)
                    k += 1
                    time.sleep(0.03)
                time.sleep(float(random.uniform(0.0, 0.05)))
                process.send_signal(signal.SIGKILL)
                process.communicate(timeout=30)
            assert process.returncode == -signal.SIGKILL
            times_ns = [line["t_ns"] for line in flight.read()[before:]]
            assert times_ns == sorted(set(times_ns)) and times_ns[0] >= last_ns
            last_ns = times_ns[-1]
    assert len(flight.read()) >= 9


def test_ctrl_c_leaves_what_was_written(flight: Flight, tmp_path: Path) -> None:
    played = prepare(tmp_path, flight.lines.parent / "flight")
    with flying(*played, "--repeat", "--out", tmp_path / "lines.jsonl") as process:
        while not (tmp_path / "lines.jsonl").exists() or len((tmp_path / "lines.jsonl").read_text()) < 100:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert err.endswith("vista-fly: interrupted\n")
    assert timeless(tmp_path / "lines.jsonl")


def test_it_begins_again_with_another_flight(flight: Flight, tmp_path: Path) -> None:
    played = prepare(tmp_path, flight.lines.parent / "flight", "--frames", "0:3")
    with flying(*played, "--repeat", "--out", tmp_path / "lines.jsonl") as process:
        while not (tmp_path / "lines.jsonl").exists() or len(timeless(tmp_path / "lines.jsonl")) < 8:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    assert int(err.split(" restarts")[0].split()[-1]) >= 2


# ---- memory ----


@pytest.mark.skipif(SANITIZED, reason="AddressSanitizer replaces malloc itself")
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_frames_allocate_nothing(flight: Flight, tmp_path: Path) -> None:
    """Ten passes over the frames take what one takes, with lines, messages, and a watchdog."""
    played = prepare(tmp_path, flight.lines.parent / "flight")
    options = ["--to", "udp:127.0.0.1:9", "--out", tmp_path / "lines"]
    counts, _ = allocations_of_one_pass_and_ten(tmp_path, played, *options)
    assert counts[0] == counts[1] >= 6  # the program, a rig, frames, the pipeline: the counter counts
    assert len((tmp_path / "lines").read_text().splitlines()) == 11 * 10


# ---- the package ----


def test_the_unit_asks_for_what_the_program_does() -> None:
    settings = dict(line.split("=", 1) for line in UNIT.read_text().splitlines() if "=" in line)
    assert settings["Type"] == "notify" and settings["Restart"] == "always"
    assert float(settings["WatchdogSec"]) > 4 * 0.1 + 3.0  # --watchdog acts before
    assert settings["SuccessExitStatus"] == "130"
