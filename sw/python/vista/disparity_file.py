"""Disparity images in files. In memory they are the engine's words: int16, 1/16 px, negative where invalid.

.png  KITTI: 16 bits, round(256 d), 0 = invalid; a valid d = 0 is written as 1
.pfm  float px, rows bottom-up, +inf = invalid
.npy  the words themselves
"""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.engine import SCALE
from vista.errors import InputError
from vista.output import write_atomically

Words = NDArray[np.int16]
FORMATS = (".png", ".pfm", ".npy")


def check_format(path: Path, also: tuple[str, ...] = ()) -> None:
    """also: further endings that the caller knows. Raises InputError."""
    known = (*FORMATS, *also)
    if path.suffix.lower() not in known:
        raise InputError(path, f"disparity files end in {', '.join(known)}")


def write_disparity(path: Path, words: Words) -> None:
    """Writes the format that the name ends in; the file is whole or absent. Raises InputError."""
    check_format(path)
    encode = {".png": _encode_png, ".pfm": _encode_pfm, ".npy": _encode_npy}[path.suffix.lower()]
    write_atomically(path, encode(words))


def _encode_png(words: Words) -> bytes:
    levels = words.astype(np.int32) * (256 // SCALE)
    if levels.max(initial=0) > 0xFFFF:
        raise ValueError("a disparity of 256 px or more does not fit the KITTI format")
    png = np.where(words < 0, 0, np.maximum(levels, 1)).astype(np.uint16)
    return cv2.imencode(".png", png)[1].tobytes()


def _encode_pfm(words: Words) -> bytes:
    disparity_px = np.where(words < 0, np.inf, words / SCALE).astype("<f4")
    height, width = words.shape
    return f"Pf\n{width} {height}\n-1.0\n".encode() + disparity_px[::-1].tobytes()


def _encode_npy(words: Words) -> bytes:
    stream = io.BytesIO()
    np.save(stream, words.astype("<i2", copy=False))
    return stream.getvalue()
