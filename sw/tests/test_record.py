"""`vista record`: pairs of cameras as a folder that the other commands read. Videos stand for cameras."""

from __future__ import annotations

import csv
import signal
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from command_line import Vista, assert_refused
from numpy.typing import NDArray
from vista.live.recorder import PairFolder
from vista.live.source import Shot
from vista.sequence import Frame, open_sequence

CALIBRATION = "focal_px = 50.0\ncx = 31.5\ncy = 23.5\nbaseline_m = 0.2\n"


def video(path: Path, count: int, width: int = 128) -> Path:
    """Each frame is as bright as its number, the right half brighter by 100."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25.0, (width, 48))
    for k in range(count):
        frame = np.full((48, width, 3), k % 100, np.uint8)
        frame[:, width // 2 :] += 100
        writer.write(frame)
    writer.release()
    return path


def shot(index: int, left: NDArray[np.uint8], right: NDArray[np.uint8]) -> Shot:
    return Shot(Frame(index, index, left, right, None), time.monotonic_ns())


def test_what_is_recorded_is_read_again(tmp_path: Path) -> None:
    random = np.random.default_rng(5)
    images = random.integers(0, 256, (4, 2, 48, 64), np.uint8)
    before_ns = time.time_ns()
    folder = PairFolder(tmp_path / "pairs", CALIBRATION)
    shots = [shot(k, left, right) for k, (left, right) in enumerate(images)]
    assert [folder.write(one) for one in shots] == ["000000", "000001", "000002", "000003"]
    folder.close()
    recorded = open_sequence(tmp_path / "pairs")
    frames = [recorded.read(files) for files in recorded.frames]
    for frame, one, (left, right) in zip(frames, shots, images, strict=True):
        assert np.array_equal(frame.left, left) and np.array_equal(frame.right, right)
        assert frame.t_ns - frames[0].t_ns == one.exposed_ns - shots[0].exposed_ns
        assert abs(frame.t_ns - before_ns) < 60e9  # the time of the day


@pytest.mark.slow
def test_a_video_is_recorded_and_run(run_vista: Vista, tmp_path: Path) -> None:
    camera, given = video(tmp_path / "camera.avi", 60), tmp_path / "given.toml"
    given.write_text(CALIBRATION)
    status, _, err = run_vista(
        "record", "--camera", camera, "--calibration", given, "--duration", "1", "--out", tmp_path / "pairs"
    )
    assert status == 0
    rows = list(csv.DictReader((tmp_path / "pairs" / "times.csv").open()))
    assert rows and f"{tmp_path / 'pairs'}: {len(rows)} pair" in err
    recorded = open_sequence(tmp_path / "pairs")
    assert len(recorded.frames) == len(rows)
    for files in recorded.frames:
        frame = recorded.read(files)
        assert frame.left.shape == (48, 64)
        assert abs(float(frame.right.mean()) - float(frame.left.mean()) - 100.0) < 3.0


@pytest.mark.slow
def test_a_rate_thins_out(run_vista: Vista, tmp_path: Path) -> None:
    camera = video(tmp_path / "camera.avi", 40)
    assert (
        run_vista(
            "record", "--camera", camera, "--rate", "2", "--duration", "1.2", "--out", tmp_path / "pairs"
        )[0]
        == 0
    )
    times_ns = [int(row["t_ns"]) for row in csv.DictReader((tmp_path / "pairs" / "times.csv").open())]
    assert 1 <= len(times_ns) <= 4
    assert all(later - before >= 0.24e9 for before, later in pairwise(times_ns))


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_it_is_whole(tmp_path: Path, number: signal.Signals) -> None:
    camera = video(tmp_path / "camera.avi", 100)
    out = tmp_path / "pairs"
    command = [sys.executable, "-m", "vista", "record", "--camera", str(camera), "--out", str(out)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60.0
    while not (out / "times.csv").exists():
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.01)
    process.send_signal(number)
    _, err = process.communicate(timeout=60.0)
    assert process.returncode == 130 and err.endswith("vista: interrupted\n")
    (out / "calibration.toml").write_text(CALIBRATION)
    assert open_sequence(out).frames


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (("--camera", "99"), "99: no camera that OpenCV can open"),
        (("--camera", "CAMERA", "--size-px", "640x480"), "delivers images of 64x48 px, not 640x480"),
        (("--camera", "CAMERA", "--size-px", "640"), "'640' is no size such as 640x480"),
        (("--camera", "CAMERA", "--calibration", "missing.toml"), "missing.toml"),
        (("--camera", "CAMERA", "--duration", "-1"), "'-1' is not a number from 0 on"),
        (("--camera", "CAMERA", "CAMERA", "CAMERA"), "takes one device or two"),
    ],
)
def test_refused_before_anything_is_written(
    run_vista: Vista, tmp_path: Path, given: tuple[str, ...], text: str
) -> None:
    camera = video(tmp_path / "camera.avi", 3)
    named = [str(camera) if word == "CAMERA" else word for word in given]
    assert_refused(run_vista("record", *named, "--out", tmp_path / "pairs"), text)
    assert not (tmp_path / "pairs").exists()


def test_a_folder_that_holds_something_is_left_alone(run_vista: Vista, tmp_path: Path) -> None:
    camera = video(tmp_path / "camera.avi", 3)
    assert_refused(run_vista("record", "--camera", camera, "--out", tmp_path), "not an empty folder")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["camera.avi"]
