"""Bags of ROS 1 and ROS 2, written message by message."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from source_cases import QUATERNION_WXYZ, Recording
from vista.geometry import CameraModel, Pose
from vista.rectify import Rectifier, rectified_cameras
from vista.sequence import Frame

KINDS = ("ros1", "sqlite3", "mcap")
STILL_WXYZ = (1.0, 0.0, 0.0, 0.0)
LEFT, RIGHT = "/stereo/left/image_raw", "/stereo/right/image_raw"
CAMERA, BODY, ODOM = "left_optical", "base_link", "odom"


class BagWriter:
    """Writes a bag of one kind; `make` builds messages of its types."""

    def __init__(self, writer: Any, store: Any, is1: bool) -> None:
        self._writer, self._store, self._is1 = writer, store, is1
        self._connections: dict[str, Any] = {}

    def make(self, msgtype: str, **values: Any) -> Any:
        if msgtype == "sensor_msgs/msg/CameraInfo" and self._is1:
            values = {name.upper() if name in "dkrp" else name: value for name, value in values.items()}
        return self._store.types[msgtype](**values)

    def header(self, t_ns: int, frame_id: str) -> Any:
        stamp = self.make("builtin_interfaces/msg/Time", sec=t_ns // 10**9, nanosec=t_ns % 10**9)
        more = {"seq": 0} if self._is1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame_id, **more)

    def connect(self, topic: str, msgtype: str) -> None:
        """Announces a topic, which may stay empty."""
        self._connections[topic] = self._writer.add_connection(topic, msgtype, typestore=self._store)

    def write(self, topic: str, recorded_ns: int, message: Any) -> None:
        msgtype = message.__msgtype__
        if topic not in self._connections:
            self.connect(topic, msgtype)
        serialize = self._store.serialize_ros1 if self._is1 else self._store.serialize_cdr
        self._writer.write(self._connections[topic], recorded_ns, serialize(message, msgtype))


@contextmanager
def bag_writer(path: Path, kind: str) -> Iterator[BagWriter]:
    """path: a file of ROS 1, a folder of ROS 2."""
    if kind == "ros1":
        store = get_typestore(Stores.ROS1_NOETIC)
        tf_message = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(tf_message, "tf2_msgs/msg/TFMessage"))
        with Writer1(path) as writer:
            yield BagWriter(writer, store, True)
    else:
        with Writer2(path, version=9, storage_plugin=StoragePlugin[kind.upper()]) as writer:
            yield BagWriter(writer, get_typestore(Stores.ROS2_HUMBLE), False)


def raw_image(bag: BagWriter, t_ns: int, pixels: np.ndarray, encoding: str = "mono8") -> Any:
    height, width = pixels.shape[:2]
    return bag.make(
        "sensor_msgs/msg/Image",
        header=bag.header(t_ns, CAMERA),
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=0,
        step=pixels.nbytes // height,
        data=np.ascontiguousarray(pixels).view(np.uint8).ravel(),
    )


def compressed_image(bag: BagWriter, t_ns: int, pixels: np.ndarray, extension: str = ".png") -> Any:
    data = cv2.imencode(extension, pixels)[1].ravel()
    codec = {".png": "png", ".jpg": "jpeg"}[extension]
    text = f"mono8; {codec} compressed "
    header = bag.header(t_ns, CAMERA)
    return bag.make("sensor_msgs/msg/CompressedImage", header=header, format=text, data=data)


def camera_info(bag: BagWriter, frame: Frame, recording: Recording, side: str, **changed: Any) -> Any:
    """The camera_info that ROS's calibration program writes."""
    (R, P), *_ = rectified_cameras(recording.raw)[:: 1 if side == "left" else -1]
    camera: CameraModel = getattr(recording.raw, side)
    if Rectifier(recording.raw).is_passthrough:
        offset = camera.matrix[0, 0] * recording.raw.right_from_left.translation_m[0] * (side == "right")
        R, P = np.eye(3), np.column_stack([camera.matrix, [offset, 0.0, 0.0]])
    roi = bag.make(
        "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
    )
    height, width = frame.left.shape
    content = {
        "header": bag.header(frame.t_ns, CAMERA),
        "height": height,
        "width": width,
        "distortion_model": "plumb_bob",
        "d": np.array([*camera.distortion, 0.0]),
        "k": camera.matrix.ravel(),
        "r": R.ravel(),
        "p": P.ravel(),
        "binning_x": 0,
        "binning_y": 0,
        "roi": roi,
    }
    return bag.make("sensor_msgs/msg/CameraInfo", **content | changed)


def quaternion(bag: BagWriter, wxyz: tuple[float, ...]) -> Any:
    w, x, y, z = wxyz
    return bag.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)


def pose(bag: BagWriter, position_m: np.ndarray, wxyz: tuple[float, ...]) -> Any:
    x, y, z = (float(value) for value in position_m)
    point = bag.make("geometry_msgs/msg/Point", x=x, y=y, z=z)
    return bag.make("geometry_msgs/msg/Pose", position=point, orientation=quaternion(bag, wxyz))


def transform(
    bag: BagWriter,
    t_ns: int,
    parent: str,
    child: str,
    position_m: np.ndarray,
    wxyz: tuple[float, ...] = STILL_WXYZ,
) -> Any:
    x, y, z = (float(value) for value in position_m)
    vector = bag.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)
    turn = bag.make("geometry_msgs/msg/Transform", translation=vector, rotation=quaternion(bag, wxyz))
    header = bag.header(t_ns, parent)
    return bag.make("geometry_msgs/msg/TransformStamped", header=header, child_frame_id=child, transform=turn)


def tf(bag: BagWriter, *transforms: Any) -> Any:
    return bag.make("tf2_msgs/msg/TFMessage", transforms=list(transforms))


def odometry(bag: BagWriter, t_ns: int, position_m: np.ndarray, child: str = BODY) -> Any:
    zero = bag.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
    twist = bag.make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
    no = np.zeros(36)
    return bag.make(
        "nav_msgs/msg/Odometry",
        header=bag.header(t_ns, ODOM),
        child_frame_id=child,
        pose=bag.make(
            "geometry_msgs/msg/PoseWithCovariance", pose=pose(bag, position_m, STILL_WXYZ), covariance=no
        ),
        twist=bag.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=no),
    )


def pose_stamped(bag: BagWriter, t_ns: int, position_m: np.ndarray, wxyz: tuple[float, ...]) -> Any:
    header = bag.header(t_ns, "map")
    return bag.make("geometry_msgs/msg/PoseStamped", header=header, pose=pose(bag, position_m, wxyz))


def write_bag(
    path: Path, recording: Recording, kind: str, poses: str = "odometry", compressed: bool = False
) -> Path:
    """poses: odometry (of the body, with tf from there to the camera), pose (of the camera), tf, or none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    origin = np.zeros(3)
    with bag_writer(path, kind) as bag:
        first_ns = recording.frames[0].t_ns
        if poses in ("odometry", "tf"):
            mounted = transform(bag, first_ns, BODY, CAMERA, origin, QUATERNION_WXYZ)
            bag.write("/tf_static", first_ns, tf(bag, mounted))
        for frame in recording.frames:
            t_ns = frame.t_ns
            place: Pose | None = frame.world_from_camera
            assert place is not None
            for side, topic in (("left", LEFT), ("right", RIGHT)):
                pixels = getattr(frame, side)
                message = compressed_image(bag, t_ns, pixels) if compressed else raw_image(bag, t_ns, pixels)
                bag.write(topic + "/compressed" * compressed, t_ns + 3_000_000, message)
                info = camera_info(bag, frame, recording, side)
                bag.write(f"/stereo/{side}/camera_info", t_ns + 3_000_000, info)
            if poses == "odometry":
                bag.write("/odometry", t_ns + 1_000_000, odometry(bag, t_ns, place.translation_m))
            elif poses == "pose":
                message = pose_stamped(bag, t_ns, place.translation_m, QUATERNION_WXYZ)
                bag.write("/pose", t_ns + 1_000_000, message)
            elif poses == "tf":
                moved = transform(bag, t_ns, ODOM, BODY, place.translation_m)
                drift = transform(bag, t_ns, "map", ODOM, np.array([t_ns % 7, 1.0, 2.0]))
                bag.write("/tf", t_ns + 1_000_000, tf(bag, moved, drift))
    return path
