"""V4L2 in vista-fly, with cameras that a preloaded library makes of files (fake_camera.c).

What the images are is told by valid_fraction, which follows from a pair alone."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from flight_on_disk import HEIGHT, WIDTH
from fly_process import SANITIZED, VISTA_FLY, fly, prepare
from fly_shared import Flight, flying
from numpy.typing import NDArray

pytestmark = [
    pytest.mark.native,
    pytest.mark.slow,
    pytest.mark.skipif(SANITIZED, reason="preloading comes before AddressSanitizer"),
    pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed"),
]

READS_JPEG = b"JPEG" in VISTA_FLY.read_bytes()
CAPTURE, STREAMING = 0x1, 0x04000000
Image = NDArray[np.uint8]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("library") / "fake_camera.so"
    source = Path(__file__).with_name("fake_camera.c")
    command = ["gcc", "-std=c17", "-Wall", "-Wextra", "-Werror", "-O1", "-fPIC", "-shared"]
    subprocess.run([*command, str(source), "-o", str(target), "-ldl"], check=True, timeout=60)
    return target


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Flight:
    return Flight(tmp_path_factory.mktemp("camera"), 8)


@pytest.fixture(scope="module")
def fractions(flight: Flight) -> list[float]:
    """The fraction of each frame."""
    folder = flight.lines.parent
    played = prepare(folder / "played", folder / "flight")
    run = fly(*played, "--all-frames", "--out", "-")
    found = [json.loads(line)["valid_fraction"] for line in run.stdout.splitlines()]
    assert len(set(found)) == len(found) == 8
    return found


def grey(image: Image) -> Image:
    return image


def nv12(image: Image) -> Image:
    """A picture with planes of colour behind the luma."""
    return np.vstack([image, np.full((image.shape[0] // 2, image.shape[1]), 77, np.uint8)])


def yuyv(image: Image) -> Image:
    return np.stack([image, np.full_like(image, 77)], -1).reshape(len(image), -1)


def uyvy(image: Image) -> Image:
    return np.stack([np.full_like(image, 77), image], -1).reshape(len(image), -1)


def padded(image: Image) -> Image:
    return np.pad(image, ((0, 0), (0, 32)), constant_values=9)


def interleaved(image: Image) -> Image:
    """A picture of both views side by side."""
    left, right = image[:, :WIDTH], image[:, WIDTH:]
    return np.stack([left, right], -1).reshape(len(image), -1)


FORMATS: dict[str, tuple[str, Callable[[Image], Image]]] = {
    "grey": ("GREY", grey),
    "padded rows": ("GREY", padded),
    "nv12": ("NV12", nv12),
    "yu12": ("YU12", nv12),
    "yuyv": ("YUYV", yuyv),
    "uyvy": ("UYVY", uyvy),
}


def cameras(
    folder: Path, flight: Flight, library: Path, kind: str, both: bool
) -> tuple[list[Path], dict[str, str]]:
    """Files, and what the library is told of them."""
    fourcc, pack = ("Y8I ", interleaved) if kind == "y8i" else FORMATS[kind]
    width = 2 * WIDTH if both and kind != "y8i" else WIDTH
    views: list[list[Image]] = [[], []]
    for frame in flight.frames:
        if both:
            views[0].append(pack(np.hstack([frame.left, frame.right])))
        else:
            views[0].append(pack(frame.left))
            views[1].append(pack(frame.right))
    files = [folder / f"fake-video{k}" for k in range(1 if both else 2)]
    for file, pictures in zip(files, views, strict=False):
        file.write_bytes(b"".join(picture.tobytes() for picture in pictures))
    told = {"FORMAT": fourcc, "BYTES": views[0][0].nbytes, "HZ": 10, "WIDTH": width, "HEIGHT": HEIGHT}
    told |= {"STRIDE": views[0][0].shape[1], "CAPABILITIES": CAPTURE | STREAMING}
    return files, {"LD_PRELOAD": str(library)} | {f"FAKE_{name}": str(value) for name, value in told.items()}


def seen(flight: Flight, fractions: list[float]) -> list[int]:
    """The number of the frame that each line shows; a pair of two moments has none."""
    return [fractions.index(line["valid_fraction"]) for line in flight.read()]


@pytest.mark.parametrize(
    "kind, both", [(kind, both) for kind in FORMATS for both in (False, True)] + [("y8i", True)]
)
def test_formats(
    tmp_path: Path, flight: Flight, fractions: list[float], library: Path, kind: str, both: bool
) -> None:
    files, told = cameras(tmp_path, flight, library, kind, both)
    flight.lines.unlink(missing_ok=True)
    with flying("--rig", flight.rig, "--camera", *files, "--out", flight.lines, **told) as process:
        flight.wait(5)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    numbers = seen(flight, fractions)
    assert all(0 < (b - a) % 8 <= 4 for a, b in pairwise(numbers)), err
    times_ns = np.diff([line["t_ns"] for line in flight.read()])
    assert (
        np.abs(times_ns % 100_000_000 - 50_000_000) > 49_000_000
    ).all()  # whole periods, of the driver's times


JPEG_BYTES = 1 << 18


def compressed(image: Image) -> Image:
    """JPEG of grey pictures in a space of fixed size, as a driver's buffer is."""
    data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 90])[1]
    return np.pad(data.ravel(), (0, JPEG_BYTES - data.size)).reshape(1, -1)


def decompressed(image: Image) -> Image:
    return np.asarray(cv2.imdecode(compressed(image).ravel(), cv2.IMREAD_GRAYSCALE), np.uint8)


@pytest.mark.parametrize("both", [False, True])
@pytest.mark.skipif(not READS_JPEG, reason="this vista-fly is built without libjpeg")
def test_motion_jpeg(
    tmp_path: Path, flight: Flight, library: Path, both: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A camera with its full rate in MJPG alone is as good as one that delivers the decoded pictures."""
    shown = {}
    for kind, pack in {"decoded": decompressed, "compressed": compressed}.items():
        monkeypatch.setitem(FORMATS, kind, ("GREY", pack))
        (tmp_path / kind).mkdir()
        files, told = cameras(tmp_path / kind, flight, library, kind, both)
        told |= {"FAKE_SLOW_HZ": "5"} if kind == "compressed" else {}
        flight.lines.unlink(missing_ok=True)
        with flying("--rig", flight.rig, "--camera", *files, "--out", flight.lines, **told):
            lines = flight.wait(18)
        shown[kind] = {line["valid_fraction"] for line in lines}
    assert len(shown["decoded"]) == len(flight.frames)
    assert shown["compressed"] == shown["decoded"]


def test_a_camera_that_is_unplugged(
    tmp_path: Path, flight: Flight, fractions: list[float], library: Path
) -> None:
    """It is opened again, also after it has delivered nothing for a while."""
    files, told = cameras(tmp_path, flight, library, "grey", True)
    flight.lines.unlink(missing_ok=True)
    with flying("--rig", flight.rig, "--camera", *files, "--out", flight.lines, **told) as process:
        assert process.stderr is not None
        for suffix in (".gone", ".mute"):
            flight.wait(len(flight.read()) + 2)
            sign = files[0].with_name(files[0].name + suffix)
            sign.touch()
            assert "lost; trying to open it again" in process.stderr.readline()
            sign.unlink()
            assert "back" in process.stderr.readline()
            before = len(flight.read())
            flight.wait(before + 3)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
    assert len(seen(flight, fractions)) >= 10
    assert process.returncode == 130


def test_pictures_that_are_too_far_apart_are_no_pair(tmp_path: Path, flight: Flight, library: Path) -> None:
    """The second camera is opened late, so that its ticks are others."""
    files, told = cameras(tmp_path, flight, library, "grey", False)
    told["FAKE_HZ"] = "7"
    flight.lines.unlink(missing_ok=True)
    arguments = ["--rig", flight.rig, "--camera", *files, "--out", flight.lines, "--pair-tolerance-ms", 2]
    with flying(*arguments, **told) as process:
        flight.wait(2)
        gone = files[1].with_name(files[1].name + ".gone")
        gone.touch()
        time.sleep(1.0)
        before = len(flight.read())
        time.sleep(1.0)
        assert len(flight.read()) == before
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    assert int(err.split(" dropped")[0].split()[-1]) >= 3


@pytest.mark.parametrize(
    "changed, text",
    [
        ({"WIDTH": "1000"}, f"delivers 1000x{HEIGHT} px, the rig needs {WIDTH}x{HEIGHT}"),
        ({"FORMAT": "RGB3"}, "offers neither GREY"),
        ({"CAPABILITIES": "1"}, "is no camera that streams"),
        ({"BYTES": "100"}, "has buffers that hold no picture"),
    ],
)
def test_cameras_that_do_not_do(
    tmp_path: Path, flight: Flight, library: Path, changed: dict[str, str], text: str
) -> None:
    files, told = cameras(tmp_path, flight, library, "grey", False)
    told |= {f"FAKE_{name}": value for name, value in changed.items()}
    run = fly("--rig", flight.rig, "--camera", *files, **told)
    assert (run.returncode, run.stderr.count("\n")) == (2, 1)
    assert text in run.stderr


@pytest.mark.parametrize("device, text", [("/dev/null", "no camera of V4L2"), ("/nowhere", "no such file")])
def test_what_is_no_camera(flight: Flight, device: str, text: str) -> None:
    run = fly("--rig", flight.rig, "--camera", device)
    assert (run.returncode, run.stderr.count("\n")) == (2, 1)
    assert text in run.stderr
