"""vista-fly's decoder of compressed pictures beside OpenCV's: equal luma, and no damaged picture passes."""

from __future__ import annotations

import io
import math
import os
import shutil
import struct
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from random_seed import seeded
from shared_data import REPOSITORY

FLY = REPOSITORY / "sw" / "apps" / "fly"
ROOT = REPOSITORY / "build" / "tools" / "jpeg" / "root"
HERE = [path for root in (ROOT, Path("/")) for path in root.glob("usr/lib/*/libjpeg.a")]
pytestmark = [
    pytest.mark.skipif(not HERE, reason="libjpeg is not installed, and could not be fetched"),
    pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed"),
]
Image = NDArray[np.uint8]


@dataclass(frozen=True)
class Jpeg:
    """A picture as a camera delivers it."""

    data: bytes
    width: int
    height: int
    views: int = 1


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("jpeg") / "pictures"
    headers = HERE[0].parents[2] / "include"
    command = ["gcc", "-std=c17", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    command += ["-Wl,--wrap=malloc", "-DVISTA_FLY_HAS_JPEG", f"-I{FLY}", f"-isystem{headers}"]
    command += [f"-isystem{headers / HERE[0].parent.name}", str(Path(__file__).with_name("jpeg_pictures.c"))]
    subprocess.run([*command, str(FLY / "jpeg.c"), str(HERE[0]), "-o", str(target)], check=True, timeout=60)
    return target


def decode(program: Path, pictures: Sequence[Jpeg]) -> list[tuple[Image, Image] | None]:
    """Both views of each; None: no whole picture."""
    heads = [struct.pack("<4i", p.width, p.height, p.views, len(p.data)) for p in pictures]
    sent = b"".join(head + p.data for head, p in zip(heads, pictures, strict=True))
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    run = subprocess.run([str(program)], input=sent, capture_output=True, timeout=120, env=environment)
    assert run.returncode == 0, run.stderr.decode()
    answer, found = io.BytesIO(run.stdout), []
    for p in pictures:
        whole, allocations = struct.unpack("<2i", answer.read(8))
        assert allocations == 0
        shape = (2, p.height, p.width // p.views)
        views = np.frombuffer(answer.read(math.prod(shape)), np.uint8).reshape(shape)
        found.append((views[0], views[1]) if whole else None)
    return found


def picture(width: int, height: int, seed: int = 0) -> Image:
    """Waves in colour with noise."""
    v, u = np.mgrid[:height, :width]
    grey = 120 + 60 * np.sin(u / 9.0) * np.cos(v / 7.0)
    noise = seeded(seed).normal(0, 8, (height, width, 3))
    return np.clip(grey[..., None] * [1.0, 0.8, 0.6] + noise, 0, 255).astype(np.uint8)


def encoded(image: Image, *options: int) -> bytes:
    return bytes(cv2.imencode(".jpg", image, options)[1])


@pytest.mark.slow
@pytest.mark.parametrize("width, height", [(640, 480), (1280, 480), (34, 19), (16, 1), (2560, 720)])
def test_luma_is_that_of_opencv(program: Path, width: int, height: int) -> None:
    """Whatever the sampling of the colours."""
    option = cv2.IMWRITE_JPEG_SAMPLING_FACTOR
    files = [
        encoded(picture(width, height), option, value) for value in (0x411111, 0x421111, 0x221111, 0x111111)
    ]
    found = decode(program, [Jpeg(data, width, height, views=2) for data in files])
    for data, views in zip(files, found, strict=True):
        assert views is not None
        expected = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_GRAYSCALE)
        np.testing.assert_array_equal(np.hstack(views), expected)


def test_grey_and_without_tables(program: Path) -> None:
    """Cameras leave out the standard Huffman tables."""
    data = encoded(np.ascontiguousarray(picture(64, 48)[..., 0]))
    stripped = without_segments(data, 0xC4)
    assert len(stripped) < len(data)
    whole, bare = decode(program, [Jpeg(data, 64, 48), Jpeg(stripped, 64, 48)])
    assert whole is not None and bare is not None
    np.testing.assert_array_equal(whole[0], bare[0])
    assert (whole[1] == 7).all()


def without_segments(data: bytes, marker: int) -> bytes:
    kept, at = bytearray(data[:2]), 2
    while data[at + 1] != 0xDA:
        length = 2 + int.from_bytes(data[at + 2 : at + 4])
        if data[at + 1] != marker:
            kept += data[at : at + length]
        at += length
    return bytes(kept + data[at:])


def test_what_is_no_whole_picture(program: Path) -> None:
    data = encoded(picture(320, 240))
    (padded,) = decode(program, [Jpeg(data + bytes(1000), 320, 240)])
    assert padded is not None  # a driver's buffer is larger than the picture
    wrong = [Jpeg(data, 320, 200), Jpeg(data, 160, 240), Jpeg(b"", 320, 240), Jpeg(bytes(5000), 320, 240)]
    wrong += [Jpeg(data[:length], 320, 240) for length in range(2, len(data) - 2, len(data) // 40)]
    progressive = encoded(picture(1280, 720), cv2.IMWRITE_JPEG_PROGRESSIVE, 1)
    wrong += [Jpeg(progressive, 1280, 720)]  # which would need memory for the whole picture
    assert decode(program, wrong) == [None] * len(wrong)


@pytest.mark.slow
def test_damaged_bytes_do_no_harm(program: Path) -> None:
    """AddressSanitizer and UndefinedBehaviorSanitizer watch."""
    data, rng = encoded(picture(160, 120)), seeded(1)
    pictures = []
    for _ in range(2000):
        damaged = bytearray(data)
        for place in rng.integers(0, len(data), rng.integers(1, 6)):
            damaged[place] = rng.integers(0, 256)
        pictures.append(Jpeg(bytes(damaged), 160, 120))
    found = decode(program, pictures)
    assert any(views is None for views in found)
