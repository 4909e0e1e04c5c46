"""cam0/sensor.yaml and cam1/sensor.yaml of the EuRoC ASL layout."""

from __future__ import annotations

from vista.calibration.formats.common import (
    File,
    Options,
    Table,
    dump_yaml,
    floats,
    intrinsics,
    only_radial_tangential,
    pose_matrix,
)
from vista.calibration.rig import Rig
from vista.geometry import CameraModel, Pose
from vista.sequence.asl import read_sensor

FILES = (2,)
HAS_UNIT = False
HELP = "name the sensor.yaml of the left camera, then that of the right one"


def recognises(table: Table) -> bool:
    return "T_BS" in table and "intrinsics" in table


def read(files: list[File], options: Options) -> Rig:
    (left, body_from_left), (right, body_from_right) = (read_sensor(file.path) for file in files)
    return Rig(left, right, body_from_left, body_from_right, is_body=True)


def write(rig: Rig, options: Options) -> dict[str, str]:
    """Writes one file for each camera. The frame of a rig without a vehicle is that of the left camera."""
    poses = (Pose(), rig.left_from_right)
    if rig.is_body:
        poses = (rig.frame_from_left, rig.frame_from_right)
    cameras = (rig.left, rig.right)
    return {f"cam{i}/sensor.yaml": _sensor(cameras[i], poses[i]) for i in (0, 1)}


def _sensor(camera: CameraModel, body_from_camera: Pose) -> str:
    fisheye = camera.lens == "fisheye"
    return dump_yaml(
        {
            "sensor_type": "camera",
            "T_BS": {"cols": 4, "rows": 4, "data": floats(pose_matrix(body_from_camera))},
            "resolution": [camera.width, camera.height],
            "camera_model": "pinhole",
            "intrinsics": intrinsics(camera),
            "distortion_model": "equidistant" if fisheye else "radial-tangential",
            "distortion_coefficients": only_radial_tangential(camera, 5, "euroc"),
        }
    )
