"""Reads images as 8-bit grey.

A truncated file is refused. OpenCV alone would return the rows it has and grey or black below them, so the
container is walked to its end first: PNG chunk by chunk with every CRC, JPEG marker by marker, PGM and PPM by
their size.
"""

from __future__ import annotations

import re
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError

EXTENSIONS = (".png", ".jpg", ".jpeg", ".pgm", ".ppm")
MAX_SIDE_PX = 16384  # a header may ask for more memory than the machine has


@dataclass(frozen=True)
class Header:
    width: int
    height: int
    bits: int  # per channel


def read_grey(path: Path) -> NDArray[np.uint8]:
    """HxW uint8. Colour turns grey by ITU-R BT.601 (0.299 R + 0.587 G + 0.114 B); alpha is ignored.

    Raises InputError: missing, truncated, damaged, not PNG/JPEG/PGM/PPM, above 8 bits a channel, or with a
    side above MAX_SIDE_PX. 16-bit images are not scaled: which bits hold the picture is not in the file.
    """
    return decode_grey(path, _read_bytes(path))


def decode_grey(path: Path | str, data: bytes) -> NDArray[np.uint8]:
    """Does what read_grey does, with the content of a file; path: for messages."""
    header = check_container(path, data)
    if header.bits > 8:
        raise InputError(path, f"{header.bits} bits a channel; convert the image to 8 bits first")
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        image = None
    if image is None or image.dtype != np.uint8 or image.shape[:2] != (header.height, header.width):
        raise InputError(path, "damaged image")
    if image.ndim == 2:
        return np.asarray(image, np.uint8)
    code = cv2.COLOR_BGRA2GRAY if image.shape[2] == 4 else cv2.COLOR_BGR2GRAY
    return np.asarray(cv2.cvtColor(image, code), np.uint8)


def read_size(path: Path) -> tuple[int, int]:
    """(width, height) of a whole image, checked like read_grey but not decoded."""
    header = check_container(path, _read_bytes(path))
    return header.width, header.height


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise InputError(path, "no such file") from None
    except OSError as error:
        raise InputError(path, (error.strerror or "cannot be read").lower()) from None


def check_container(path: Path | str, data: bytes) -> Header:
    """Header of a whole PNG, JPEG, PGM or PPM; raises InputError for anything else."""
    if not data:
        raise InputError(path, "empty file")
    if data.startswith(PNG_SIGNATURE):
        header = _check_png(path, data)
    elif data.startswith(b"\xff\xd8"):
        header = _check_jpeg(path, data)
    elif data[:2] in (b"P5", b"P6"):
        header = _check_pnm(path, data)
    else:
        raise InputError(path, "not a PNG, JPEG, PGM or PPM image")
    if header.width < 1 or header.height < 1 or max(header.width, header.height) > MAX_SIDE_PX:
        raise InputError(
            path, f"image of {header.width}x{header.height}; sides of 1 to {MAX_SIDE_PX} are read"
        )
    return header


PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def _check_png(path: Path | str, data: bytes) -> Header:
    """PNG specification, section 5: length, type, data, CRC over type and data; IHDR first, IEND last."""
    view = memoryview(data)
    header = None
    at = len(PNG_SIGNATURE)
    while at + 12 <= len(data):
        (length,) = struct.unpack_from(">I", data, at)
        end = at + 12 + length
        if end > len(data):
            break
        kind = data[at + 4 : at + 8]
        (crc,) = struct.unpack_from(">I", data, end - 4)
        if zlib.crc32(view[at + 4 : end - 4]) != crc:
            raise InputError(path, f"damaged image: checksum of PNG chunk {kind.decode('ascii', 'replace')}")
        if header is None:
            if kind != b"IHDR" or length != 13:
                raise InputError(path, "damaged image: PNG without IHDR")
            header = Header(*struct.unpack_from(">IIB", data, at + 8))
        if kind == b"IEND":
            return header
        at = end
    raise InputError(path, "truncated image")


JPEG_FRAME_HEADERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}  # SOF0..15 without DHT, JPG, DAC
JPEG_SCAN_END = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")  # a marker that is no stuffing, fill or restart


def _check_jpeg(path: Path | str, data: bytes) -> Header:
    """ITU-T T.81, annex B: marker segments, entropy-coded data after each SOS, EOI last."""
    header = None
    at = 2
    while at + 4 <= len(data):
        if data[at] != 0xFF:
            raise InputError(path, "damaged image: JPEG marker expected")
        marker = data[at + 1]
        if marker == 0xFF:
            at += 1
            continue
        (length,) = struct.unpack_from(">H", data, at + 2)
        if marker in JPEG_FRAME_HEADERS and at + 9 <= len(data):
            bits, height, width = struct.unpack_from(">BHH", data, at + 4)
            header = Header(width, height, bits)
        at += 2 + length
        if marker == 0xDA:
            scan_end = JPEG_SCAN_END.search(data, at)
            if scan_end is None:
                break
            at = scan_end.start()
            if data[at + 1] == 0xD9 and header is not None:
                return header
    raise InputError(path, "truncated image")


PNM_HEADER = re.compile(rb"P([56])(?:\s|#[^\n]*\n)+(\d+)(?:\s|#[^\n]*\n)+(\d+)(?:\s|#[^\n]*\n)+(\d+)\s")


def _check_pnm(path: Path | str, data: bytes) -> Header:
    """Netpbm's pgm(5) and ppm(5), binary."""
    match = PNM_HEADER.match(data[:4096])
    if match is None:
        raise InputError(path, "damaged image: PGM or PPM header")
    kind, width, height, maximum = (int(group) for group in match.groups())
    bits = 8 if maximum <= 255 else 16
    channels = 3 if kind == 6 else 1
    if len(data) - match.end() < width * height * channels * (bits // 8):
        raise InputError(path, "truncated image")
    return Header(width, height, bits)
