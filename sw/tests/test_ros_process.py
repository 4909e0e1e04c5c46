"""The node of ROS 2 as a process: its parameters, how it ends, and what it opens."""

from __future__ import annotations

import signal
from contextlib import nullcontext
from pathlib import Path

import interrupted
import pytest
from ros_camera import running_camera
from ros_process import Process, needs_ros, running_node, until

pytestmark = [pytest.mark.slow, needs_ros]

BAD_PARAMETERS = {
    "engine:=magic": "vista: parameter engine: 'magic' is none of golden, rtl, opencv",
    "threads:=many": "vista: --ros-args: ",
    "poses:=perhaps": "vista: parameter poses: 'perhaps' is none of none, topic, odometry",
    "image_transport:=theora": "vista: parameter image_transport: 'theora' is none of raw, compressed",
    "config:=/no/such.toml": "vista: /no/such.toml: no such file",
    "body_from_camera:=[1.0, 2.0]": "vista: parameter body_from_camera: is not seven numbers",
    "pair_tolerance_ms:=-1.0": "vista: parameter pair_tolerance_ms: -1 is not from 0 to 1000000 ms",
}


@pytest.mark.parametrize("parameter", BAD_PARAMETERS)
def test_bad_parameters(tmp_path: Path, parameter: str) -> None:
    with running_node(tmp_path, "-p", parameter) as process:
        assert process.process.wait(60.0) == 2
        until(lambda: bool(process.errors))
    assert process.errors[-1].startswith(BAD_PARAMETERS[parameter])


def test_a_parameter_that_is_not_known(tmp_path: Path) -> None:
    with running_node(tmp_path, "-p", "conifg:=x", "-p", "use_sim_time:=true") as process:
        process.says("parameter conifg is ignored; known: engine, threads, config")
        assert process.stop() == 0
    assert "use_sim_time is ignored" not in "".join(process.errors)


def test_it_opens_nothing_beyond_the_loopback(tmp_path: Path) -> None:
    """Linux says which sockets it has: 127.0.0.1, and 239.255.0.1, by which participants meet."""
    with running_node(tmp_path) as node, running_camera(tmp_path):
        assert addresses_of(node.process.pid) == {"0100007F", "0100FFEF"}
        assert node.stop() == 0


def addresses_of(pid: int) -> set[str]:
    """Addresses of its sockets, as Linux writes them."""
    links = [link for link in Path(f"/proc/{pid}/fd").iterdir() if link.is_symlink()]
    inodes = {link.readlink().name for link in links if str(link.readlink()).startswith("socket:")}
    addresses = set()
    for table in ("udp", "tcp", "udp6", "tcp6"):
        for row in Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]:
            fields = row.split()
            if f"socket:[{fields[9]}]" in inodes:
                addresses.add(fields[1].partition(":")[0])
    return addresses


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("busy", [False, True])
def test_a_signal_ends_it_with_status_0(tmp_path: Path, number: signal.Signals, busy: bool) -> None:
    """It comes while it waits for messages, and while images come."""
    with running_node(tmp_path) as node, running_camera(tmp_path) if busy else nullcontext() as camera:
        if camera is None:
            node.says("nothing comes on /left/image_rect, ")
        else:
            camera.pair()
        assert node.stop(number) == 0
        assert not [line for line in node.errors if "Traceback" in line or "interrupted" in line]


@pytest.mark.parametrize("module", ["rclpy", "vista.ros.node", "rclpy.executors"])
def test_an_interruption_while_it_loads_ends_with_one_line(tmp_path: Path, module: str) -> None:
    program = interrupted.while_loading(module, "ros")
    loading = Process(tmp_path, "-c", program)
    assert loading.process.wait(60.0) == 130
    until(lambda: bool(loading.errors))
    assert loading.errors == ["vista: interrupted"]
