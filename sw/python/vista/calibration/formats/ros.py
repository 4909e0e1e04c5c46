"""Two files of ROS: camera_info as `camera_calibration` writes it, or as messages are printed (ROS 1 and 2).

The motion between the cameras is in the rectification matrices and in the fourth column of the right
camera's projection matrix, -focal length times baseline.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np

from vista.calibration.formats.common import File, Options, Table, dump_yaml, floats
from vista.calibration.rig import Rig, rig_of
from vista.errors import InputError
from vista.geometry import Array, CameraModel
from vista.rectify import rectified_cameras
from vista.sequence.camera_info import pair_from_camera_info
from vista.sequence.yaml_file import image_size, number, numbers, table_of, text_of

FILES = (2,)
HAS_UNIT = False
HELP = "the files of both cameras"
KEYS = {  # as a file of camera_calibration, as a message of ROS 1, of ROS 2
    "k": ("camera_matrix", "K", "k"),
    "d": ("distortion_coefficients", "D", "d"),
    "r": ("rectification_matrix", "R", "r"),
    "p": ("projection_matrix", "P", "p"),
}
COUNTS = {"k": {9}, "d": None, "r": {9}, "p": {12}}


def recognises(table: Table) -> bool:
    return all(any(key in table for key in KEYS[name]) for name in ("k", "p"))


def read(files: list[File], options: Options) -> Rig:
    """The files may come in either order: the right one is that with the baseline."""
    infos = [_info_of(file) for file in files]
    shifts = [info.p[3] for info in infos]
    if (shifts[0] == 0.0) == (shifts[1] == 0.0):
        raise InputError(
            files[0].path, "the projection matrices are not those of a pair: one has the baseline"
        )
    left, right = (0, 1) if shifts[0] == 0.0 else (1, 0)
    names = (str(files[left].path), str(files[right].path))
    return rig_of(pair_from_camera_info(infos[left], infos[right], names, (False, False)))


def _info_of(file: File) -> SimpleNamespace:
    """The fields of a message of ROS 2; what is not stated of binning and the region of interest is 0."""
    path, table = file.path, file.table
    roi = table_of(path, table, "roi") if "roi" in table else {}
    keys = ("image_width", "image_height") if "image_width" in table else ("width", "height")
    width, height = image_size(path, [number(path, table, key) for key in keys])
    return SimpleNamespace(
        width=width,
        height=height,
        distortion_model=text_of(path, table, "distortion_model"),
        **{name: _values(file, name) for name in KEYS},
        roi=SimpleNamespace(**_counts(path, roi, ("x_offset", "y_offset", "width", "height"))),
        **_counts(path, table, ("binning_x", "binning_y")),
    )


def _counts(path: Path, table: Table, keys: tuple[str, ...]) -> dict[str, float]:
    return {key: number(path, table, key) if key in table else 0.0 for key in keys}


def _values(file: File, name: str) -> list[float]:
    for key in KEYS[name]:
        if key in file.table:
            return numbers(file.path, file.table, key, COUNTS[name])
    raise InputError(file.path, f"{KEYS[name][0]} is missing")


def write(rig: Rig, options: Options) -> dict[str, str]:
    (_, P_left), (R_right, P_right) = rectified_cameras(rig.raw("--to ros"))
    R_right = _with_first_row(R_right, rig.right_from_left.translation_m * np.sign(P_right[0, 3]))
    R_left = R_right @ rig.right_from_left.rotation
    return {
        "left.yaml": _info("left", rig.left, R_left, P_left),
        "right.yaml": _info("right", rig.right, R_right, P_right),
    }


def _with_first_row(R: Array, axis: Array) -> Array:
    """A rotation next to R whose first row has exactly the direction of an axis.

    The motion between the cameras is computed from the matrices again. OpenCV turns the cameras by
    an angle it has from a cosine, which leaves only some 13 digits of the direction of the baseline.
    """
    x = axis / np.linalg.norm(axis)
    y = R[1] - (R[1] @ x) * x
    y /= np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)])


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
