"""`vista mavlink`: a recording reaches a receiver on UDP and on a serial line as it was flown."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista
from mavlink_lines import line, write_lines
from pymavlink.dialects.v20 import ardupilotmega as dialect
from vista import parameters
from vista.mavlink.link import Link
from vista.mavlink.sighting import read_sightings
from vista.mavlink.transport import open_transport

pytestmark = pytest.mark.slow

LINES = [line(k) for k in range(30)]


class Listener:
    """What arrives on a file descriptor, decoded by pymavlink."""

    def __init__(self, receive: Any) -> None:
        self.decoder, self.messages = dialect.MAVLink(None), []
        self._receive, self._over = receive, False
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        while not self._over:
            try:
                data = self._receive()
            except (TimeoutError, BlockingIOError):
                continue
            self.messages += self.decoder.parse_buffer(data) or []

    def stop(self) -> list[Any]:
        time.sleep(0.2)
        self._over = True
        self._thread.join()
        return self.messages


def check_flight(messages: list[Any]) -> None:
    """Whatever else the machine did at the time."""
    assert not [m for m in messages if m.get_type() == "BAD_DATA"]
    distances = [m for m in messages if m.get_type() == "OBSTACLE_DISTANCE"]
    seen = [m for m in distances if m.distances[0] <= m.max_distance]
    ahead = [m.distances[0] for m in seen]
    assert len(ahead) >= 5 and ahead == sorted(ahead, reverse=True)
    assert {min(abs(cm - (2990 - 50 * k)) for k in range(30)) for cm in ahead} <= {0, 1}
    assert all(m.distances[4] == m.max_distance + 1 for m in seen)
    assert set(distances[-1].distances) == {65535}  # no more frames
    assert {m.get_srcComponent() for m in messages} == {196}
    kinds = Counter(m.get_type() for m in messages)
    assert kinds["HEARTBEAT"] >= 2 and kinds["COLLISION"] >= 5 and kinds["STATUSTEXT"] >= 2


def test_a_recording_reaches_a_udp_receiver(tmp_path: Path, run_vista: Vista) -> None:
    write_lines(tmp_path / "out" / "obstacles.jsonl", LINES)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(0.05)
        listener = Listener(lambda: receiver.recv(4096))
        start = time.monotonic()
        status, out, err = run_vista(
            "mavlink", tmp_path / "out", "--to", f"udp:127.0.0.1:{receiver.getsockname()[1]}"
        )
        assert time.monotonic() - start >= 29 * 0.05 + 1.0
        messages = listener.stop()
    assert (status, err) == (0, "")
    assert out.startswith("30 frames to px4 at udp:127.0.0.1:") and "OBSTACLE_DISTANCE" in out
    check_flight(messages)


def test_a_recording_reaches_a_serial_receiver(tmp_path: Path, run_vista: Vista) -> None:
    file = write_lines(tmp_path / "obstacles.jsonl", LINES)
    controller, terminal = os.openpty()
    os.set_blocking(controller, False)

    def receive() -> bytes:
        time.sleep(0.005)
        return os.read(controller, 4096)

    listener = Listener(receive)
    status, _, err = run_vista("mavlink", file, "--to", f"serial:{os.ttyname(terminal)}:57600")
    messages = listener.stop()
    os.close(terminal)
    os.close(controller)
    assert (status, err) == (0, "")
    check_flight(messages)


def test_ardupilot_gets_points(tmp_path: Path, run_vista: Vista) -> None:
    file = write_lines(tmp_path / "obstacles.jsonl", LINES[:5])
    config = tmp_path / "my.toml"
    config.write_text('[mavlink]\nautopilot = "ardupilot"\nmount_yaw_deg = 90.0\n')
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(0.05)
        listener = Listener(lambda: receiver.recv(4096))
        target = f"udp:127.0.0.1:{receiver.getsockname()[1]}"
        assert run_vista("mavlink", file, "--to", target, "--config", config)[0] == 0
        messages = listener.stop()
    points = [m for m in messages if m.get_type() == "OBSTACLE_DISTANCE_3D"]
    assert points and not [m for m in messages if m.get_type() == "OBSTACLE_DISTANCE"]
    assert all(abs(p.x) < 1e-3 and 27.0 < p.y <= 30.0 for p in points)


def test_nobody_need_listen(tmp_path: Path, run_vista: Vista) -> None:
    file = write_lines(tmp_path / "obstacles.jsonl", LINES[:3])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    status, out, err = run_vista("mavlink", file, "--to", f"udp:127.0.0.1:{port}")
    assert (status, err) == (0, "") and "3 frames" in out


def test_a_receiver_that_comes_later_is_reached() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        address = free.getsockname()
    transport = open_transport(f"udp:{address[0]}:{address[1]}")
    for _ in range(3):
        transport.send(b"to nobody")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(address)
        receiver.settimeout(10.0)
        transport.send(b"lost")  # that nobody listened may be told only now
        transport.send(b"found")
        assert receiver.recv(100) in (b"lost", b"found")
    transport.close()


def test_an_interruption_ends_it(tmp_path: Path) -> None:
    file = write_lines(tmp_path / "obstacles.jsonl", [line(k, t_ns=10**11 * k) for k in range(3)])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(120.0)
        target = f"udp:127.0.0.1:{receiver.getsockname()[1]}"
        command = [sys.executable, "-m", "vista", "mavlink", str(file), "--to", target]
        program = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        receiver.recv(4096)  # it is at work
        program.send_signal(signal.SIGINT)
        out, err = program.communicate(timeout=60)
    assert program.returncode == 130 and out == "" and err.count("\n") == 1
    assert err.startswith("vista: interrupted: ") and " frames to px4 at udp:" in err


def test_a_serial_line_that_is_unplugged_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vista.mavlink.transport.REOPEN_S", 0.0)
    controller, terminal = os.openpty()
    name = os.ttyname(terminal)
    line_ = open_transport(f"serial:{name}")
    line_.send(b"first")
    assert os.read(controller, 100) == b"first"
    os.close(controller)
    os.close(terminal)
    for _ in range(3):
        line_.send(b"lost")
    assert line_.lost >= 1
    line_.close()


@pytest.mark.parametrize("baud", ["", ":57600"])
def test_a_device_may_have_colons_in_its_name(baud: str, tmp_path: Path) -> None:
    """Those in /dev/serial/by-path have them."""
    controller, terminal = os.openpty()
    device = tmp_path / "pci-0000:00:14.0-usb-0:2:1.0-port0"
    device.symlink_to(os.ttyname(terminal))
    line_ = open_transport(f"serial:{device}{baud}")
    line_.send(b"first")
    assert os.read(controller, 100) == b"first"
    line_.close()
    os.close(controller)
    os.close(terminal)


def test_what_a_real_run_found_is_in_its_sector(tmp_path: Path, run_vista: Vista) -> None:
    """A board straight ahead, from the images to the message."""
    folder = cases.make_board_scenes(tmp_path / "pairs", 5, stills=False)
    assert run_vista("run", folder, "--out", tmp_path / "out", "--no-overlay")[0] == 0
    last = read_sightings(tmp_path / "out")[-1]
    assert last.obstacles and max(last.frame.directions.free_m) > 0.0
    link, decoder = Link(parameters.defaults()), dialect.MAVLink(None)
    link.update(last, 10**9)
    messages = [decoded for data in link.due(10**9) for decoded in decoder.parse_buffer(data)]
    (sectors,) = (m for m in messages if m.get_type() == "OBSTACLE_DISTANCE")
    nearest = min(last.obstacles, key=lambda board: np.linalg.norm(list(board.position_camera_m)))
    x_m, _, z_m = nearest.position_camera_m
    sector = round(np.degrees(np.arctan2(x_m, z_m)) / 5.0) % 72
    assert sectors.distances[sector] == pytest.approx(100.0 * np.hypot(x_m, z_m), abs=60.0)
