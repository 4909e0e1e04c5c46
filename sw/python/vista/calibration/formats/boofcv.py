"""stereo.yaml of BoofCV, whose lengths are in the unit that its board was measured in."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vista.calibration.formats.common import (
    File,
    Options,
    Table,
    dump_yaml,
    floats,
    intrinsics,
    make_camera,
    make_pose,
    only_radial_tangential,
)
from vista.calibration.rig import Rig
from vista.errors import InputError
from vista.geometry import CameraModel, Pose
from vista.sequence.yaml_file import image_size, number, numbers, table_of, text_of

FILES = (1,)
HAS_UNIT = True
HELP = "one stereo.yaml"
MODEL = "pinhole_radial_tangential"


def recognises(table: Table) -> bool:
    return "rightToLeft" in table


def read(files: list[File], options: Options) -> Rig:
    path, table = files[0].path, files[0].table
    left, right = (_read_camera(path, table_of(path, table, side)) for side in ("left", "right"))
    motion = table_of(path, table, "rightToLeft")
    rotation = np.array(numbers(path, motion, "rotation", {9})).reshape(3, 3)
    translation = np.array([number(path, motion, axis) for axis in "xyz"])
    pose = make_pose(path, "rightToLeft", rotation, _in_metres(translation, options.unit_m))
    return Rig(left, right, Pose(), pose)


def _in_metres(lengths: np.ndarray, unit_m: float) -> np.ndarray:
    # Divided by a whole number, and multiplied by it when they are written: that gives the same digits again.
    return lengths / round(1.0 / unit_m)


def _read_camera(path: Path, table: Table) -> CameraModel:
    model = text_of(path, table, "model")
    if model != MODEL:
        raise InputError(path, f"model {model} is not known, only {MODEL}")
    pinhole, lens = table_of(path, table, "pinhole"), table_of(path, table, "radial_tangential")
    if number(path, pinhole, "skew") != 0.0:
        raise InputError(path, "skew must be 0")
    fx, fy, cx, cy = (number(path, pinhole, key) for key in ("fx", "fy", "cx", "cy"))
    radial = numbers(path, lens, "radial", {1, 2, 3})
    k1, k2, k3 = radial + [0.0] * (3 - len(radial))
    distortion = [k1, k2, number(path, lens, "t1"), number(path, lens, "t2"), k3]
    size = image_size(path, [number(path, pinhole, key) for key in ("width", "height")])
    return make_camera(path, size, (fx, fy, cx, cy), distortion, "pinhole")


def write(rig: Rig, options: Options) -> dict[str, str]:
    pose = rig.left_from_right
    x, y, z = floats(pose.translation_m * round(1.0 / options.unit_m))
    table = {
        "model": "stereo_camera",
        "left": _camera(rig.left),
        "right": _camera(rig.right),
        "rightToLeft": {"rotation": floats(pose.rotation), "x": x, "y": y, "z": z},
    }
    return {"stereo.yaml": dump_yaml(table)}


def _camera(camera: CameraModel) -> Table:
    if camera.lens == "fisheye":
        raise InputError("--to boofcv", "its fisheye lenses are of another model")
    k1, k2, p1, p2, *k3 = only_radial_tangential(camera, 5, "boofcv")
    fx, fy, cx, cy = intrinsics(camera)
    size = {"width": camera.width, "height": camera.height, "skew": 0.0}
    return {
        "model": MODEL,
        "pinhole": {"fx": fx, "fy": fy, "cx": cx, "cy": cy, **size},
        "radial_tangential": {"radial": [k1, k2, *k3], "t1": p1, "t2": p2},
    }
