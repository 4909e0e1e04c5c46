"""Every damage a sequence can have: InputError names the file, and the line where there is one."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from vista.errors import InputError
from vista.rectify import Rectifier
from vista.sequence import open_sequence, read_grey

edit = partial(cases.edit, count=1)


def write(name: str, content: str | bytes) -> cases.Damage:
    data = content.encode() if isinstance(content, str) else content
    return lambda root: (root / name).write_bytes(data)


def cut(name: str, fraction: float) -> cases.Damage:
    def damage(root: Path) -> None:
        data = (root / name).read_bytes()
        (root / name).write_bytes(data[: int(len(data) * fraction)])

    return damage


def image(name: str, pixels: np.ndarray) -> cases.Damage:
    return lambda root: cases.write_image(root / name, pixels)


SMALL = np.zeros((cases.HEIGHT, cases.WIDTH - 1), np.uint8)
DEEP = np.zeros((cases.HEIGHT, cases.WIDTH), np.uint16)
T0, T1, T2 = (cases.ASL_START_NS + i * cases.ASL_PERIOD_NS for i in range(3))
TRUTH = "mav0/state_groundtruth_estimate0/data.csv"
CAM1_SENSOR = "mav0/cam1/sensor.yaml"

ASL = {
    "no right sensor": (cases.remove(CAM1_SENSOR), r"cam1/sensor\.yaml: no such file"),
    "no right list": (cases.remove("mav0/cam1/data.csv"), r"cam1/data\.csv: no such file"),
    "no right image": (cases.remove(f"mav0/cam1/data/{T1}.png"), rf"cam1/data/{T1}\.png: no such file"),
    "no left image": (cases.remove(f"mav0/cam0/data/{T1}.png"), rf"cam0/data/{T1}\.png: no such file"),
    "right images of another time": (
        write("mav0/cam1/data.csv", f"{T1 + 20_000_000},{T1}.png\n"),
        r"cam1/data\.csv: no right image within 5 ms of any left one",
    ),
    "time goes back": (
        edit("mav0/cam0/data.csv", f"{T2},", f"{T0},"),
        r"cam0/data\.csv:4: time does not increase",
    ),
    "bad time": (edit("mav0/cam0/data.csv", f"{T1},", "soon,"), r"cam0/data\.csv:3: bad timestamp 'soon'"),
    "empty list": (
        write("mav0/cam0/data.csv", "#timestamp [ns],filename\n"),
        r"cam0/data\.csv: lists no images",
    ),
    "no file name": (write("mav0/cam0/data.csv", f"{T0}\n"), r"cam0/data\.csv:1: expected"),
    "NaN pose": (edit(TRUTH, ",0,0,", ",nan,0,"), r"estimate0/data\.csv:2: number is not finite: nan"),
    "infinite pose": (edit(TRUTH, ",0,0,", ",0,-inf,"), r"estimate0/data\.csv:2: number is not finite"),
    "bad pose": (edit(TRUTH, ",0,0,", ",0,x,"), r"estimate0/data\.csv:2: bad number 'x'"),
    "quaternion": (
        edit(TRUTH, ",1,0,0,0", ",1,0.1,0,0"),
        r"estimate0/data\.csv:2: quaternion of length 1\.005",
    ),
    "few columns": (edit(TRUTH, ",1,0,0,0", ""), r"estimate0/data\.csv:2: 4 columns"),
    "empty poses": (write(TRUTH, "#\n"), r"estimate0/data\.csv: holds no poses"),
    "poses of another day": (
        write(TRUTH, "1,0,0,0,1,0,0,0\n2,0,0,0,1,0,0,0\n"),
        r"data\.csv: covers .* none of the 4",
    ),
    "binary poses": (write(TRUTH, b"\xff\xfe\x00"), r"estimate0/data\.csv: not a text file"),
    "zero baseline": (
        edit(CAM1_SENSOR, str(cases.BASELINE_M), "0.0"),
        r"cam1/sensor\.yaml: baseline is 0 m",
    ),
    "negative baseline": (
        edit(CAM1_SENSOR, "0.25", "-0.25"),
        r"cam1/sensor\.yaml: .*not right of the left",
    ),
    "broken yaml": (
        write(CAM1_SENSOR, "%YAML:1.0\na: [1, 2\nb: {"),
        r"cam1/sensor\.yaml: not readable as YAML",
    ),
    "no intrinsics": (edit(CAM1_SENSOR, "intrinsics", "other"), r"sensor\.yaml: intrinsics is missing"),
    "NaN focal length": (
        edit(CAM1_SENSOR, "[120.0, 120.0", "[.nan, 120.0"),
        r"sensor\.yaml: intrinsics holds",
    ),
    "word for a number": (
        edit(CAM1_SENSOR, "[120.0, 120.0", "[x, 120.0"),
        r"sensor\.yaml: intrinsics holds a bad",
    ),
    "zero focal length": (edit(CAM1_SENSOR, "[120.0", "[0.0"), r"sensor\.yaml: .*must be positive"),
    "other lens": (
        edit(CAM1_SENSOR, "radial-tangential", "fov"),
        r"sensor\.yaml: distortion_model is neither",
    ),
    "no rotation": (edit(CAM1_SENSOR, "[1.0", "[2.0"), r"sensor\.yaml: T_BS does not hold a rotation"),
    "T_BS too short": (
        edit(CAM1_SENSOR, "0.0, 0.0, 0.0, 1.0]", "1.0]"),
        r"T_BS holds 13 numbers, expected 16",
    ),
}

KITTI = {
    "no calibration": (cases.remove("sequences/00/calib.txt"), r"calib\.txt: no such file"),
    "no times": (cases.remove("sequences/00/times.txt"), r"times\.txt: no such file"),
    "no right image": (cases.remove("sequences/00/image_1/000002.png"), r"image_1/000002\.png: no such file"),
    "too few times": (write("sequences/00/times.txt", "0\n0.1\n"), r"times\.txt: 2 times for 4 frames"),
    "time stands still": (
        edit("sequences/00/times.txt", "2.0", "1.0"),
        r"times\.txt:3: time does not increase",
    ),
    "NaN time": (edit("sequences/00/times.txt", "2.0", "nan #"), r"times\.txt:3: bad number"),
    "negative time": (edit("sequences/00/times.txt", "0.0", "-1.0"), r"times\.txt:1: time out of range"),
    "NaN pose": (edit("poses/00.txt", "0 1 2", "0 1 nan"), r"00\.txt:3: number is not finite: nan"),
    "no rotation": (edit("poses/00.txt", "1 0 0", "1 1 0"), r"00\.txt:1: does not hold a rotation"),
    "short pose": (edit("poses/00.txt", "1 0 0 0", "1 0 0"), r"00\.txt:1: 11 numbers, expected 12"),
    "too few poses": (write("poses/00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"), r"00\.txt: 1 poses for 4 frames"),
    "no P1": (edit("sequences/00/calib.txt", "P1", "P2"), r"calib\.txt: P1 is missing"),
    "zero baseline": (edit("sequences/00/calib.txt", "-30.0", "0.0"), r"calib\.txt: baseline is 0 m"),
    "negative baseline": (
        edit("sequences/00/calib.txt", "-30.0", "30.0"),
        r"calib\.txt: baseline is -0\.25 m",
    ),
    "bad focal length": (
        edit("sequences/00/calib.txt", "120.0", "12o"),
        r"calib\.txt:1: bad number '12o'",
    ),
    "zero focal length": (
        edit("sequences/00/calib.txt", "120.0", "0"),
        r"calib\.txt:1: no projection matrix",
    ),
}

TILTED = cases.PAIR_CALIBRATION + "up_world = [0, 0, 2]\n"

PAIRS = {
    "no calibration": (cases.remove("calibration.toml"), r"calibration\.toml: no such file"),
    "no right image": (cases.remove("scene01_right.png"), r"scene01_right\.png: no such file"),
    "no left image": (cases.remove("scene01_left.png"), r"scene01_left\.png: no such file"),
    "not TOML": (write("calibration.toml", "focal_px ="), r"calibration\.toml: not readable as TOML"),
    "no focal length": (edit("calibration.toml", "focal_px = 120.0", ""), r"toml: focal_px is missing"),
    "NaN focal length": (edit("calibration.toml", "120.0", "nan"), r"focal_px is no finite number"),
    "text focal length": (edit("calibration.toml", "120.0", "'120'"), r"focal_px is no finite number"),
    "zero baseline": (
        edit("calibration.toml", "0.25", "0"),
        r"calibration\.toml: baseline_m is 0, must be pos",
    ),
    "negative baseline": (
        edit("calibration.toml", "0.25", "-0.25"),
        r"baseline_m is -0\.25, must be positive",
    ),
    "unknown key": (edit("calibration.toml", "cx", "cx_px"), r"calibration\.toml: unknown key cx_px"),
    "half a calibration": (write("calibration.toml", "[left]\n"), r"calibration\.toml: fx_px is missing"),
    "long up": (write("calibration.toml", TILTED), r"toml: up_world must have the length 1"),
    "poses without times": (write("poses.csv", "t_s\n"), r"times\.csv: no such file: poses\.csv needs"),
    "no column names": (write("times.csv", "scene00,0\n"), r"times\.csv:1: expected the columns name,t_"),
    "time of no pair": (write("times.csv", "name,t_s\nx,0\n"), r"times\.csv:2: x is no pair of the folder"),
    "a pair without a time": (write("times.csv", "name,t_s\nscene00,0\n"), r"has no time for scene01"),
    "two times": (write("times.csv", "name,t_s\nscene00,0\nscene00,1\n"), r":3: scene00 is given twice"),
    "one time": (write("times.csv", "name,t_s\nscene00,0\nscene01,0\n"), r":3: two pairs have the time 0 ns"),
    "NaN time": (write("times.csv", "name,t_s\nscene00,nan\n"), r"times\.csv:2: number is not finite"),
    "half a row": (write("times.csv", "name,t_s\nscene00\n"), r"times\.csv:2: 1 columns, expected 2"),
}

IMAGES = {
    "missing": (cases.remove("scene01_left.png"), "no such file"),
    "empty": (write("scene01_left.png", b""), "empty file"),
    "no image": (write("scene01_left.png", b"hello"), "not a PNG, JPEG, PGM or PPM image"),
    "half": (cut("scene01_left.png", 0.5), "truncated image"),
    "last bytes missing": (cut("scene01_left.png", 0.999), "truncated image"),
    "other size": (image("scene01_left.png", SMALL), r"image is 159x120, the calibration says 160x120"),
    "16 bits": (image("scene01_left.png", DEEP), r"16 bits a channel"),
}


LAYOUTS = {cases.make_asl: ASL, cases.make_kitti: KITTI, cases.make_pairs: PAIRS}


@pytest.mark.parametrize(
    ("make", "name"), [(make, name) for make, faults in LAYOUTS.items() for name in faults]
)
def test_damage_is_named(tmp_path: Path, make: Callable[[Path], Path], name: str) -> None:
    root = tmp_path / "pairs" if make is cases.make_pairs else tmp_path
    folder = make(root)
    damage, message = LAYOUTS[make][name]
    damage(root)
    with pytest.raises(InputError, match=message):
        Rectifier(open_sequence(folder).calibration)


@pytest.mark.parametrize("name", IMAGES)
def test_images(tmp_path: Path, name: str) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    sequence = open_sequence(folder)
    damage, message = IMAGES[name]
    damage(folder)
    with pytest.raises(InputError, match=rf"scene01_left\.png: .*{message}|scene01_left\.png: {message}"):
        sequence.read(sequence.frames[1])


@pytest.mark.parametrize("make", [cases.make_asl, cases.make_kitti, cases.make_pairs])
def test_messages_are_one_line(tmp_path: Path, make) -> None:
    folder = make(tmp_path / "s")
    next(p for p in sorted(folder.rglob("*")) if p.suffix in (".toml", ".txt", ".yaml")).write_text(
        "\n[\n\n="
    )
    with pytest.raises(InputError) as caught:
        open_sequence(folder)
    assert "\n" not in str(caught.value)


def test_folders_that_are_no_sequence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nowhere: no such file or folder"):
        open_sequence(tmp_path / "nowhere")
    with pytest.raises(InputError, match="empty folder"):
        open_sequence(tmp_path)
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="file: neither a folder nor a video nor a bag"):
        open_sequence(tmp_path / "file")
    with pytest.raises(InputError, match="no sequence recognised"):
        open_sequence(tmp_path)
    (tmp_path / "my films").mkdir()
    for name in ("b.mp4", "a.avi"):
        (tmp_path / "my films" / name).write_bytes(b"")
    with pytest.raises(
        InputError, match=r"holds 2 videos and no pictures; name one, such as '.*/my films/a.avi'"
    ):
        open_sequence(tmp_path / "my films")
    cases.make_kitti(tmp_path)
    with pytest.raises(InputError, match="sequences/00"):
        open_sequence(tmp_path)


@pytest.mark.parametrize("extension", [".png", ".jpg", ".pgm", ".ppm"])
def test_an_image_cut_anywhere_is_refused(tmp_path: Path, extension: str) -> None:
    """OpenCV would return the rows it has: every length but the whole must be refused."""
    colour = np.dstack([cases.texture_pair(seed, 40, 30)[0] for seed in range(3)])
    whole = tmp_path / f"whole{extension}"
    cases.write_image(whole, colour if extension in (".ppm", ".jpg") else colour[:, :, 0])
    data = whole.read_bytes()
    read_grey(whole)
    part = tmp_path / f"part{extension}"
    for length in range(len(data)):
        part.unlink(missing_ok=True)  # a file that is truncated may be written to the disk at once
        part.write_bytes(data[:length])
        with pytest.raises(InputError, match=re.escape(str(part))):
            read_grey(part)


def test_a_progressive_jpeg_cut_anywhere_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "progressive.jpg"
    progressive = [cv2.IMWRITE_JPEG_PROGRESSIVE, 1, cv2.IMWRITE_JPEG_RST_INTERVAL, 2]
    assert cv2.imwrite(str(path), cases.texture_pair(0, 40, 30)[0], progressive)
    data = path.read_bytes()
    assert read_grey(path).shape == (30, 40)
    for length in range(0, len(data), 7):
        path.write_bytes(data[:length])
        with pytest.raises(InputError, match="progressive"):
            read_grey(path)


def test_a_flipped_bit_in_a_png_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "image.png"
    cases.write_image(path, cases.texture_pair(0)[0])
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"image\.png: damaged image"):
        read_grey(path)


def test_a_header_that_asks_for_too_much_is_refused(tmp_path: Path) -> None:
    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", 60000, 60000, 8, 0, 0, 0, 0)
    idat = chunk(b"IDAT", zlib.compress(b""))
    (tmp_path / "huge.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + idat + chunk(b"IEND", b"")
    )
    with pytest.raises(InputError, match="60000x60000"):
        read_grey(tmp_path / "huge.png")
