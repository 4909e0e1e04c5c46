"""vista-fly and an autopilot, which pymavlink plays on the loopback interface: what each tells the other."""

from __future__ import annotations

import contextlib
import os
import pty
import signal
import socket
import time
import tty
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_autopilot import Autopilot
from flight_on_disk import WORLD_FROM_CAMERA
from fly_process import fly, prepare
from fly_shared import PERIOD_NS, Flight, flying, ring_name, shared_ring
from mavlink_link import AXES
from pymavlink.dialects.v20 import ardupilotmega as dialect
from vista.geometry import quaternion_from_rotation
from vista.shared_frames import SharedFrames

pytestmark = [pytest.mark.native, pytest.mark.slow]

UNKNOWN = 65535
SILENCE_S = 0.5
NED_FROM_WORLD = np.diag([1.0, -1.0, -1.0])  # world: x ahead, y left, z up


@pytest.fixture
def autopilot() -> Iterator[Autopilot]:
    made = Autopilot()
    yield made
    made.close()


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Flight:
    return Flight(tmp_path_factory.mktemp("mavlink"), 20)


def until(condition: Any, seconds: float = 30.0) -> None:
    deadline_s = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline_s
        time.sleep(0.02)


def test_it_is_told_at_10_hz_and_never_left_in_silence(flight: Flight, autopilot: Autopilot) -> None:
    """It is told with frames, when they cease, and with images that show nothing: unknown then."""
    name = ring_name()
    with (
        shared_ring(name) as ring,
        flying("--rig", flight.rig, "--shared", name, "--to", autopilot.target) as process,
    ):
        start_s = time.monotonic()
        for k in range(20):
            flight.put(ring, k)
            time.sleep(0.1)
        seen_s = time.monotonic()
        time.sleep(1.5)
        lost_s = time.monotonic()
        frame = flight.frame(0)
        for k in range(20, 32):
            grey = np.full_like(frame.left, 90 + k % 3)
            ring.put(grey, grey, (k + 1) * PERIOD_NS)
            time.sleep(0.1)
        end_s = time.monotonic()
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=30)
    distances = autopilot.of_kind("OBSTACLE_DISTANCE")
    times_s = np.array([t_s for t_s, _ in distances])
    assert np.diff(times_s).max() < SILENCE_S
    assert len(times_s) > 9.0 * (end_s - start_s - 1.0)
    assert autopilot.counts["HEARTBEAT"] >= int(end_s - start_s) - 1
    known_s = np.array([t_s for t_s, message in distances if set(message.distances) != {UNKNOWN}])
    assert ((known_s > start_s) & (known_s < seen_s)).sum() > 10
    assert not ((known_s > seen_s + 0.5 + 0.3) & (known_s < lost_s)).any()  # mavlink.stale_s, and on its way
    assert not (known_s > lost_s + 0.5).any()  # blind
    texts = [message.text for _, message in autopilot.of_kind("STATUSTEXT")]
    assert any("lost" in text for text in texts) and any("blind: no_contrast" in text for text in texts)
    assert "messages sent, 0 of them lost" in err


def test_a_receiver_that_is_not_there_is_no_matter(
    flight: Flight, autopilot: Autopilot, tmp_path: Path
) -> None:
    played = prepare(tmp_path, flight.lines.parent / "flight")
    autopilot.close()
    run = fly(*played, "--to", autopilot.target)
    assert run.returncode == 0 and "messages sent" in run.stderr


def fly_poses(
    flight: Flight,
    autopilot: Autopilot,
    ring: SharedFrames,
    frames: int,
    offset_ms: int,
    modes: dict[int, int] | None = None,
) -> None:
    """Frames without poses at 10 Hz, and what the autopilot says of the same flight, at 50 and 25 Hz.

    modes: the main mode of PX4, by the frame from which on it is in that.

    The flight goes on straight: the times of the frames are those of the recording."""
    start_ns = time.monotonic_ns() + 300_000_000
    for step in range(-10, 5 * frames):
        t_ns = start_ns + step * PERIOD_NS // 5
        time.sleep(max(0.0, 1e-9 * (t_ns - time.monotonic_ns())))
        place = step / 5
        first, second = flight.frames[0].world_from_camera, flight.frames[1].world_from_camera
        assert first is not None and second is not None
        step_m = second.translation_m - first.translation_m
        position = NED_FROM_WORLD @ (first.translation_m + place * step_m)
        velocity = NED_FROM_WORLD @ step_m / (1e-9 * PERIOD_NS)
        rotation = NED_FROM_WORLD @ WORLD_FROM_CAMERA @ AXES.T
        boot_ms = offset_ms + t_ns // 1_000_000
        quaternion = quaternion_from_rotation(rotation)
        autopilot.send(dialect.MAVLink_attitude_quaternion_message(boot_ms % 2**32, *quaternion, 0, 0, 0))
        if step % 5 == 0 and modes is not None and step // 5 in modes:
            mode = modes[step // 5] << 16
            autopilot.send(dialect.MAVLink_heartbeat_message(2, 12, 128, mode, 4, 3))
        if step % 2 == 0:
            autopilot.send(dialect.MAVLink_local_position_ned_message(boot_ms % 2**32, *position, *velocity))
        if step >= 0 and step % 5 == 0:
            frame = flight.frames[step // 5]
            ring.put(frame.left, frame.right, t_ns, exposed_ns=t_ns)


def test_a_port_that_is_taken_is_named(flight: Flight) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        run = fly("--rig", flight.rig, "--shared", "none", "--to", "udp:127.0.0.1:14550", "--listen", port)
    assert run.returncode == 2
    assert run.stderr.endswith(f"vista-fly: --listen {port}: address already in use\n")


@pytest.mark.parametrize("own_port", [False, True], ids=["answers", "listens"])
def test_poses_come_from_the_autopilot(flight: Flight, autopilot: Autopilot, own_port: bool) -> None:
    """What is found is what the recording's own poses give, to the accuracy of a millisecond at 10 m/s."""
    name = ring_name()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    flight.lines.unlink(missing_ok=True)
    options = ["--poses", "mavlink", "--to", autopilot.target, "--out", flight.lines]
    options += ["--listen", port] if own_port else []
    with shared_ring(name) as ring, flying("--rig", flight.rig, "--shared", name, *options):
        until(lambda: autopilot.address is not None)
        assert not own_port or autopilot.address == ("127.0.0.1", port)
        fly_poses(flight, autopilot, ring, len(flight.frames), 123_456)
        lines = flight.wait(len(flight.frames) - 3)
    assert {line["motion"] for line in lines} == {"known"}
    assert {line["health"]["state"] for line in lines} == {"healthy"}
    velocity = np.array([line["velocity_camera_m_s"] for line in lines[1:]])
    assert np.abs(velocity - [0.0, 0.0, 10.0]).max() < 0.05
    warned = [line for line in lines if line["nearest_collision"]]
    assert len(warned) >= 3
    for line in warned[1:]:
        nearest = line["nearest_collision"]
        assert nearest["time_to_collision_s"] == pytest.approx(nearest["distance_m"] / 10.0, abs=0.1)
        assert line["directions"]["up_camera"] == pytest.approx([0.0, -1.0, 0.0], abs=1e-4)


def test_it_flies_to_a_goal_while_the_pilot_lets_it(flight: Flight, autopilot: Autopilot) -> None:
    """Setpoints come before it is taken over, too: PX4 enters the mode with them alone."""
    name = ring_name()
    flight.lines.unlink(missing_ok=True)
    options = ["--poses", "mavlink", "--to", autopilot.target, "--out", flight.lines]
    options += ["--goal", "400,0,-10", "--speed", "6"]
    with shared_ring(name) as ring, flying("--rig", flight.rig, "--shared", name, *options) as process:
        until(lambda: autopilot.address is not None)
        fly_poses(flight, autopilot, ring, len(flight.frames), 123_456, modes={4: 6, 12: 3})
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=30)
    sent = autopilot.of_kind("SET_POSITION_TARGET_LOCAL_NED")
    assert len(sent) > 10 * 0.1 * len(flight.frames)
    flown = np.array([[message.x, message.y, message.z] for _, message in sent])
    assert np.linalg.norm(np.diff(flown, axis=0), axis=1).max() < 2.0  # 20 a second, at 10 m/s and less
    assert "taken over 1 times" in err and "decisions took" in err


@pytest.mark.parametrize(
    "options, problem",
    [
        (("--goal", "1,2"), "is N,E,D"),
        (("--goal", "1,2,3x"), "is N,E,D"),
        (("--goal", "1,2,3"), "needs --poses mavlink"),
    ],
)
def test_a_goal_that_is_none_is_refused(flight: Flight, options: tuple[str, ...], problem: str) -> None:
    run = fly("--rig", flight.rig, "--shared", "none", *options)
    assert run.returncode == 2 and problem in run.stderr


def test_without_its_poses_motion_is_unknown(flight: Flight, autopilot: Autopilot) -> None:
    name = ring_name()
    flight.lines.unlink(missing_ok=True)
    options = ["--poses", "mavlink", "--to", autopilot.target, "--out", flight.lines]
    with shared_ring(name) as ring, flying("--rig", flight.rig, "--shared", name, *options):
        for k in range(4):
            flight.put(ring, k)
            flight.wait(k + 1)
    for line in flight.read():
        assert (line["motion"], line["health"]["state"]) == ("unknown", "degraded")
        assert line["health"]["reasons"] == ["motion_unknown"]
        assert line["velocity_camera_m_s"] is None


def test_a_serial_line(flight: Flight) -> None:
    """A pseudo terminal: messages arrive whole, and poses are heard."""
    name, (far, near) = ring_name(), pty.openpty()
    os.set_blocking(far, False)
    tty.setraw(near)  # else it echoes what is written before the program has opened it
    flight.lines.unlink(missing_ok=True)
    decoder, link = dialect.MAVLink(None), dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    kinds: Counter[str] = Counter()
    options = ["--poses", "mavlink", "--to", f"serial:{os.ttyname(near)}:115200", "--out", flight.lines]
    with shared_ring(name) as ring, flying("--rig", flight.rig, "--shared", name, *options):
        for k in range(30):
            boot_ms = 1000 + 50 * k
            os.write(
                far, dialect.MAVLink_attitude_quaternion_message(boot_ms, 1, 0, 0, 0, 0, 0, 0).pack(link)
            )
            os.write(far, dialect.MAVLink_local_position_ned_message(boot_ms, 0, 0, 0, 0, 0, 0).pack(link))
            flight.put(ring, k)
            time.sleep(0.05)
            with contextlib.suppress(BlockingIOError):
                kinds.update(m.get_type() for m in decoder.parse_buffer(os.read(far, 65536)) or [])
        lines = flight.wait(5)
    os.close(far)
    os.close(near)
    assert kinds["OBSTACLE_DISTANCE"] > 5 and kinds["HEARTBEAT"] >= 1 and "BAD_DATA" not in kinds
    assert [line["motion"] for line in lines].count("known") >= 3
