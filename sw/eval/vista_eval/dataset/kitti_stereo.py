"""Folders in the layout of the KITTI 2012 stereo benchmark: image_0, image_1, disp_noc or disp_occ, calib.

`disp_noc/NAME.png` holds the LiDAR's disparities, 16 bits, 256 levels a pixel, 0 = none. Pairs without it are
left out, as are the second images of the benchmark (NNNNNN_11.png). A pair's camera is that of
`calib/NNNNNN.txt`; where that is missing, the published one of the day on which KITTI recorded images of that
size.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from vista.errors import InputError
from vista.geometry import Calibration
from vista.sequence.image import read_grey, read_size
from vista.sequence.kitti import read_calibration

from vista_eval.dataset.stereo_pair import TruthPair, check_shape, read_levels, split_of

TRUTH_FOLDERS = (
    "disp_noc",
    "disp_occ",
)  # the first that is there; LiDAR at occluded pixels is no stereo truth
LEVELS_PER_PX = 256.0
BASELINE_M = 0.53715
CAMERAS = {  # width, height -> focal length, principal point, all px
    (1242, 375): (721.5377, 609.5593, 172.854),
    (1224, 370): (707.0493, 604.0814, 180.5066),
    (1238, 374): (718.3351, 600.3891, 181.5122),
    (1226, 370): (707.0912, 601.8873, 183.1104),
    (1241, 376): (718.856, 607.1928, 185.2157),
}


@dataclass(frozen=True)
class PairFiles:
    name: str
    split: str
    left: Path
    right: Path
    truth: Path
    camera: Calibration


def find_pairs(folder: Path) -> list[PairFiles]:
    """Every pair with truth, in the order of their names. Raises InputError."""
    if not folder.is_dir():
        raise InputError(folder, "no such folder")
    truth_folder = next((folder / name for name in TRUTH_FOLDERS if (folder / name).is_dir()), None)
    if truth_folder is None:
        raise InputError(folder, f"holds neither {' nor '.join(TRUTH_FOLDERS)}: no KITTI stereo folder")
    truths = sorted(truth_folder.glob("*.png"))
    if not truths:
        raise InputError(truth_folder, "holds no disparity images NAME.png")
    return [_files(folder, truth, split_of(index)) for index, truth in enumerate(truths)]


def _files(folder: Path, truth: Path, split: str) -> PairFiles:
    left, right = (folder / side / truth.name for side in ("image_0", "image_1"))
    for image in (left, right):
        if not image.is_file():
            raise InputError(image, f"no such file: the image of {truth} is missing")
    size = read_size(left)
    calib = folder / "calib" / f"{truth.stem.split('_')[0]}.txt"
    camera = _read_camera(calib, size) if calib.is_file() else _published_camera(left, calib, size)
    return PairFiles(truth.stem, split, left, right, truth, camera)


def _read_camera(path: Path, size: tuple[int, int]) -> Calibration:
    raw = read_calibration(path, size)
    K = raw.left.matrix
    return Calibration(*size, K[0, 0], K[0, 2], K[1, 2], -float(raw.right_from_left.translation_m[0]))


def _published_camera(left: Path, calib: Path, size: tuple[int, int]) -> Calibration:
    if size not in CAMERAS:
        raise InputError(left, f"KITTI published no camera of {size[0]}x{size[1]} px, and {calib} is missing")
    return Calibration(*size, *CAMERAS[size], BASELINE_M)


def read_pair(files: PairFiles) -> TruthPair:
    """Raises InputError for what is damaged or of another size."""
    left, right, levels = read_grey(files.left), read_grey(files.right), read_levels(files.truth)
    check_shape(files.right, right.shape, left.shape)
    check_shape(files.truth, levels.shape, left.shape)
    disparity_px = (levels / LEVELS_PER_PX).astype(np.float32)
    return TruthPair(files.name, files.split, files.camera, left, right, disparity_px)
