"""The node of ROS 2 in a process of its own: what it finds in topics is what a run finds in a bag of them."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import bag_cases as bags
import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, call
from ros_process import MAKE, Bridge, Process, needs_ros, running_bridge, running_node, until
from rosbags.highlevel import AnyReader
from shared_data import SHARED_DATA
from source_cases import Recording, record_flight, write_pairs
from vista import parameters
from vista.chain import make_chain, run_frame
from vista.geometry import Pose
from vista.sequence import Frame, Sequence, open_sequence

pytestmark = needs_ros

LINES, DISPARITY = "/stereo/vista/obstacles_json", "/stereo/disparity"
MARKERS, POINTS = "/stereo/vista/markers", "/stereo/vista/points"
STATES = ("healthy", "degraded", "blind")
OUTPUTS = {
    LINES: "std_msgs/msg/String",
    DISPARITY: "stereo_msgs/msg/DisparityImage",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    MARKERS: "visualization_msgs/msg/MarkerArray",
    POINTS: "sensor_msgs/msg/PointCloud2",
}
STEREO = ("-r", "__ns:=/stereo")
RAW = (*STEREO, "-r", "left/image_rect:=left/image_raw", "-r", "right/image_rect:=right/image_raw")
MOUNTED = "body_from_camera:=[0.0, 0.0, 0.0, -0.5, 0.5, -0.5, 0.5]"  # as write_bag has it in tf


@pytest.fixture
def run_vista(capsys: pytest.CaptureFixture[str]) -> Vista:
    return partial(call, capsys)


def flight(folder: Path, _run_vista: Vista) -> Path:
    """Raw images with lenses, and odometry of the body."""
    return bags.write_bag(folder / "bag", record_flight(folder / "flight", frames=8), "mcap")


def rectified(folder: Path, run_vista: Vista) -> Path:
    """Without poses."""
    pairs = write_pairs(folder / "pairs", record_flight(folder / "flight", frames=8))
    assert run_vista("run", pairs, "--out", folder / "made", "--bag", folder / "bag")[0] == 0
    return folder / "bag"


def euroc(folder: Path, _run_vista: Vista) -> Path:
    if not (SHARED_DATA / "euroc_v101").is_dir():
        pytest.skip("no EuRoC under VISTA_SHARED_DATA")
    sequence = open_sequence(SHARED_DATA / "euroc_v101")
    recording = Recording([sequence.read(files) for files in sequence.frames[:6]], sequence.calibration)
    return bags.write_bag(folder / "bag", recording, "mcap", poses="none")


def kitti(folder: Path, run_vista: Vista) -> Path:
    street = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
    if not street.is_dir():
        pytest.skip("no KITTI odometry under VISTA_SHARED_DATA")
    arguments = ("run", street, "--frames", "0:6", "--out", folder / "made", "--bag", folder / "bag")
    assert run_vista(*arguments)[0] == 0
    return folder / "bag"


RECORDINGS = {
    "flight": (flight, "image_raw", (*RAW, "-r", "odometry:=/odometry", "-p", "poses:=topic", "-p", MOUNTED)),
    "rectified": (rectified, "image_rect", STEREO),
    "euroc": (euroc, "image_raw", (*RAW, "-p", "threads:=2")),
    "kitti": (kitti, "image_rect", (*STEREO, "-r", "odometry:=/vista/odometry", "-p", "poses:=topic")),
}


def messages_of(bag: Path) -> Iterator[tuple[str, Any]]:
    with AnyReader([bag]) as reader:
        for connection, _, data in reader.messages():
            yield connection.topic, reader.deserialize(data, connection.msgtype)


def play(bridge: Bridge, bag: Path, topics: set[str]) -> None:
    """Each frame once that before it is done with."""
    lefts = 0
    for topic, message in messages_of(bag):
        if topic not in topics:
            continue
        if topic.startswith("/stereo/left/image"):
            bridge.wait_for(LINES, lefts)
            lefts += 1
        bridge.publish(topic, message)
    for output in OUTPUTS:
        bridge.wait_for(output, lefts, of_frame if output == "/diagnostics" else lambda _: True)


def of_frame(message: Any) -> bool:
    """Not of a second without one."""
    return bool(message.status[0].values)


def inputs(image: str, *more: str) -> set[str]:
    sides = ("left", "right")
    return {f"/stereo/{side}/{name}" for side in sides for name in (image, "camera_info")} | set(more)


@pytest.mark.parametrize("name", RECORDINGS)
def test_it_finds_what_a_run_finds(tmp_path: Path, run_vista: Vista, name: str) -> None:
    make, image, arguments = RECORDINGS[name]
    bag = make(tmp_path, run_vista)
    assert run_vista("run", bag, "--out", tmp_path / "run")[0] == 0
    expected = [json.loads(line) for line in (tmp_path / "run" / "obstacles.jsonl").read_text().splitlines()]
    with running_node(tmp_path, *arguments) as node, running_bridge(tmp_path) as bridge:
        for output, kind in OUTPUTS.items():
            bridge.hear(output, kind)
        play(bridge, bag, inputs(image, "/odometry", "/vista/odometry"))
        assert node.stop() == 0
    heard = [json.loads(message.data) for message in bridge.heard[LINES]]
    assert list(map(without_time, heard)) == list(map(without_time, expected))
    assert any(line["obstacles"] for line in heard)
    of_frames = [message.status[0] for message in filter(of_frame, bridge.heard["/diagnostics"])]
    assert [STATES[status.level] for status in of_frames] == [line["health"]["state"] for line in expected]
    for line, boxes in zip(expected, bridge.heard[MARKERS], strict=True):
        at = [box.pose.position for box in boxes.markers if box.action == 0 and box.type == 1]
        positions_m = [obstacle["position_camera_m"] for obstacle in line["obstacles"]]
        np.testing.assert_allclose([(p.x, p.y, p.z) for p in at], positions_m, atol=6e-4)
    compare_images(open_sequence(bag), bridge)


def without_time(line: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in line.items() if key != "processing_ms"}


def compare_images(sequence: Sequence, bridge: Bridge) -> None:
    """Disparities and points with those of the chain itself."""
    chain = make_chain(sequence, "golden", parameters.defaults(), threads=1)
    camera = chain.rectifier.calibration
    frame_id = bridge.heard[DISPARITY][0].header.frame_id
    told_of_frames = zip(sequence.frames, bridge.heard[DISPARITY], bridge.heard[POINTS], strict=True)
    for files, told, cloud in told_of_frames:
        result = run_frame(chain, files).result
        words = result.words
        pixels = told.image.data.view("<f4").reshape(camera.height, camera.width)
        np.testing.assert_array_equal(pixels, np.where(words < 0, -1.0, words / 16).astype("<f4"))
        assert (told.f, told.t) == pytest.approx((camera.focal_px, camera.baseline_m))
        assert told.header.stamp.sec * 10**9 + told.header.stamp.nanosec == files.t_ns
        points_m = cloud.data.view("<f4").reshape(-1, 3).astype(float)
        assert len(points_m) == cloud.width
        assert cloud.header.frame_id == frame_id
        # Each is a pixel with a disparity, in a region that was accepted.
        columns = camera.cx + camera.focal_px * points_m[:, 0] / points_m[:, 2]
        rows = camera.cy + camera.focal_px * points_m[:, 1] / points_m[:, 2]
        at = np.rint(rows).astype(int), np.rint(columns).astype(int)
        px = camera.focal_px * camera.baseline_m / points_m[:, 2]
        np.testing.assert_allclose(words[at] / 16, px, rtol=1e-5)
        accepted = {k for k, verdict in enumerate(result.verdict_of_region) if verdict == "ACCEPTED"}
        assert set(result.region_of_pixel[at].tolist()) <= accepted
        of_regions = np.isin(result.region_of_pixel, list(accepted)) & (words > 0)
        assert len(points_m) == np.count_nonzero(of_regions)


# ---- what comes is bad, or does not come ----


class Camera:
    """Two cameras that a test publishes, one pair after the other."""

    def __init__(self, bridge: Bridge) -> None:
        self.bridge, self.t_ns, self._count = bridge, 1_700_000_000_000_000_000, 0
        self._recording = Recording([], cases.RIG)

    def info(self, side: str, **changed: Any) -> None:
        frame = Frame(0, self.t_ns, *cases.texture_pair(0), Pose())
        told = bags.camera_info(MAKE, frame, self._recording, side, **changed)
        self.bridge.publish(f"/{side}/camera_info", told)

    def image(self, side: str, later_ns: int = 0, encoding: str = "mono8", rows: int | None = None) -> None:
        """rows: what is left of them."""
        pixels = cases.texture_pair(self._count)[side == "right"][:rows]
        channels = {"rgb8": 3, "bgr8": 3}.get(encoding, 1)
        pixels = np.repeat(pixels, channels, axis=1).reshape(*pixels.shape, channels).squeeze()
        message = bags.raw_image(MAKE, self.t_ns + later_ns, pixels, encoding)
        self.bridge.publish(f"/{side}/image_rect", message)

    def pair(self, **of_right: Any) -> None:
        self._count += 1
        self.t_ns += 50_000_000
        self.image("left")
        self.image("right", **of_right)


@pytest.fixture
def node(tmp_path: Path) -> Iterator[Process]:
    with running_node(tmp_path) as process:
        yield process


@pytest.fixture
def camera(tmp_path: Path, node: Process) -> Iterator[Camera]:
    """Of a node that has found obstacles, or none, in one pair."""
    with running_bridge(tmp_path) as bridge:
        bridge.hear("/vista/obstacles_json", "std_msgs/msg/String")
        bridge.hear("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        taken = Camera(bridge)
        taken.info("left")
        taken.info("right")
        taken.pair()
        bridge.wait_for("/vista/obstacles_json", 1)
        yield taken


def assert_goes_on(camera: Camera, node: Process) -> None:
    heard = len(camera.bridge.heard["/vista/obstacles_json"])
    camera.pair()
    camera.bridge.wait_for("/vista/obstacles_json", heard + 1)
    assert node.stop() == 0
    assert not [line for line in node.errors if "Traceback" in line]


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
    camera.bridge.process.kill()
    node.says("nothing comes on /left/image_rect, /right/image_rect")
    with running_bridge(tmp_path) as bridge:
        bridge.hear("/vista/obstacles_json", "std_msgs/msg/String")
        again = Camera(bridge)
        again.t_ns = camera.t_ns
        again.pair()
        assert_goes_on(again, node)


def test_a_subscriber_hears_nothing_but_health_when_nothing_comes(tmp_path: Path, node: Process) -> None:
    with running_bridge(tmp_path) as bridge:
        bridge.hear("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        bridge.wait_for("/diagnostics", 1)
        status = bridge.heard["/diagnostics"][0].status[0]
        assert (status.level, status.name) == (2, "vista")
        assert status.message.startswith("nothing comes on /left/image_rect, ")
    assert node.stop(signal.SIGTERM) == 0


BAD_PARAMETERS = {
    "engine:=magic": "vista: parameter engine: 'magic' is none of golden, rtl, opencv",
    "threads:=many": "vista: --ros-args: ",
    "poses:=perhaps": "vista: parameter poses: 'perhaps' is none of none, topic, odometry",
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


def test_it_opens_nothing_beyond_the_loopback(node: Process, camera: Camera) -> None:
    """By the sockets that Linux says it has: 127.0.0.1, and 239.255.0.1, by which participants meet."""
    addresses = set()
    inodes = {
        link.readlink().name
        for link in Path(f"/proc/{node.process.pid}/fd").iterdir()
        if link.is_symlink() and str(link.readlink()).startswith("socket:")
    }
    for table in ("udp", "tcp", "udp6", "tcp6"):
        for row in Path(f"/proc/{node.process.pid}/net/{table}").read_text().splitlines()[1:]:
            fields = row.split()
            if f"socket:[{fields[9]}]" in inodes:
                addresses.add(fields[1].partition(":")[0])
    assert addresses == {"0100007F", "0100FFEF"}
    assert_goes_on(camera, node)
