"""camchain.yaml of Kalibr: cam0 is the left camera, cam1 the right one."""

from __future__ import annotations

from pathlib import Path

from vista.calibration.formats.common import (
    File,
    Options,
    Table,
    dump_yaml,
    floats,
    intrinsics,
    make_camera,
    matrix_pose,
    only_radial_tangential,
    pose_matrix,
)
from vista.calibration.rig import Rig
from vista.errors import InputError
from vista.geometry import CameraModel, Lens, Pose, poses_agree
from vista.sequence.yaml_file import image_size, numbers, table_of, text_of

FILES = (1,)
HAS_UNIT = False
HELP = "one camchain.yaml"
IMU_TOLERANCE = 1e-3  # m, and of the numbers of a rotation: such files are edited by hand
LENS_OF: dict[str, Lens] = {"radtan": "pinhole", "none": "pinhole", "equidistant": "fisheye"}


def recognises(table: Table) -> bool:
    return "cam0" in table and "cam1" in table


def read(files: list[File], options: Options) -> Rig:
    path, table = files[0].path, files[0].table
    if "cam2" in table:
        raise InputError(path, "is a chain of more than two cameras; keep the pair, as cam0 and cam1")
    cameras = [table_of(path, table, name) for name in ("cam0", "cam1")]
    left, right = (_read_camera(path, camera) for camera in cameras)
    right_from_left = matrix_pose(path, "T_cn_cnm1", numbers(path, cameras[1], "T_cn_cnm1", {16}))
    if not all("T_cam_imu" in camera for camera in cameras):
        return Rig(left, right, right_from_left, Pose())
    from_left, from_right = (
        matrix_pose(path, "T_cam_imu", numbers(path, camera, "T_cam_imu", {16})).inverse()
        for camera in cameras
    )
    if not poses_agree(from_right.inverse() @ from_left, right_from_left, IMU_TOLERANCE):
        raise InputError(path, "T_cam_imu of both cameras do not agree with T_cn_cnm1")
    return Rig(left, right, from_left, from_right, is_body=True)


def _read_camera(path: Path, table: Table) -> CameraModel:
    model = text_of(path, table, "camera_model")
    if model != "pinhole":
        raise InputError(path, f"camera_model {model} is not known, only pinhole")
    name = text_of(path, table, "distortion_model")
    if name not in LENS_OF:
        raise InputError(path, f"distortion_model {name} is not known, only {', '.join(LENS_OF)}")
    distortion = [0.0] * 4 if name == "none" else numbers(path, table, "distortion_coeffs", {4})
    fx, fy, cx, cy = numbers(path, table, "intrinsics", {4})
    size = image_size(path, numbers(path, table, "resolution", {2}))
    return make_camera(path, size, (fx, fy, cx, cy), distortion, LENS_OF[name])


def write(rig: Rig, options: Options) -> dict[str, str]:
    cameras = [_camera(camera, index) for index, camera in enumerate((rig.left, rig.right))]
    if rig.is_body:
        for camera, pose in zip(cameras, (rig.frame_from_left, rig.frame_from_right), strict=True):
            camera["T_cam_imu"] = _rows(pose.inverse())
    cameras[1]["T_cn_cnm1"] = _rows(rig.right_from_left)
    return {"camchain.yaml": dump_yaml({"cam0": cameras[0], "cam1": cameras[1]})}


def _camera(camera: CameraModel, index: int) -> Table:
    return {
        "camera_model": "pinhole",
        "intrinsics": intrinsics(camera),
        "distortion_model": "equidistant" if camera.lens == "fisheye" else "radtan",
        "distortion_coeffs": only_radial_tangential(camera, 4, "kalibr"),
        "resolution": [camera.width, camera.height],
        "rostopic": f"/cam{index}/image_raw",
        "cam_overlaps": [1 - index],
    }


def _rows(pose: Pose) -> list[list[float]]:
    return [floats(row) for row in pose_matrix(pose)]
