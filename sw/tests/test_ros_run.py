"""The node of ROS 2: what it finds in topics is what a run finds in a bag of them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bag_cases as bags
import numpy as np
import pytest
from command_line import Vista
from ros_process import Bridge, needs_ros, running_bridge, running_node
from rosbags.highlevel import AnyReader
from shared_data import SHARED_DATA
from source_cases import Recording, record_flight, write_pairs
from vista import parameters
from vista.chain import make_chain, run_frame
from vista.sequence import Sequence, open_sequence

pytestmark = [pytest.mark.slow, needs_ros]

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


def flight(folder: Path, _run_vista: Vista) -> Path:
    """Raw images with lenses, and odometry of the body."""
    return bags.write_bag(folder / "bag", record_flight(folder / "flight", frames=8), "mcap")


def compressed(folder: Path, _run_vista: Vista) -> Path:
    """The same images as PNG."""
    recording = record_flight(folder / "flight", frames=8)
    return bags.write_bag(folder / "bag", recording, "mcap", poses="none", compressed=True)


def rectified(folder: Path, run_vista: Vista) -> Path:
    """A rectified recording without poses."""
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
    "compressed": (compressed, "image_raw/compressed", (*RAW, "-p", "image_transport:=compressed")),
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
