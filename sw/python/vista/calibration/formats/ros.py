"""Two files of ROS: camera_info as `camera_calibration` writes it, or as messages are printed (ROS 1 and 2).

The motion between the cameras is in the rectification matrices and in the fourth column of the right
camera's projection matrix, -focal length times baseline.
"""

from __future__ import annotations

import numpy as np

from vista.calibration.formats.common import (
    File,
    Options,
    Table,
    dump_yaml,
    floats,
    intrinsics_of,
    make_camera,
    make_pose,
)
from vista.calibration.rig import Rig
from vista.errors import InputError
from vista.geometry import Array, CameraModel, Pose
from vista.rectify import rectified_cameras
from vista.sequence.camera_info import LENS_OF
from vista.sequence.yaml_file import image_size, number, numbers, text_of

FILES = (2,)
HAS_UNIT = False
HELP = "the files of both cameras"
KEYS = {  # as a file of camera_calibration, as a message of ROS 1, of ROS 2
    "K": ("camera_matrix", "K", "k"),
    "D": ("distortion_coefficients", "D", "d"),
    "R": ("rectification_matrix", "R", "r"),
    "P": ("projection_matrix", "P", "p"),
}
COUNTS = {"K": {9}, "D": None, "R": {9}, "P": {12}}


def recognises(table: Table) -> bool:
    return all(any(key in table for key in KEYS[name]) for name in ("K", "P"))


def read(files: list[File], options: Options) -> Rig:
    """The files may come in either order: the right one is that with the baseline."""
    found = [{name: _values(file, name) for name in KEYS} for file in files]
    shifts = [np.array(one["P"]).reshape(3, 4)[0, 3] for one in found]
    if (shifts[0] == 0.0) == (shifts[1] == 0.0):
        raise InputError(
            files[0].path, "the projection matrices are not those of a pair: one has the baseline"
        )
    order = (0, 1) if shifts[0] == 0.0 else (1, 0)
    left, right = (_camera(files[i], found[i]) for i in order)
    R1, R2 = (_rotation(files[i], found[i]) for i in order)
    P2 = np.array(found[order[1]]["P"]).reshape(3, 4)
    if not (P2[0, 0] > 0.0 and P2[0, 3] < 0.0):
        raise InputError(files[order[1]].path, "its projection matrix puts the right camera on the left")
    baseline_m = -P2[0, 3] / P2[0, 0]
    # Both in the rectified frame of the left camera.
    return Rig(left, right, Pose(R1), Pose(R2, np.array([baseline_m, 0.0, 0.0])))


def _values(file: File, name: str) -> list[float]:
    for key in KEYS[name]:
        if key in file.table:
            return numbers(file.path, file.table, key, COUNTS[name])
    raise InputError(file.path, f"{KEYS[name][0]} is missing")


def _rotation(file: File, found: dict[str, list[float]]) -> Array:
    return make_pose(
        file.path, "rectification_matrix", np.array(found["R"]).reshape(3, 3), np.zeros(3)
    ).rotation


def _camera(file: File, found: dict[str, list[float]]) -> CameraModel:
    path, table = file.path, file.table
    keys = ("image_width", "image_height") if "image_width" in table else ("width", "height")
    size = image_size(path, [number(path, table, key) for key in keys])
    name = text_of(path, table, "distortion_model")
    if name not in LENS_OF:
        raise InputError(path, f"distortion_model {name} is not known, only {', '.join(LENS_OF)}")
    return make_camera(path, size, intrinsics_of(path, found["K"]), found["D"], LENS_OF[name])


def write(rig: Rig, options: Options) -> dict[str, str]:
    (R_left, P_left), (_, P_right) = rectified_cameras(rig.raw("--to ros"))
    # The same as OpenCV's but for its last digits, of which the motion is computed again.
    R_right = R_left @ rig.right_from_left.rotation.T
    return {
        "left.yaml": _info("left", rig.left, R_left, P_left),
        "right.yaml": _info("right", rig.right, R_right, P_right),
    }


def _info(side: str, camera: CameraModel, R: Array, P: Array) -> str:
    distortion = list(camera.distortion)
    model = "equidistant" if camera.lens == "fisheye" else "plumb_bob"
    if camera.lens == "pinhole" and len(distortion) > 5:
        model = "rational_polynomial"
    elif camera.lens == "pinhole":
        distortion += [0.0] * (5 - len(distortion))  # plumb_bob has k3, too
    return dump_yaml(
        {
            "image_width": camera.width,
            "image_height": camera.height,
            "camera_name": side,
            "camera_matrix": _matrix(camera.matrix),
            "distortion_model": model,
            "distortion_coefficients": _matrix(np.array([distortion])),
            "rectification_matrix": _matrix(R),
            "projection_matrix": _matrix(P),
        }
    )


def _matrix(values: Array) -> Table:
    rows, columns = values.shape
    return {"rows": rows, "cols": columns, "data": floats(values)}
