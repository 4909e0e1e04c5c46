"""Writes the bag of a run."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from vista.bag import views
from vista.bag.foxglove import SCENE_UPDATE
from vista.bag.scene import Scene
from vista.bag.types import Messages
from vista.chain import Step
from vista.errors import InputError
from vista.geometry import Array, Calibration, Pose, level_world
from vista.history import FrameRecord
from vista.output import unwritable

VERSION: Literal[9] = 9  # of metadata.yaml: of ROS 2 Iron and later
LEFT, RIGHT = "/stereo/left", "/stereo/right"
TOPICS = {
    f"{LEFT}/image_rect": "sensor_msgs/msg/Image",
    f"{LEFT}/camera_info": "sensor_msgs/msg/CameraInfo",
    f"{RIGHT}/image_rect": "sensor_msgs/msg/Image",
    f"{RIGHT}/camera_info": "sensor_msgs/msg/CameraInfo",
    "/stereo/disparity": "stereo_msgs/msg/DisparityImage",
    "/vista/obstacles": SCENE_UPDATE,
    "/vista/overlay/compressed": "sensor_msgs/msg/CompressedImage",
    "/vista/odometry": "nav_msgs/msg/Odometry",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}


class BagWriter:
    """Writes beside its target; leaving the `with` block puts the bag in place, whole frames only."""

    def __init__(self, path: Path, camera: Calibration, candidates: int, up_world: Array | None) -> None:
        """camera: of the rectified pair; candidates: the number of disparities. Raises InputError when there
        is something at the path, or nothing can be written there."""
        self._path, self._camera, self._candidates, self._up_world = path, camera, candidates, up_world
        if path.exists():
            raise InputError(path, "exists; name a new folder for the bag")
        try:
            self._beside = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}."))
        except OSError as error:
            raise unwritable(path, error) from None
        self._messages = Messages()
        self._scene = Scene(self._messages)
        self._writer = Writer(self._beside / path.name, version=VERSION, storage_plugin=StoragePlugin.MCAP)
        self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        self._connections: dict[str, Any] = {}
        self._level: Array | None = None
        self._frames = 0

    def __enter__(self) -> BagWriter:
        self._writer.open()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._writer.close()
            if self._frames > 0 and (kind is None or issubclass(kind, InputError)):
                (self._beside / self._path.name).rename(self._path)
        except OSError as error:
            raise unwritable(self._path, error) from None
        finally:
            shutil.rmtree(self._beside, ignore_errors=True)

    def write(self, step: Step, record: FrameRecord, jpeg: bytes | None) -> None:
        """record: with the health of the frame; jpeg: the picture of the frame. Raises InputError."""
        make, t_ns, frame = self._messages, record.t_ns, step.frame
        content = {
            f"{LEFT}/image_rect": views.image(make, t_ns, frame.left, "mono8"),
            f"{LEFT}/camera_info": views.camera_info(make, t_ns, self._camera, right=False),
            f"{RIGHT}/image_rect": views.image(make, t_ns, frame.right, "mono8"),
            f"{RIGHT}/camera_info": views.camera_info(make, t_ns, self._camera, right=True),
            "/stereo/disparity": views.disparity(
                make, t_ns, step.result.words, self._camera, self._candidates
            ),
            "/vista/obstacles": self._scene.update(record),
            "/diagnostics": views.diagnostics(make, record),
        }
        if jpeg is not None:
            content["/vista/overlay/compressed"] = views.picture(make, t_ns, jpeg)
        if frame.world_from_camera is not None:
            pose = self._levelled(frame.world_from_camera)
            content["/vista/odometry"] = views.odometry(make, t_ns, pose, record.motion)
            content["/tf"] = views.transform(make, t_ns, pose)
        try:
            for topic, message in content.items():
                self._write(topic, t_ns, message)
        except OSError as error:
            raise unwritable(self._path, error) from None
        self._frames += 1

    def _levelled(self, pose: Pose) -> Pose:
        if self._level is None:
            self._level = level_world(self._up_world, pose)
        return Pose(self._level) @ pose

    def _write(self, topic: str, t_ns: int, message: Any) -> None:
        kind = TOPICS[topic]
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(
                topic, kind, typestore=self._messages.store
            )
        data = self._messages.store.serialize_cdr(message, kind)
        self._writer.write(self._connections[topic], t_ns, data)
