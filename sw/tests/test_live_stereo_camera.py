"""Cameras that know their own calibration: a simulated OAK, and a RealSense that its own library makes."""

from __future__ import annotations

import importlib
import json
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from threading import Event, Thread
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from command_line import Vista, assert_refused, call
from numpy.typing import NDArray
from simulated_depthai import FISHEYE, Bench, Calibration
from vista.errors import InputError
from vista.live import stereo_camera
from vista.live.source import Shot
from vista.live.stereo_camera import StereoCamera
from vista.sequence import open_sequence

SIZE = (640, 400)
Image = NDArray[np.uint8]


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    made = Bench()
    monkeypatch.setitem(sys.modules, "depthai", made.module())
    monkeypatch.delitem(sys.modules, "vista.live.oak", raising=False)
    monkeypatch.setattr(stereo_camera, "REOPEN_S", 0.01)
    monkeypatch.setattr(stereo_camera, "SILENT_S", 0.05)
    return made


@pytest.fixture
def vista(capsys: pytest.CaptureFixture[str]) -> Vista:
    return partial(call, capsys)


def images(number: int, size: tuple[int, int] = SIZE) -> tuple[Image, Image]:
    left, right = (np.full(size[::-1], value, np.uint8) for value in (number, 100 + number))
    return left, right


def take(camera: StereoCamera, count: int) -> list[Shot]:
    stopped, taken = Event(), []
    for shot in camera.shots(stopped):
        taken.append(shot)
        if len(taken) == count:
            stopped.set()
    return taken


def test_oak_delivers_pairs_and_its_calibration(bench: Bench) -> None:
    bench.pairs.extend(images(k) for k in range(3))
    camera = StereoCamera("oak:14442C10")
    shots = take(camera, 3)
    assert [int(shot.frame.left[0, 0]) for shot in shots] == [0, 1, 2]
    assert [int(shot.frame.right[0, 0]) for shot in shots] == [100, 101, 102]
    late_s = 1e-9 * (time.monotonic_ns() - shots[-1].exposed_ns)
    assert bench.age_s <= late_s < bench.age_s + 5.0
    raw = camera.calibration
    assert (raw.left.width, raw.left.height, raw.left.matrix[0, 0]) == (640, 400, 400.0)
    assert raw.left.distortion == bench.calibration.distortion[:8]
    np.testing.assert_allclose(raw.right_from_left.translation_m, [-0.075, 0.0, 0.0])
    assert bench.asked == [(socket, SIZE, "GRAY8", 30.0, False) for socket in ("CAM_B", "CAM_C")]
    camera.close()


def test_oak_with_fisheyes(bench: Bench) -> None:
    bench.calibration = Calibration(distortion=(0.1, 0.2, 0.3, 0.4, *[0.0] * 10), model=FISHEYE)
    camera = StereoCamera("oak", (1280, 800))
    assert camera.size_px == (1280, 800)
    assert (camera.calibration.left.lens, camera.calibration.left.distortion) == (
        "fisheye",
        (0.1, 0.2, 0.3, 0.4),
    )


def test_oak_that_is_unplugged_comes_back(bench: Bench, capsys: pytest.CaptureFixture[str]) -> None:
    camera = StereoCamera("oak")
    bench.pairs.append(images(1))
    stopped, taken = Event(), []

    def run() -> None:
        for shot in camera.shots(stopped):
            taken.append(shot)
            bench.plugged = len(taken) != 1
            if len(taken) == 2:
                stopped.set()

    reader = Thread(target=run)
    reader.start()
    deadline_s = time.monotonic() + 10.0
    while "lost" not in capsys.readouterr().err:
        assert time.monotonic() < deadline_s
    bench.pairs.append(images(2))
    bench.plugged = True
    reader.join(10.0)
    assert len(taken) == 2 and bench.opened == 2
    assert "back" in capsys.readouterr().err


def test_another_device_is_not_taken_for_the_lost_one(
    bench: Bench, capsys: pytest.CaptureFixture[str]
) -> None:
    camera, stopped = StereoCamera("oak"), Event()
    bench.calibration = Calibration(focal_px=801.0)
    reader = Thread(target=lambda: list(camera.shots(stopped)))
    reader.start()
    told, deadline_s = "", time.monotonic() + 10.0
    while "another device" not in told:
        assert time.monotonic() < deadline_s
        told += capsys.readouterr().err
    stopped.set()
    reader.join(10.0)
    assert "back" not in told


@pytest.mark.parametrize(
    "name, changed, reason",
    [
        ("oak:1", {}, "cannot be opened: No available devices"),
        ("oak", {"calibration": Calibration(stored=False)}, "holds no calibration of its stereo pair"),
        (
            "oak",
            {"calibration": Calibration(distortion=(0.1,) * 14)},
            "distortion of 14 numbers; known are",
        ),
    ],
)
def test_oaks_that_do_not_do(bench: Bench, name: str, changed: dict[str, Any], reason: str) -> None:
    vars(bench).update(changed)
    with pytest.raises(InputError, match=reason):
        StereoCamera(name)


def test_record_puts_the_calibration_beside_the_pairs(bench: Bench, vista: Vista, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    left, right = rng.integers(0, 256, (2, *SIZE[::-1]), np.uint8)
    bench.pairs.extend([(left, right)] * 5)
    target = tmp_path / "pairs"
    run = vista("record", "--camera", "oak", "--out", target, "--duration", 0.5)
    assert run[0] == 0, run[2]
    recorded = open_sequence(target)
    assert recorded.calibration.left.distortion == bench.calibration.distortion[:8]
    np.testing.assert_array_equal(recorded.read(recorded.frames[0]).right, right)


def test_live_needs_no_calibration(
    bench: Bench, vista: Vista, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    oak = importlib.import_module("vista.live.oak")

    rng = np.random.default_rng(3)
    bench.pairs.extend(tuple(rng.integers(0, 256, (2, *SIZE[::-1]), np.uint8)) for _ in range(3))
    read = oak.Oak.read

    def read_to_the_end(self: Any, timeout_s: float) -> Any:
        if not bench.pairs:
            raise InputError("oak", "the test is over")
        return read(self, timeout_s)

    monkeypatch.setattr(oak.Oak, "read", read_to_the_end)
    lines = tmp_path / "lines.jsonl"
    run = vista("live", "--camera", "oak", "--no-page", "--out", lines)
    assert "the test is over" in run[2]
    assert len([json.loads(line) for line in lines.read_text().splitlines()]) >= 1


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["oak", "1"], "oak delivers both views by itself"),
        (["oak", "--pair-tolerance-ms", "5"], "oak pairs its pictures by itself"),
    ],
)
def test_options_that_do_not_go_with_it(
    bench: Bench, vista: Vista, tmp_path: Path, arguments: list[str], reason: str
) -> None:
    run = vista("record", "--out", tmp_path / "pairs", "--camera", *arguments)
    assert_refused(run, reason)


@pytest.mark.parametrize("kind, package", [("oak", "depthai"), ("realsense", "pyrealsense2")])
def test_without_its_package(vista: Vista, monkeypatch: pytest.MonkeyPatch, kind: str, package: str) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, f"vista.live.{kind}", raising=False)
    run = vista("live", "--camera", kind)
    assert_refused(run, f"needs the package {package}: pip install 'vista-stereo[{kind}]'")


# ---- RealSense: its library simulates devices itself ----


@pytest.fixture
def realsense() -> ModuleType:
    pytest.importorskip("pyrealsense2", reason="pyrealsense2 is not installed", exc_type=ImportError)
    from vista.live import realsense

    return realsense


class Simulated:
    """A device of librealsense that delivers numbered pairs."""

    def __init__(self, rs: Any, size_px: tuple[int, int] = (848, 480), coefficient: float = 0.0) -> None:
        self._rs, self.size_px = rs, size_px
        self.device = rs.software_device()
        self._sensor = self.device.add_sensor("Stereo Module")
        self._profiles = [self._profile(k, size_px, coefficient) for k in (1, 2)]
        moved = rs.extrinsics()
        moved.rotation, moved.translation = [0, 1, 0, -1, 0, 0, 0, 0, 1], [-0.05, 0.01, 0.0]
        self._profiles[0].register_extrinsics_to(self._profiles[1], moved)
        self.device.create_matcher(rs.matchers.default)

    def _profile(self, index: int, size_px: tuple[int, int], coefficient: float) -> Any:
        rs = self._rs
        stream, seen = rs.video_stream(), rs.intrinsics()
        seen.width, seen.height = size_px
        seen.fx, seen.fy, seen.ppx, seen.ppy = 420.0, 421.0, 424.5, 239.5
        seen.model, seen.coeffs = rs.distortion.brown_conrady, [coefficient, 0.0, 0.0, 0.0, 0.0]
        stream.type, stream.index, stream.uid = rs.stream.infrared, index, index
        (stream.width, stream.height), stream.fps, stream.bpp = size_px, 30, 1
        stream.fmt, stream.intrinsics = rs.format.y8, seen
        return rs.video_stream_profile(self._sensor.add_video_stream(stream))

    def send(self, number: int) -> None:
        for profile, image in zip(self._profiles, images(number, self.size_px), strict=True):
            frame = self._rs.software_video_frame()
            frame.pixels, frame.stride, frame.bpp = image, self.size_px[0], 1
            frame.timestamp, frame.domain = 1e3 * time.time(), self._rs.timestamp_domain.system_time
            frame.frame_number, frame.profile = number, profile
            self._sensor.on_video_frame(frame)


@pytest.fixture
def simulated(realsense: ModuleType) -> Iterator[tuple[Simulated, StereoCamera]]:
    made = Simulated(realsense.rs)
    camera = StereoCamera(
        "realsense",
        None,
        lambda name, size_px: realsense.RealSense(name, made.device, size_px or made.size_px),
    )
    yield made, camera
    camera.close()


def test_realsense_delivers_pairs_and_its_calibration(simulated: tuple[Simulated, StereoCamera]) -> None:
    device, camera = simulated
    stopped = Event()

    def feed() -> None:
        number = 0
        while not stopped.wait(0.02):
            device.send(number % 100)
            number += 1

    feeder = Thread(target=feed)
    feeder.start()
    try:
        shots = take(camera, 5)
    finally:
        stopped.set()
        feeder.join()
    for shot in shots:
        left, right = int(shot.frame.left[0, 0]), int(shot.frame.right[0, 0])
        assert right == 100 + left and shot.frame.left.shape == (480, 848)
    assert 0 <= time.monotonic_ns() - shots[-1].exposed_ns < 5_000_000_000
    raw = camera.calibration
    np.testing.assert_allclose(raw.left.matrix, [[420, 0, 424.5], [0, 421, 239.5], [0, 0, 1]])
    np.testing.assert_allclose(raw.right_from_left.translation_m, [-0.05, 0.01, 0.0], atol=1e-7)
    np.testing.assert_array_equal(raw.right_from_left.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])


def test_realsense_of_another_size(realsense: ModuleType) -> None:
    with pytest.raises(InputError, match="no pair of infrared images of 640x360 px"):
        realsense.RealSense("realsense", Simulated(realsense.rs).device, (640, 360))


def test_no_realsense_is_connected(realsense: ModuleType) -> None:
    with pytest.raises(InputError, match="no such camera is connected"):
        realsense.open_device("realsense:1", None)
