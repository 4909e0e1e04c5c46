"""Indoor pairs with dense truth: Middlebury's tsukuba, venus, teddy and cones, and scikit-image's Motorcycle.

FOLDER holds a folder a scene, or is one itself. A scene is known by the names of its files:

    im2.EXT, im6.EXT, disp2.pgm (8 levels a pixel) or disp2.png (4 levels)           Middlebury 2001, 2003
    scene1.row3.col3.ppm, scene1.row3.col4.ppm, truedisp.row3.col3.pgm (16 levels)   tsukuba, Middlebury 2001
    motorcycle_left.png, motorcycle_right.png, motorcycle_disp.npz                   Middlebury 2014

Middlebury published no calibration of the former; the host needs one, so a focal length of 1.2 image widths
and a baseline of 0.16 m are assumed, which put the things 1.5 to 20 m away. The Motorcycle's is published.
Its principal points differ by 31 px and its disparities exceed those of the shipped engine, so it is read at
half size, with the right image shifted by whole pixels until disparity is inverse to depth.
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.errors import InputError
from vista.geometry import Calibration
from vista.sequence.image import read_grey

from vista_eval.dataset.stereo_pair import TruthPair, check_shape, read_levels, split_of

FOCAL_PER_WIDTH, BASELINE_M = 1.2, 0.16  # assumed
LAYOUTS = (  # left, right, truth, levels a pixel
    ("im2.ppm", "im6.ppm", "disp2.pgm", 8.0),
    ("im2.png", "im6.png", "disp2.png", 4.0),
    ("scene1.row3.col3.ppm", "scene1.row3.col4.ppm", "truedisp.row3.col3.pgm", 16.0),
)
MOTORCYCLE = ("motorcycle_left.png", "motorcycle_right.png", "motorcycle_disp.npz")
MOTORCYCLE_CAMERA = Calibration(741, 500, 994.978, 311.193, 254.877, 0.193001)
MOTORCYCLE_OFFSET_PX = 31.086  # depth = focal length * baseline / (disparity + offset)


def find_scenes(folder: Path) -> list[tuple[Path, str]]:
    """(folder of a scene, group) in the order of their names. Raises InputError."""
    if not folder.is_dir():
        raise InputError(folder, "no such folder")
    candidates = [folder, *sorted(path for path in folder.iterdir() if path.is_dir())]
    found = [path for path in candidates if _layout(path) or (path / MOTORCYCLE[2]).is_file()]
    if not found:
        raise InputError(folder, "holds no stereo pairs with dense truth (Middlebury, Motorcycle)")
    return [(path, split_of(index)) for index, path in enumerate(found)]


def _layout(folder: Path) -> tuple[str, str, str, float] | None:
    return next((layout for layout in LAYOUTS if (folder / layout[2]).is_file()), None)


def read_scene(folder: Path, split: str) -> TruthPair:
    """Raises InputError."""
    layout = _layout(folder)
    if layout is None:
        return _read_motorcycle(folder, split)
    paths = [folder / name for name in layout[:3]]
    left, right, levels = read_grey(paths[0]), read_grey(paths[1]), read_levels(paths[2])
    check_shape(paths[1], right.shape, left.shape)
    check_shape(paths[2], levels.shape, left.shape)
    height, width = left.shape
    camera = Calibration(
        width, height, FOCAL_PER_WIDTH * width, (width - 1) / 2, (height - 1) / 2, BASELINE_M
    )
    return TruthPair(folder.name, split, camera, left, right, (levels / layout[3]).astype(np.float32))


def _read_motorcycle(folder: Path, split: str) -> TruthPair:
    left_path, right_path, truth_path = (folder / name for name in MOTORCYCLE)
    left, right, truth_px = read_grey(left_path), read_grey(right_path), _read_npz(truth_path)
    check_shape(right_path, right.shape, left.shape)
    check_shape(truth_path, truth_px.shape, left.shape)
    full = MOTORCYCLE_CAMERA
    check_shape(left_path, left.shape, (full.height, full.width))
    size = full.width // 2, full.height // 2
    scale_u, scale_v = size[0] / full.width, size[1] / full.height
    shift_px = round(MOTORCYCLE_OFFSET_PX * scale_u)
    left, right = (
        np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8) for image in (left, right)
    )
    shifted = np.empty_like(right)
    shifted[:, :-shift_px] = right[:, shift_px:]
    shifted[:, -shift_px:] = right[:, -1:]
    at = np.ix_(np.arange(size[1]) * full.height // size[1], np.arange(size[0]) * full.width // size[0])
    small_px = truth_px[at] * scale_u + shift_px
    camera = Calibration(
        *size,
        full.focal_px * scale_u,
        (full.cx + 0.5) * scale_u - 0.5,
        (full.cy + 0.5) * scale_v - 0.5,
        full.baseline_m,
    )
    truth = np.where(np.isfinite(small_px) & (truth_px[at] > 0.0), small_px, 0.0).astype(np.float32)
    return TruthPair(folder.name, split, camera, left, shifted, truth)


def _read_npz(path: Path) -> NDArray[np.float32]:
    try:
        with np.load(path, allow_pickle=False) as arrays:
            array = arrays[arrays.files[0]]
    except (OSError, ValueError, IndexError) as error:
        raise InputError(path, f"not an npz file: {error}") from None
    if array.ndim != 2 or not np.issubdtype(array.dtype, np.floating):
        raise InputError(path, "holds no disparity image")
    return array.astype(np.float32)
