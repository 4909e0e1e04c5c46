"""KITTI stereo 2012 and 2015, the folder training or testing: unrelated pairs, each with a calibration.

image_0, image_1 (2012, grey), colored_0, colored_1 (2012, colour) or image_2, image_3 (2015), of which the
reference frames NNNNNN_10.png are read; calib/NNNNNN.txt or calib_cam_to_cam/NNNNNN.txt.

A sequence has one calibration: pairs with another one, or of another size, than the first are left out.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from vista.errors import InputError
from vista.geometry import Pose, RawCalibration
from vista.sequence.image import read_size
from vista.sequence.kitti import read_calibration
from vista.sequence.options import Options
from vista.sequence.pairs import FRAME_PERIOD_NS, read_calibration_file
from vista.sequence.types import FrameFiles, Sequence

NAME = "KITTI stereo"
TAKES = frozenset({"calibration"})
REFERENCE = "_10.png"  # the pairs before and after it are _00 to _09 and _11 to _20
# Folders of the left and the right images, and their projections in calib and in calib_cam_to_cam.
CAMERAS = {
    ("image_0", "image_1"): ("P0", "P1", "P_rect_00", "P_rect_01"),
    ("colored_0", "colored_1"): ("P2", "P3", "P_rect_02", "P_rect_03"),
    ("image_2", "image_3"): ("P2", "P3", "P_rect_02", "P_rect_03"),
}


def recognises(path: Path) -> bool:
    return any(_reference_frames(path / left) for left, _ in CAMERAS)


def open_source(folder: Path, options: Options) -> Sequence:
    left, right = next(sides for sides in CAMERAS if _reference_frames(folder / sides[0]))
    lefts = _reference_frames(folder / left)
    for path in lefts:
        if not (folder / right / path.name).is_file():
            raise InputError(folder / right / path.name, "no such file: the right image is missing")
    if options.first_frame >= len(lefts):
        raise InputError("--frames", f"selects none; the folder has frames 0 to {len(lefts) - 1}")
    first = lefts[options.first_frame]
    of_first = _calibration(folder, first, options, (left, right))
    chosen = [
        FrameFiles(index, index * FRAME_PERIOD_NS, path, folder / right / path.name, None)
        for index, path in enumerate(lefts)
        if _equal(_calibration(folder, path, options, (left, right)), of_first)
    ]
    others = len(lefts) - len(chosen)
    note = (
        f"{others} of {len(lefts)} pairs have another size or calibration than {first.name}, and are left out"
    )
    hint = "; --frames N: takes that of N"
    name = f"{folder.resolve().parent.name}/{folder.resolve().name}"
    notes = (note + hint,) * (others > 0)
    return Sequence(name, NAME, of_first, tuple(chosen), None, notes, stills=True)


def _reference_frames(folder: Path) -> list[Path]:
    return (
        sorted(path for path in folder.iterdir() if path.name.endswith(REFERENCE)) if folder.is_dir() else []
    )


def _calibration(folder: Path, image: Path, options: Options, sides: tuple[str, str]) -> RawCalibration:
    size = read_size(image)
    if options.calibration is not None:
        return read_calibration_file(options.calibration, size).calibration
    number = image.name.removesuffix(REFERENCE)
    path, rectified = folder / "calib" / f"{number}.txt", CAMERAS[sides][:2]
    if not path.exists() and (folder / "calib_cam_to_cam").is_dir():
        path, rectified = folder / "calib_cam_to_cam" / f"{number}.txt", CAMERAS[sides][2:]
    if not path.exists():
        raise InputError(path, "no such file; give --calibration")
    calibration = read_calibration(path, size, (rectified[0], rectified[1]))
    # The images are rectified; P has a few mm beside the x axis, which the development kit ignores, too.
    baseline_m = -float(calibration.right_from_left.translation_m[0])
    motion = Pose(np.eye(3), np.array([-baseline_m, 0.0, 0.0]))
    return dataclasses.replace(calibration, right_from_left=motion)


def _equal(first: RawCalibration, second: RawCalibration) -> bool:
    def numbers(raw: RawCalibration) -> list[float]:
        left, right = raw.left, raw.right
        sizes = [left.width, left.height]
        return [*sizes, *left.matrix.flat, *right.matrix.flat, *raw.right_from_left.translation_m]

    return numbers(first) == numbers(second)
