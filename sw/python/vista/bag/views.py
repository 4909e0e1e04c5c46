"""What the run saw, as messages of ROS: images with camera_info, disparities, poses, diagnostics."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista.bag.types import WORLD, Messages
from vista.engine import SCALE
from vista.geometry import Calibration, Pose
from vista.health.finding import State
from vista.history import FrameRecord
from vista.pipeline import Motion

INVALID_PX = -1.0
LEVELS = {State.HEALTHY: 0, State.DEGRADED: 1, State.BLIND: 2}  # diagnostic_msgs: OK, WARN, ERROR


def image(messages: Messages, t_ns: int, pixels: NDArray[Any], encoding: str) -> Any:
    height, width = pixels.shape
    return messages.make(
        "sensor_msgs/msg/Image",
        header=messages.header(t_ns),
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=0,
        step=width * pixels.itemsize,
        data=np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8),
    )


def camera_info(messages: Messages, t_ns: int, camera: Calibration, right: bool) -> Any:
    """Describes a rectified camera: P of the right one tells the baseline."""
    f, cx, cy = camera.focal_px, camera.cx, camera.cy
    roi = messages.make(
        "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
    )
    offset = -f * camera.baseline_m if right else 0.0
    return messages.make(
        "sensor_msgs/msg/CameraInfo",
        header=messages.header(t_ns),
        height=camera.height,
        width=camera.width,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=np.array([f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0]),
        r=np.eye(3).ravel(),
        p=np.array([f, 0.0, cx, offset, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0]),
        binning_x=0,
        binning_y=0,
        roi=roi,
    )


def disparity(
    messages: Messages, t_ns: int, words: NDArray[np.int16], camera: Calibration, candidates: int
) -> Any:
    """Pixels without one hold -1, which is below min_disparity."""
    pixels = np.where(words < 0, INVALID_PX, words / SCALE).astype("<f4")
    window = messages.make(
        "sensor_msgs/msg/RegionOfInterest",
        x_offset=0,
        y_offset=0,
        height=camera.height,
        width=camera.width,
        do_rectify=False,
    )
    return messages.make(
        "stereo_msgs/msg/DisparityImage",
        header=messages.header(t_ns),
        image=image(messages, t_ns, pixels, "32FC1"),
        f=camera.focal_px,
        t=camera.baseline_m,
        valid_window=window,
        min_disparity=0.0,
        max_disparity=float(candidates - 1),
        delta_d=1.0 / SCALE,
    )


def cloud(messages: Messages, t_ns: int, points_m: NDArray[np.float32]) -> Any:
    """points_m: (N, 3), in the frame of the camera."""
    fields = [
        messages.make("sensor_msgs/msg/PointField", name=name, offset=4 * k, datatype=7, count=1)  # FLOAT32
        for k, name in enumerate("xyz")
    ]
    data = points_m.astype("<f4").tobytes()
    return messages.make(
        "sensor_msgs/msg/PointCloud2",
        header=messages.header(t_ns),
        height=1,
        width=len(points_m),
        fields=fields,
        is_bigendian=False,
        point_step=12,
        row_step=len(data),
        data=np.frombuffer(data, np.uint8),
        is_dense=True,
    )


def picture(messages: Messages, t_ns: int, jpeg: bytes) -> Any:
    return messages.make(
        "sensor_msgs/msg/CompressedImage",
        header=messages.header(t_ns),
        format="jpeg",
        data=np.frombuffer(jpeg, np.uint8),
    )


def odometry(messages: Messages, t_ns: int, world_from_camera: Pose, motion: Motion) -> Any:
    """The pose given, and the velocity of the motion in the camera, NaN where it is not known."""
    velocity_m_s = motion.velocity_m_s
    known = np.full(3, np.nan) if velocity_m_s is None else motion.pose.rotation.T @ velocity_m_s
    nothing = np.zeros(36)  # covariances are not known
    twist = messages.make(
        "geometry_msgs/msg/Twist", linear=messages.vector(known), angular=messages.vector(np.full(3, np.nan))
    )
    pose = messages.pose(world_from_camera.translation_m, world_from_camera.rotation)
    return messages.make(
        "nav_msgs/msg/Odometry",
        header=messages.header(t_ns, WORLD),
        child_frame_id=messages.camera_frame,
        pose=messages.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=nothing),
        twist=messages.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=nothing),
    )


def transform(messages: Messages, t_ns: int, world_from_camera: Pose) -> Any:
    stamped = messages.make(
        "geometry_msgs/msg/TransformStamped",
        header=messages.header(t_ns, WORLD),
        child_frame_id=messages.camera_frame,
        transform=messages.make(
            "geometry_msgs/msg/Transform",
            translation=messages.vector(world_from_camera.translation_m),
            rotation=messages.quaternion(world_from_camera.rotation),
        ),
    )
    return messages.make("tf2_msgs/msg/TFMessage", transforms=[stamped])


def diagnostics(messages: Messages, record: FrameRecord) -> Any:
    """Health with its reasons, and the times of the stages."""
    values = {f"{name}_ms": f"{value:.3f}" for name, value in record.stage_ms.items()}
    values |= {"valid_fraction": f"{record.valid_fraction:.4f}", "path_seen_m": f"{record.path_seen_m:.3f}"}
    text = "; ".join(finding.text for finding in record.health.findings) or str(record.health.state)
    return status(messages, record.t_ns, record.health.state, text, values)


def status(messages: Messages, t_ns: int, state: State, text: str, values: dict[str, str]) -> Any:
    """What diagnostics hold about one moment."""
    told = messages.make(
        "diagnostic_msgs/msg/DiagnosticStatus",
        level=LEVELS[state],
        name="vista",
        message=text,
        hardware_id="",
        values=[
            messages.make("diagnostic_msgs/msg/KeyValue", key=key, value=value)
            for key, value in values.items()
        ],
    )
    return messages.make("diagnostic_msgs/msg/DiagnosticArray", header=messages.header(t_ns), status=[told])
