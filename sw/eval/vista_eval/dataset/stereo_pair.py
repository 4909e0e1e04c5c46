"""Real stereo pairs with a measured disparity image beside them, and how a folder of them is split."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.errors import InputError
from vista.geometry import Calibration
from vista.sequence.image import check_container

from vista_eval.dataset.truth import SPLITS


@dataclass(frozen=True)
class TruthPair:
    """One rectified pair with its truth in pixels of the left image."""

    name: str
    split: str  # of SPLITS
    camera: Calibration
    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    disparity_px: NDArray[np.float32]  # (height, width), 0: not measured


def split_of(index: int) -> str:
    """The split of the pair at this place among the sorted names: dev at even ones, test at odd ones."""
    return SPLITS[index % 2]


def read_levels(path: Path) -> NDArray[np.uint16]:
    """A grey PNG or PGM of 8 or 16 bits as the levels that it stores. Raises InputError."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(path, (error.strerror or "cannot be read").lower()) from None
    check_container(path, data)
    levels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if levels is None or levels.ndim != 2 or levels.dtype not in (np.uint8, np.uint16):
        raise InputError(path, "not a grey image of 8 or 16 bits")
    return levels.astype(np.uint16)


def check_shape(path: Path, shape: tuple[int, ...], wanted: tuple[int, ...]) -> None:
    if shape != wanted:
        raise InputError(path, f"is {shape[1]}x{shape[0]} px, the left image is {wanted[1]}x{wanted[0]} px")
