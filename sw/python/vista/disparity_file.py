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

from vista.engine import INVALID, SCALE
from vista.errors import InputError
from vista.output import write_atomically
from vista.sequence.image import check_container

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


def read_disparity(path: Path) -> Words:
    """Any of the formats, rounded to 1/16 px; every invalid pixel becomes INVALID. Raises InputError."""
    check_format(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(path, (error.strerror or "cannot be read").lower()) from None
    decode = {".png": _decode_png, ".pfm": _decode_pfm, ".npy": _decode_npy}[path.suffix.lower()]
    return decode(path, data)


def _encode_png(words: Words) -> bytes:
    levels = words.astype(np.int32) * (256 // SCALE)
    if levels.max(initial=0) > 0xFFFF:
        raise ValueError("a disparity of 256 px or more does not fit the KITTI format")
    png = np.where(words < 0, 0, np.maximum(levels, 1)).astype(np.uint16)
    return cv2.imencode(".png", png)[1].tobytes()


def _decode_png(path: Path, data: bytes) -> Words:
    check_container(path, data)  # OpenCV would return the rows that a truncated file has
    levels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if levels is None or levels.dtype != np.uint16 or levels.ndim != 2:
        raise InputError(path, "not a 16-bit grey PNG")
    return _words_from_px(levels.astype(np.float64) / 256.0, levels > 0)


def _encode_pfm(words: Words) -> bytes:
    disparity_px = np.where(words < 0, np.inf, words / SCALE).astype("<f4")
    height, width = words.shape
    return f"Pf\n{width} {height}\n-1.0\n".encode() + disparity_px[::-1].tobytes()


def _decode_pfm(path: Path, data: bytes) -> Words:
    try:
        kind, size, scale, pixels = data.split(b"\n", 3)
        width, height = (int(number) for number in size.split())
        byte_order = "<" if float(scale) < 0.0 else ">"
        if kind.strip() != b"Pf" or width < 1 or height < 1 or len(pixels) != 4 * width * height:
            raise ValueError
    except ValueError:
        raise InputError(path, "not a grey PFM, or truncated") from None
    disparity_px = np.frombuffer(pixels, byte_order + "f4").reshape(height, width)[::-1]
    return _words_from_px(disparity_px, np.isfinite(disparity_px))


def _encode_npy(words: Words) -> bytes:
    stream = io.BytesIO()
    np.save(stream, words.astype("<i2", copy=False))
    return stream.getvalue()


def _decode_npy(path: Path, data: bytes) -> Words:
    try:
        words = np.load(io.BytesIO(data), allow_pickle=False)
    except (ValueError, EOFError):
        raise InputError(path, "not an npy file, or truncated") from None
    if words.dtype != np.int16 or words.ndim != 2:
        raise InputError(path, "not an int16 image")
    return np.where(words < 0, INVALID, words).astype(np.int16)


def _words_from_px(disparity_px: NDArray[np.floating], valid: NDArray[np.bool_]) -> Words:
    words = np.full(disparity_px.shape, INVALID, np.int16)
    words[valid] = np.clip(np.rint(disparity_px[valid] * SCALE), 0, np.iinfo(np.int16).max)
    return words
