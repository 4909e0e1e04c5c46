"""Files that cv2.FileStorage writes: the matrices of cv2.stereoCalibrate, in one file or in two.

OpenCV's own sample writes M1, D1, M2, D2 to intrinsics.yml and R, T to extrinsics.yml; other programs use
other names for them, of which the frequent ones are known here.
"""

from __future__ import annotations

import cv2
import numpy as np

from vista.calibration.formats.common import File, Options, Table, intrinsics_of, make_camera, make_pose
from vista.calibration.rig import Rig
from vista.errors import InputError
from vista.geometry import CameraModel, Lens, Pose
from vista.rectify import rectified_cameras
from vista.sequence.yaml_file import image_size, number, numbers

FILES = (1, 2)
HAS_UNIT = True
HELP = "one file, or intrinsics.yml and extrinsics.yml"
NAMES = {
    "K1": ("M1", "K1", "cameraMatrix1", "camera_matrix_1", "left_camera_matrix", "LEFT.K"),
    "D1": ("D1", "distCoeffs1", "dist_coeffs_1", "left_distortion_coefficients", "LEFT.D"),
    "K2": ("M2", "K2", "cameraMatrix2", "camera_matrix_2", "right_camera_matrix", "RIGHT.K"),
    "D2": ("D2", "distCoeffs2", "dist_coeffs_2", "right_distortion_coefficients", "RIGHT.D"),
    "R": ("R",),
    "T": ("T",),
}
SIZES = (("image_width", "image_height"), ("width", "height"))


def recognises(table: Table) -> bool:
    return any(name in table for key in ("K1", "R") for name in NAMES[key]) and "rightToLeft" not in table


def read(files: list[File], options: Options) -> Rig:
    table = {key: value for file in files for key, value in file.table.items()}
    path = files[0].path
    found = {key: _find(files, key, names) for key, names in NAMES.items()}
    size = _size(files[0], table) or options.size_px
    if size is None:
        raise InputError(path, "does not say the size of the images: give --size-px WIDTHxHEIGHT")
    lens: Lens = options.lens or ("fisheye" if table.get("distortion_model") == "fisheye" else "pinhole")
    left, right = (
        make_camera(path, size, intrinsics_of(path, found[f"K{i}"]), found[f"D{i}"], lens) for i in (1, 2)
    )
    if len(found["R"]) == 3:  # as a vector
        found["R"] = [float(value) for value in cv2.Rodrigues(np.array(found["R"]))[0].ravel()]
    translation_m = np.array(found["T"]) / round(1.0 / options.unit_m)
    return Rig(left, right, make_pose(path, "R", np.array(found["R"]).reshape(3, 3), translation_m), Pose())


def _find(files: list[File], key: str, names: tuple[str, ...]) -> list[float]:
    counts = {"K": {9}, "D": None, "R": {3, 9}, "T": {3}}[key[0]]
    for file in files:
        for name in names:
            if name in file.table:
                return numbers(file.path, file.table, name, counts)
    raise InputError(files[0].path, f"{names[0]} is missing; expected M1, D1, M2, D2, R and T")


def _size(file: File, table: Table) -> tuple[int, int] | None:
    for keys in SIZES:
        if all(key in table for key in keys):
            return image_size(file.path, [number(file.path, table, key) for key in keys])
    return None


def write(rig: Rig, options: Options) -> dict[str, str]:
    """Writes the rectification, too, for programs that do not compute it themselves."""
    motion = rig.right_from_left
    scale = round(1.0 / options.unit_m)
    (R1, P1), (R2, P2) = rectified_cameras(rig.raw("--to opencv"))
    P2 = P2 * [[1.0, 1.0, 1.0, scale]]
    storage = cv2.FileStorage(".yml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    storage.write("image_width", rig.left.width)
    storage.write("image_height", rig.left.height)
    storage.write("distortion_model", _model(rig))
    for i, camera in ((1, rig.left), (2, rig.right)):
        storage.write(f"M{i}", np.ascontiguousarray(camera.matrix))
        storage.write(f"D{i}", _row(camera))
    storage.write("R", np.ascontiguousarray(motion.rotation))
    storage.write("T", np.ascontiguousarray(motion.translation_m.reshape(3, 1) * scale))
    for name, value in (("R1", R1), ("R2", R2), ("P1", P1), ("P2", P2)):
        storage.write(name, np.ascontiguousarray(value))
    text = storage.releaseAndGetString()
    return {"stereo.yml": text.replace("%YAML 1.2", "%YAML:1.0", 1)}  # which older OpenCV reads, too


def _model(rig: Rig) -> str:
    if rig.left.lens != rig.right.lens:
        raise InputError("--to opencv", "it has no pair of two kinds of lenses")
    return rig.left.lens


def _row(camera: CameraModel) -> np.ndarray:
    return np.array([camera.distortion], np.float64)
