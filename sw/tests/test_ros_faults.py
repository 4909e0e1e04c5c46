"""The node of ROS 2 goes on when what comes is bad, or does not come, and says in one line what is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from ros_camera import Camera, assert_goes_on, running_camera
from ros_process import Process, needs_ros, running_bridge, running_node, until

pytestmark = [pytest.mark.slow, needs_ros]


@pytest.fixture
def node(tmp_path: Path) -> Iterator[Process]:
    with running_node(tmp_path) as process:
        yield process


@pytest.fixture
def camera(tmp_path: Path, node: Process) -> Iterator[Camera]:
    with running_camera(tmp_path) as taken:
        yield taken


BAD_PAIRS = {
    "an encoding that is not read": (
        {"encoding": "mono16"},
        "/right/image_rect: encoding 'mono16' is not read; known: mono8, 8uc1, bgr8",
    ),
    "another size": ({"rows": 60}, "/right/image_rect: image is 160x60, the calibration says 160x120"),
}


@pytest.mark.parametrize("name", BAD_PAIRS)
def test_a_bad_image_is_one_line(node: Process, camera: Camera, name: str) -> None:
    changed, text = BAD_PAIRS[name]
    for _ in range(5):
        camera.pair(**changed)
    node.says(text)
    camera.bridge.wait_until("/diagnostics", lambda message: text in message.status[0].message)
    assert sum(f"[vista]: {text}" in line for line in node.errors) <= 2  # when it comes, and when it lasts
    assert_goes_on(camera, node)


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "bayer_rggb8"])
def test_encodings(node: Process, camera: Camera, encoding: str) -> None:
    camera.pair(encoding=encoding)
    camera.bridge.wait_for("/vista/obstacles_json", 2)
    assert_goes_on(camera, node)


def test_a_damaged_jpeg_is_one_line(tmp_path: Path) -> None:
    with (
        running_node(tmp_path, "-p", "image_transport:=compressed") as node,
        running_camera(tmp_path, compressed=True) as camera,
    ):
        text = "/right/image_rect/compressed: "
        camera.pair(bytes_missing=10)
        node.says(text)
        camera.bridge.wait_until("/diagnostics", lambda message: text in message.status[0].message)
        assert_goes_on(camera, node)


def test_times_that_do_not_agree(node: Process, camera: Camera) -> None:
    text = "/right/image_rect: no image within 5 ms of any of /left/image_rect"
    until(lambda: camera.pair(later_ns=20_000_000) or any(text in line for line in node.errors))
    camera.t_ns += 50_000_000
    assert_goes_on(camera, node)


def test_images_without_times(node: Process, camera: Camera) -> None:
    for _ in range(3):
        camera.image("left")
    node.says("/left/image_rect: an image repeats the time of the one before, and is left out")
    assert_goes_on(camera, node)


def test_a_clock_that_goes_back(node: Process, camera: Camera) -> None:
    camera.t_ns -= 10_000_000_000
    assert_goes_on(camera, node)


def test_another_calibration(node: Process, camera: Camera) -> None:
    camera.info("left", p=np.zeros(12))
    node.says("/left/camera_info: the camera is not calibrated")
    camera.info("left")
    assert_goes_on(camera, node)


def test_no_camera_info(tmp_path: Path, node: Process) -> None:
    with running_bridge(tmp_path) as bridge:
        camera = Camera(bridge)
        bridge.hear("/vista/obstacles_json", "std_msgs/msg/String")
        camera.info("left")
        text = "nothing comes on /right/camera_info"
        until(lambda: camera.pair() or any(text in line for line in node.errors))
        camera.info("right")
        assert_goes_on(camera, node)


def test_a_publisher_that_is_killed(tmp_path: Path, node: Process, camera: Camera) -> None:
    left_behind = camera.bridge.kill()
    node.says("nothing comes on /left/image_rect, /right/image_rect")
    with running_bridge(tmp_path) as bridge:
        bridge.hear("/vista/obstacles_json", "std_msgs/msg/String")
        again = Camera(bridge)
        again.t_ns = camera.t_ns
        again.pair()
        assert_goes_on(again, node)
    for segment in left_behind:
        segment.unlink(missing_ok=True)


def test_a_subscriber_hears_nothing_but_health_when_nothing_comes(tmp_path: Path, node: Process) -> None:
    with running_bridge(tmp_path) as bridge:
        bridge.hear("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        bridge.wait_for("/diagnostics", 1)
        status = bridge.heard["/diagnostics"][0].status[0]
        assert (status.level, status.name) == (2, "vista")
        assert status.message.startswith("nothing comes on /left/image_rect, ")
    assert node.stop() == 0
