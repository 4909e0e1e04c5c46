"""Bags of ROS 1 and ROS 2: which topics are read, how their images, cameras and poses are understood."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from types import SimpleNamespace

import bag_cases as bags
import cv2
import numpy as np
import pytest
import sequence_cases as cases
from bag_cases import KINDS, LEFT, RIGHT, BagWriter, bag_writer
from command_line import Vista
from scipy.spatial.transform import Rotation
from source_cases import QUATERNION_WXYZ, UP, Recording
from vista.errors import InputError
from vista.geometry import Pose
from vista.sequence import Frame, Options, Sequence, open_sequence
from vista.sequence.bag_images import grey
from vista.sequence.camera_info import pair_from_camera_info

START_NS = 1_700_000_000_000_000_000
PERIOD_NS = 50_000_000
FRAMES = 5
TIMES_NS = [START_NS + index * PERIOD_NS for index in range(FRAMES)]


@pytest.fixture(scope="session")
def recording() -> Recording:
    """Textures; the camera flies 1 m a frame along x of the world."""
    frames = [
        Frame(index, t_ns, *cases.texture_pair(index), Pose(np.eye(3), np.array([float(index), 0.0, 0.0])))
        for index, t_ns in enumerate(TIMES_NS)
    ]
    return Recording(frames, cases.RIG, UP)


def write_images(
    bag: BagWriter,
    recording: Recording,
    side: str,
    topic: str,
    times_ns: Iterable[int] = TIMES_NS,
    message: Callable[..., object] = bags.raw_image,
) -> None:
    """Writes images with camera_info beside them; the number of a frame is that of its time."""
    for t_ns in times_ns:
        frame = recording.frames[round((t_ns - START_NS) / PERIOD_NS)]
        bag.write(topic, t_ns, message(bag, t_ns, getattr(frame, side)))
        info = bags.camera_info(bag, frame, recording, side)
        bag.write(f"{topic.removesuffix('/compressed').rpartition('/')[0]}/camera_info", t_ns, info)


def write_pair(bag: BagWriter, recording: Recording, left: str = LEFT, right: str = RIGHT) -> None:
    write_images(bag, recording, "left", left)
    write_images(bag, recording, "right", right)


def assert_images(sequence: Sequence, indices: list[int]) -> None:
    assert [files.index for files in sequence.frames] == list(range(len(indices)))
    for files, index in zip(sequence.frames, indices, strict=True):
        frame = sequence.read(files)
        for seen, written in zip((frame.left, frame.right), cases.texture_pair(index), strict=True):
            np.testing.assert_array_equal(seen, written)


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_images_times_and_calibration(tmp_path: Path, recording: Recording, kind: str) -> None:
    sequence = open_sequence(
        bags.write_bag(tmp_path / "bag", recording, kind, "none")
        if kind != "ros1"
        else bags.write_bag(tmp_path / "flight.bag", recording, kind, "none")
    )
    assert sequence.layout == "ROS bag"
    assert [files.t_ns for files in sequence.frames] == TIMES_NS
    assert_images(sequence, list(range(FRAMES)))
    calibration = sequence.calibration
    np.testing.assert_array_equal(calibration.left.matrix, [[120, 0, 80], [0, 120, 60], [0, 0, 1]])
    np.testing.assert_allclose(calibration.right_from_left.translation_m, [-cases.BASELINE_M, 0, 0])
    assert sequence.notes == (f"images are {LEFT} and {RIGHT}",)
    assert all(files.world_from_camera is None for files in sequence.frames)


def test_frames_in_any_order(tmp_path: Path, recording: Recording) -> None:
    sequence = open_sequence(bags.write_bag(tmp_path / "flight.bag", recording, "ros1"))
    for index in (3, 3, 1, 4, 0, 2):
        frame = sequence.read(sequence.frames[index])
        np.testing.assert_array_equal(frame.right, cases.texture_pair(index)[1])


def test_messages_recorded_at_one_time_and_out_of_order(tmp_path: Path, recording: Recording) -> None:
    """The headers tell the order, not the recording."""
    with bag_writer(tmp_path / "flight.bag", "ros1") as bag:
        for index in (2, 0, 1, 4, 3, 3):
            for side, topic in (("left", LEFT), ("right", RIGHT)):
                frame = recording.frames[index]
                bag.write(topic, START_NS, bags.raw_image(bag, frame.t_ns, getattr(frame, side)))
                info = bags.camera_info(bag, frame, recording, side)
                bag.write(f"/stereo/{side}/camera_info", START_NS, info)
    sequence = open_sequence(tmp_path / "flight.bag")
    assert_images(sequence, list(range(FRAMES)))
    repeated = f"1 of 6 images of {LEFT} repeat a time, and are left out"
    assert sequence.notes[1:] == (repeated, repeated.replace("left/image", "right/image"))


def test_a_message_that_is_left_out_shares_its_time_of_recording(
    tmp_path: Path, recording: Recording
) -> None:
    """Going back starts with it."""
    with bag_writer(tmp_path / "flight.bag", "ros1") as bag:
        for index, late_ns in ((0, 0), (1, 0), (1, 9), (2, 9), (3, 9)):  # the second of frame 1 is left out
            for side, topic in (("left", LEFT), ("right", RIGHT)):
                frame = recording.frames[index]
                bag.write(topic, START_NS + late_ns, bags.raw_image(bag, frame.t_ns, getattr(frame, side)))
                info = bags.camera_info(bag, frame, recording, side)
                bag.write(f"/stereo/{side}/camera_info", START_NS + late_ns, info)
    sequence = open_sequence(tmp_path / "flight.bag")
    for index in (3, 2, 3, 2, 0):
        np.testing.assert_array_equal(
            sequence.read(sequence.frames[index]).left, cases.texture_pair(index)[0]
        )


def test_left_and_right_are_paired_and_drops_counted(tmp_path: Path, recording: Recording, kind: str) -> None:
    """Left without frame 2; right without frame 1, frame 3 is 3 ms late, frame 4 is 8 ms late."""
    path = tmp_path / ("flight.bag" if kind == "ros1" else "flight")
    left_ns = [TIMES_NS[index] for index in (0, 1, 3, 4)]
    right_ns = [TIMES_NS[0], TIMES_NS[2], TIMES_NS[3] + 3_000_000, TIMES_NS[4] + 8_000_000]
    with bag_writer(path, kind) as bag:
        write_images(bag, recording, "left", LEFT, left_ns)
        write_images(bag, recording, "right", RIGHT, right_ns)
    sequence = open_sequence(path)
    assert [files.t_ns for files in sequence.frames] == [TIMES_NS[0], TIMES_NS[3]]
    assert sequence.notes[1:] == (
        "1 of 2 pairs have images of two times; they differ by up to 3 ms",
        "4 of 8 images have no partner within 5 ms and are left out",
        "the left images have gaps: 1 of 5 were dropped before the recording",
    )
    assert len(open_sequence(path, Options(pair_tolerance_ms=8)).frames) == 3
    assert len(open_sequence(path, Options(pair_tolerance_ms=1)).frames) == 1


# ---- topics ----


def test_topics_are_chosen_where_several_fit(tmp_path: Path, recording: Recording) -> None:
    rectified = "/stereo/left/image_rect", "/stereo/right/image_rect"
    path = tmp_path / "flight.bag"
    with bag_writer(path, "ros1") as bag:
        write_pair(bag, recording)
        write_pair(bag, recording, *rectified)
        write_images(bag, recording, "left", "/tail/image_raw")
    listed = (
        rf"several pairs of images; choose --left-topic .*: {LEFT}, {rectified[0]}, {RIGHT}, {rectified[1]}"
    )
    with pytest.raises(InputError, match=listed):
        open_sequence(path)
    assert open_sequence(path, Options(left_topic=LEFT)).notes == (f"images are {LEFT} and {RIGHT}",)
    assert len(open_sequence(path, Options(left_topic="/tail/image_raw", right_topic=RIGHT)).frames) == FRAMES
    with pytest.raises(
        InputError, match=r"flight\.bag: has no image topic /nose; its image topics: /stereo/left"
    ):
        open_sequence(path, Options(left_topic="/nose", right_topic=RIGHT))
    with pytest.raises(InputError, match=r"--right-topic: /stereo/left/image_raw is the left topic, too"):
        open_sequence(path, Options(left_topic=LEFT, right_topic=LEFT))


def test_the_calibration_of_another_pair_is_not_taken(tmp_path: Path, recording: Recording) -> None:
    rear = "/rear/left/image_raw", "/rear/right/image_raw"
    with bag_writer(tmp_path / "flight.bag", "ros1") as bag:
        write_pair(bag, recording)
        for side, topic in zip(("left", "right"), rear, strict=True):
            for frame in recording.frames:
                bag.write(topic, frame.t_ns, bags.raw_image(bag, frame.t_ns, getattr(frame, side)))
    with pytest.raises(InputError, match=f"no camera_info beside {rear[0]} and {rear[1]}"):
        open_sequence(tmp_path / "flight.bag", Options(left_topic=rear[0], right_topic=rear[1]))
    assert len(open_sequence(tmp_path / "flight.bag", Options(left_topic=LEFT)).frames) == FRAMES


@pytest.mark.parametrize(
    "topics",
    [
        ("/cam0/image_raw", "/cam1/image_raw"),
        ("/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"),
        ("/left/image_raw/compressed", "/right/image_raw/compressed"),
    ],
)
def test_names_of_sides(tmp_path: Path, recording: Recording, topics: tuple[str, str]) -> None:
    message = bags.compressed_image if topics[0].endswith("compressed") else bags.raw_image
    with bag_writer(tmp_path / "flight", "mcap") as bag:
        for side, topic in zip(("left", "right"), topics, strict=True):
            write_images(bag, recording, side, topic, message=message)
    assert_images(open_sequence(tmp_path / "flight"), list(range(FRAMES)))


# ---- images ----

COLOUR = {"r": 200, "g": 100, "b": 50}
GREY = 0.299 * 200 + 0.587 * 100 + 0.114 * 50


def message_of(pixels: np.ndarray, encoding: str, padding: int = 0) -> SimpleNamespace:
    height, width = pixels.shape[:2]
    rows = np.pad(pixels.reshape(height, -1), ((0, 0), (0, padding)), constant_values=255)
    return SimpleNamespace(
        encoding=encoding, width=width, height=height, step=rows.shape[1], data=rows.ravel(), is_bigendian=0
    )


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "rgba8", "bgra8", "8UC3", "8UC4"])
def test_colours(encoding: str) -> None:
    order = {"8UC3": "bgr", "8UC4": "bgra"}.get(encoding, encoding[:-1])
    pixel = np.array([{**COLOUR, "a": 7}[channel] for channel in order], np.uint8)
    image = grey("x", message_of(np.tile(pixel, (6, 8, 1)), encoding, padding=5))
    assert image.shape == (6, 8)
    assert np.abs(image - GREY).max() <= 0.51


@pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
@pytest.mark.parametrize("compressed", [False, True])
def test_bayer_patterns(pattern: str, compressed: bool) -> None:
    """The pattern names the first two pixels of the first two rows."""
    tile = np.array([COLOUR[channel] for channel in pattern], np.uint8).reshape(2, 2)
    mosaic = np.tile(tile, (5, 6))
    if compressed:
        data = cv2.imencode(".png", mosaic)[1].ravel()
        message = SimpleNamespace(format=f"bayer_{pattern}8; png compressed ", data=data)
    else:
        message = message_of(mosaic, f"bayer_{pattern}8", padding=3)
    assert np.abs(grey("x", message)[1:-1, 1:-1] - GREY).max() <= 1.0


def test_grey_with_padded_rows() -> None:
    pixels = cases.texture_pair(0)[0]
    np.testing.assert_array_equal(grey("x", message_of(pixels, "mono8", padding=16)), pixels)


# ---- calibration ----


def info_of(K: np.ndarray, D: np.ndarray, R: np.ndarray, P: np.ndarray, **more: object) -> SimpleNamespace:
    roi = SimpleNamespace(x_offset=0, y_offset=0, width=0, height=0)
    content: dict[str, object] = {
        "width": 752,
        "height": 480,
        "distortion_model": "plumb_bob",
        "binning_x": 0,
        "binning_y": 0,
        "roi": roi,
    }
    return SimpleNamespace(d=D, k=K.ravel(), r=R.ravel(), p=P.ravel(), **content | more)


def test_a_raw_pair_comes_back_from_what_ros_makes_of_it() -> None:
    """R and P as stereoRectify gives them, which is what cameracalibrator writes."""
    K = [
        np.array([[f, 0, cx], [0, f + 1.5, cy], [0, 0, 1.0]])
        for f, cx, cy in ((458.6, 367, 248), (457, 379, 255))
    ]
    D = [np.array([-0.28, 0.07, 2e-4, 1e-5, 0.0]), np.array([-0.283, 0.074, -1e-4, -3e-5, 0.01])]
    rotation = Rotation.from_rotvec([0.01, -0.02, 0.015]).as_matrix()
    translation_m = np.array([-0.11, 0.0004, -0.0008])
    motion = rotation, translation_m.reshape(3, 1)
    R1, R2, P1, P2 = cv2.stereoRectify(K[0], D[0], K[1], D[1], (752, 480), *motion)[:4]
    infos = info_of(K[0], D[0], R1, P1), info_of(K[1], D[1], R2, P2)
    raw = pair_from_camera_info(*infos, ("left", "right"), (False, False))
    np.testing.assert_allclose(raw.right_from_left.rotation, rotation, atol=1e-12)
    np.testing.assert_allclose(raw.right_from_left.translation_m, translation_m, atol=1e-12)
    np.testing.assert_array_equal(raw.right.matrix, K[1])
    assert raw.right.distortion == tuple(D[1])
    rectified = pair_from_camera_info(*infos, ("left", "right"), (True, True))
    np.testing.assert_array_equal(rectified.left.matrix, P1[:, :3])
    assert not any(rectified.left.distortion)
    np.testing.assert_allclose(rectified.right_from_left.translation_m, [P2[0, 3] / P2[0, 0], 0, 0])
    np.testing.assert_array_equal(rectified.right_from_left.rotation, np.eye(3))


LENSES = [
    ("plumb_bob", [0.1, 0.2, 0.3, 0.4, 0.5], "pinhole", 5),
    ("plumb_bob", [0.0] * 5, "pinhole", 4),
    ("", [], "pinhole", 4),
    ("rational_polynomial", [0.1] * 8, "pinhole", 8),
    ("rational_polynomial", [0.1] * 5 + [0.0] * 3, "pinhole", 5),
    ("equidistant", [0.1, 0.2, 0.3, 0.4], "fisheye", 4),
    ("equidistant", [0.0] * 4, "fisheye", 4),
]


@pytest.mark.parametrize(("model", "distortion", "lens", "count"), LENSES)
def test_lenses(model: str, distortion: list[float], lens: str, count: int) -> None:
    info = info_of(EYE, np.array(distortion), np.eye(3), P_EYE, distortion_model=model)
    camera = pair_from_camera_info(info, info, ("left", "right"), (False, False)).left
    assert camera.lens == lens
    assert camera.distortion == tuple(distortion[:count]) if distortion else (0.0,) * 4


EYE, P_EYE = np.array([[100.0, 0, 50], [0, 100, 50], [0, 0, 1]]), np.eye(3, 4) * 100


def test_zeros_of_a_lens_without_a_name_are_none() -> None:
    """Drivers publish them whose cameras are rectified, or not calibrated."""
    left = info_of(EYE, np.zeros(5), np.eye(3), P_EYE, distortion_model="")
    raw = pair_from_camera_info(left, left, ("left", "right"), (False, False))
    assert raw.left.distortion == (0.0,) * 4


CAMERAS: dict[str, tuple[SimpleNamespace, str]] = {
    "not calibrated": (
        info_of(np.zeros((3, 3)), np.zeros(5), np.eye(3), P_EYE),
        "right: .* is not calibrated",
    ),
    "another lens": (
        info_of(EYE, np.full(4, 0.1), np.eye(3), P_EYE, distortion_model="double_sphere"),
        "right: distortion 'double_sphere' is not one of plumb_bob, rational_polynomial, equidistant, ",
    ),
    "more coefficients": (
        info_of(EYE, np.full(14, 0.1), np.eye(3), P_EYE, distortion_model="rational_polynomial"),
        "right: D holds 14 numbers; rational_polynomial has 4 or 5 or 8",
    ),
    "fewer": (
        info_of(EYE, np.full(2, 0.1), np.eye(3), P_EYE, distortion_model="equidistant"),
        "right: D holds 2 numbers; equidistant has 4",
    ),
    "no rotation": (info_of(EYE, np.zeros(5), np.zeros((3, 3)), P_EYE), "right: R is not a rotation matrix"),
    "NaN": (
        info_of(EYE * np.nan, np.zeros(5), np.eye(3), P_EYE),
        "right: K does not hold 3x3 finite numbers",
    ),
    "bad distortion": (info_of(EYE, np.full(5, np.inf), np.eye(3), P_EYE), "right: D holds a number that"),
    "binning": (info_of(EYE, np.zeros(5), np.eye(3), P_EYE, binning_x=2), "right: binning or a region"),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_cameras_that_are_refused(name: str) -> None:
    left = info_of(EYE, np.zeros(5), np.eye(3), P_EYE)
    right, message = CAMERAS[name]
    with pytest.raises(InputError, match=message):
        pair_from_camera_info(left, right, ("left", "right"), (False, False))


# ---- poses ----


def write_flight(path: Path, recording: Recording, *poses: str, child: str = bags.BODY) -> Path:
    """poses: topics to write."""
    origin = np.zeros(3)
    with bag_writer(path, "sqlite3") as bag:
        write_pair(bag, recording)
        if "/tf_static" in poses:
            mounted = bags.transform(bag, 0, bags.BODY, bags.CAMERA, np.array([0.5, 0, 0.1]), QUATERNION_WXYZ)
            bag.write("/tf_static", START_NS, bags.tf(bag, mounted))
        for index in range(-1, 2 * FRAMES):  # twice as often as frames, and between them
            t_ns = START_NS + PERIOD_NS // 4 + index * PERIOD_NS // 2
            place_m = np.array([(t_ns - START_NS) / PERIOD_NS, 0.0, 0.0])
            if "/odometry" in poses:
                bag.write("/odometry", t_ns, bags.odometry(bag, t_ns, place_m, child))
            if "/pose" in poses:
                bag.write("/pose", t_ns, bags.pose_stamped(bag, t_ns, place_m, QUATERNION_WXYZ))
            if "/tf" in poses:
                moved = bags.transform(bag, t_ns, "odom", bags.BODY, place_m)
                jumps = bags.transform(bag, t_ns, "map", "odom", np.array([index % 3, 0.0, 0.0]))
                bag.write("/tf", t_ns, bags.tf(bag, moved, jumps))
            if "/still" in poses:
                bag.write("/tf", t_ns, bags.tf(bag, bags.transform(bag, t_ns, "table", "cup", origin)))
    return path


def positions(sequence: Sequence) -> np.ndarray:
    return np.array([files.world_from_camera.translation_m for files in sequence.frames])


UP_NOTE = "; up is taken to be the z axis of their world"
ALONG_X = np.array([[index, 0.0, 0.0] for index in range(FRAMES)])
MOUNT = np.array([0.5, 0.0, 0.1])


def test_poses_of_the_body_go_through_tf(tmp_path: Path, recording: Recording) -> None:
    sequence = open_sequence(write_flight(tmp_path / "bag", recording, "/odometry", "/tf_static"))
    np.testing.assert_allclose(positions(sequence), ALONG_X + MOUNT, atol=1e-7)
    expected = Rotation.from_quat(QUATERNION_WXYZ, scalar_first=True).as_matrix()
    np.testing.assert_allclose(sequence.frames[2].world_from_camera.rotation, expected, atol=1e-12)
    np.testing.assert_array_equal(sequence.up_world, [0, 0, 1])
    assert sequence.notes[1] == "poses are those of base_link in /odometry" + UP_NOTE


def test_poses_by_tf_do_not_jump_with_the_map(tmp_path: Path, recording: Recording) -> None:
    sequence = open_sequence(write_flight(tmp_path / "bag", recording, "/tf", "/tf_static"))
    np.testing.assert_allclose(positions(sequence), ALONG_X + MOUNT, atol=1e-7)
    assert sequence.notes[1] == "poses are those of left_optical in odom, by tf" + UP_NOTE


def test_poses_of_a_named_frame(tmp_path: Path, recording: Recording) -> None:
    path = write_flight(tmp_path / "bag", recording, "/pose", "/tf_static")
    with pytest.raises(
        InputError, match=r"bag, topic /pose: does not say whose poses .* --pose-frame camera"
    ):
        open_sequence(path)
    of_camera = open_sequence(path, Options(pose_frame="camera"))
    np.testing.assert_allclose(positions(of_camera), ALONG_X, atol=1e-7)
    of_body = open_sequence(path, Options(pose_frame=bags.BODY))
    turned = Rotation.from_quat(QUATERNION_WXYZ, scalar_first=True).apply(MOUNT)
    np.testing.assert_allclose(positions(of_body), ALONG_X + turned, atol=1e-7)


def test_several_poses_need_a_choice(tmp_path: Path, recording: Recording) -> None:
    path = write_flight(tmp_path / "bag", recording, "/pose", "/odometry", "/tf", "/tf_static")
    with pytest.raises(InputError, match=r"several topics of poses: /odometry, /pose; choose --pose-topic"):
        open_sequence(path)
    for topic in ("/odometry", "/tf"):
        sequence = open_sequence(path, Options(pose_topic=topic))
        np.testing.assert_allclose(positions(sequence), ALONG_X + MOUNT, atol=1e-7)
    assert open_sequence(path, Options(pose_topic="none")).frames[0].world_from_camera is None
    with pytest.raises(
        InputError, match=r"bag: has no pose topic /gps; its pose topics: /odometry, /pose, /tf"
    ):
        open_sequence(path, Options(pose_topic="/gps"))


def test_a_camera_without_a_place_on_the_body(tmp_path: Path, recording: Recording) -> None:
    path = write_flight(tmp_path / "bag", recording, "/odometry")
    with pytest.raises(
        InputError, match=r"holds poses of 'base_link', and tf does not say where .*'left_optical'"
    ):
        open_sequence(path)
    nameless = write_flight(tmp_path / "nameless", recording, "/odometry", child="")
    with pytest.raises(InputError, match="does not say whose poses it holds"):
        open_sequence(nameless)


def test_tf_of_other_things_is_no_pose(tmp_path: Path, recording: Recording) -> None:
    path = write_flight(tmp_path / "bag", recording, "/still")
    assert open_sequence(path).frames[0].world_from_camera is None
    with pytest.raises(
        InputError, match=r"topic /tf: does not tell how the camera's frame 'left_optical' moves"
    ):
        open_sequence(path, Options(pose_topic="/tf"))


def test_frames_outside_the_poses_are_left_out(tmp_path: Path, recording: Recording) -> None:
    path = tmp_path / "bag"
    with bag_writer(path, "mcap") as bag:
        write_pair(bag, recording)
        for t_ns in TIMES_NS[1:4]:
            bag.write("/odometry", t_ns, bags.odometry(bag, t_ns, np.zeros(3), bags.CAMERA))
    sequence = open_sequence(path)
    assert [files.index for files in sequence.frames] == [1, 2, 3]
    assert sequence.notes[-1] == f"2 of 5 frames lie outside the time of {path}, topic /odometry"


def write_restarted(path: Path, recording: Recording, at_ns: int, jump_m: float, back_ns: int = 0) -> Path:
    """Odometry of the camera that is 30 m away and moves 1 m a frame; from at_ns on it lies jump_m behind."""
    with bag_writer(path, "mcap") as bag:
        write_pair(bag, recording)
        for t_ns in range(START_NS - PERIOD_NS // 2, TIMES_NS[-1] + PERIOD_NS, PERIOD_NS // 2):
            behind = t_ns >= at_ns
            place_m = np.array([30.0 + (t_ns - START_NS) / PERIOD_NS - jump_m * behind, 0.0, 0.0])
            message = bags.odometry(bag, t_ns - back_ns * behind, place_m, bags.CAMERA)
            bag.write("/odometry", t_ns, message)
    return path


def test_odometry_that_begins_anew_is_said_and_not_mixed(tmp_path: Path, recording: Recording) -> None:
    at_ns = TIMES_NS[2] + PERIOD_NS // 2
    sequence = open_sequence(write_restarted(tmp_path / "bag", recording, at_ns, 32.5))
    assert [files.anew for files in sequence.frames] == [False, False, False, True, False]
    expected = 30.0 + np.arange(FRAMES) - np.array([0.0, 0.0, 0.0, 32.5, 32.5])
    np.testing.assert_allclose(positions(sequence)[:, 0], expected, atol=1e-7)
    said = f"which began anew at another place at {1e-9 * at_ns:.3f} s: all tracks are dropped there"
    assert said in sequence.notes[1]


def test_no_frame_lies_between_the_places(tmp_path: Path, recording: Recording) -> None:
    """The frame between the last message before and the first one after has no pose that means anything."""
    path = tmp_path / "bag"
    with bag_writer(path, "mcap") as bag:
        write_pair(bag, recording)
        for index in (0, 1, 3, 4):
            place_m = np.array([100.0 if index < 2 else 0.0, 0.0, 0.0])
            bag.write("/odometry", TIMES_NS[index], bags.odometry(bag, TIMES_NS[index], place_m, bags.CAMERA))
    sequence = open_sequence(path)
    assert [(files.index, files.anew) for files in sequence.frames] == [
        (0, False),
        (1, False),
        (3, True),
        (4, False),
    ]
    assert sequence.notes[-1] == f"1 of 5 frames lie outside the time of {path}, topic /odometry"


def test_a_correction_is_no_restart(tmp_path: Path, recording: Recording) -> None:
    sequence = open_sequence(write_restarted(tmp_path / "bag", recording, TIMES_NS[2], 1.5))
    assert not any(files.anew for files in sequence.frames)
    assert "anew" not in sequence.notes[1]


def test_odometry_whose_time_goes_back_is_refused(tmp_path: Path, recording: Recording) -> None:
    path = write_restarted(tmp_path / "bag", recording, TIMES_NS[3], 33.0, back_ns=2_000_000_000)
    with pytest.raises(InputError, match=r"topic /odometry, message 7: its time goes back by 2\.0 s"):
        open_sequence(path)


def test_a_run_drops_its_tracks_where_odometry_begins_anew(
    tmp_path: Path, recording: Recording, run_vista: Vista
) -> None:
    """The jump is 6 m in a frame of 50 ms: not fast enough for the detector to refuse it."""
    path = write_restarted(tmp_path / "bag", recording, TIMES_NS[2] + PERIOD_NS // 2, 7.0)
    status, out, err = run_vista("run", path, "--out", tmp_path / "out")
    assert status == 0 and "which began anew at another place" in out
    assert "frame 3: degraded: the poses began anew; all tracks were dropped" in err
    lines = [json.loads(line) for line in (tmp_path / "out" / "obstacles.jsonl").read_text().splitlines()]
    # Without the tracks, the frames after it are not healthy either.
    assert ["pose_jump" in line["health"]["reasons"] for line in lines] == [False, False, False, True, True]
