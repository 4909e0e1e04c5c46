"""Cameras of a live run: pairs by the time of arrival, one that is unplugged and comes back, bad devices."""

from __future__ import annotations

import itertools
import json
import time
from pathlib import Path
from threading import Event, Timer

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused
from live_process import Live, running, until
from numpy.typing import NDArray
from vista.errors import InputError
from vista.live import camera as live_camera
from vista.live.camera import Cameras, Capture
from vista.live.source import Shot

pytestmark = pytest.mark.slow

SHAPE = (4, 6)
PERIOD_S = 0.05


class Virtual:
    """A camera that counts: every pixel is the number of its picture. It waits `delay_s` after each full
    period, fails after `pictures`, and is unplugged for as long as `unplugged` is set."""

    def __init__(self, delay_s: float = 0.0, shape: tuple[int, int] = SHAPE, pictures: int = 250) -> None:
        self.unplugged, self.opened, self.closed = Event(), 0, 0
        self._delay_s, self._shape, self._pictures = delay_s, shape, pictures
        self._count = 0

    def open(self) -> Virtual:
        if self.unplugged.is_set():
            raise InputError("virtual", "no camera that OpenCV can open")
        self.opened += 1
        return self

    def read(self) -> NDArray[np.uint8] | None:
        now_s = time.monotonic()
        time.sleep(PERIOD_S - (now_s - self._delay_s) % PERIOD_S)
        self._count += 1
        if self.unplugged.is_set() or self._count > self._pictures:
            return None
        return np.full(self._shape, self._count % 256, np.uint8)

    def close(self) -> None:
        self.closed += 1


def cameras_of(devices: dict[str, Virtual], tolerance_ms: float = 20.0) -> Cameras:
    return Cameras(list(devices), tolerance_ms, lambda name: devices[name].open())


def take(cameras: Cameras, count: int) -> list[Shot]:
    stopped, shots = Event(), []
    deadline_s = time.monotonic() + 60.0
    for shot in cameras.shots(stopped):
        shots.append(shot)
        assert time.monotonic() < deadline_s
        if len(shots) >= count:
            stopped.set()
    return shots


def test_two_cameras_make_pairs() -> None:
    devices = {"left": Virtual(), "right": Virtual(0.004)}
    shots = take(cameras_of(devices), 8)
    assert [shot.frame.index for shot in shots] == list(range(8))
    for shot in shots:
        assert shot.frame.left.shape == shot.frame.right.shape == SHAPE
        assert shot.frame.t_ns == shot.exposed_ns and shot.frame.world_from_camera is None
    times_ns = [shot.frame.t_ns for shot in shots]
    assert times_ns == sorted(set(times_ns))


def test_one_camera_shows_both_views() -> None:
    class Halves(Virtual):
        def read(self) -> NDArray[np.uint8] | None:
            picture = super().read()
            if picture is not None:
                picture[:, :6], picture[:, 6:] = 10, 20
            return picture

    cameras = cameras_of({"both": Halves(shape=(4, 12))})
    assert cameras.size_px == (6, 4)
    for shot in take(cameras, 3):
        assert np.all(shot.frame.left == 10) and np.all(shot.frame.right == 20)
        assert shot.frame.left.shape == SHAPE


def test_pictures_of_different_moments_are_no_pair() -> None:
    """Each camera takes its picture a good while after the other has delivered."""
    turns = [Event(), Event()]
    turns[0].set()

    class InTurn:
        def __init__(self, k: int) -> None:
            self._k, self.reads = k, 0

        def read(self) -> NDArray[np.uint8] | None:
            self.reads += 1
            if self.reads > 1:  # the first is for the size
                turns[self._k].wait(5.0)
                turns[self._k].clear()
                time.sleep(0.03)
                turns[1 - self._k].set()
            return np.zeros(SHAPE, np.uint8)

        def close(self) -> None: ...

    cameras = Cameras(["0", "1"], 1.0, lambda name: InTurn(int(name)))
    stopped = Event()
    Timer(1.0, stopped.set).start()
    pairs = list(cameras.shots(stopped))
    assert cameras.skipped >= 2 and cameras.skipped > 3 * len(pairs)


def test_cameras_that_never_agree_are_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # By the clock of a busy machine some pictures of cameras half a period apart do agree.
    arrivals_ns = itertools.count(0, 25_000_000)
    monkeypatch.setattr(live_camera.time, "monotonic_ns", lambda: next(arrivals_ns))
    cameras = cameras_of({"left": Virtual(), "right": Virtual(0.025)}, tolerance_ms=1.0)
    stopped = Event()
    Timer(3.5, stopped.set).start()
    assert not list(cameras.shots(stopped))
    assert capsys.readouterr().err == "vista: left and right: no two pictures within 1 ms\n"


def test_a_camera_that_comes_back_with_another_size_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(live_camera, "REOPEN_S", 0.05)
    opened = [Virtual(pictures=4), Virtual(shape=(4, 8)), Virtual()]
    cameras = Cameras(["both"], 5.0, lambda _: opened.pop(0).open())
    stopped = Event()
    for count, _ in enumerate(cameras.shots(stopped), start=1):
        if count == 6:
            stopped.set()
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        "vista: both: lost; trying to open it again",
        "vista: both: back",
        "vista: both: delivers 8x4 px, before 6x4 px; trying to open it again",
        "vista: both: back",
    ]


def test_a_device_is_asked_for_the_size_of_the_calibration(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, run_vista: Vista
) -> None:
    """One that does not listen is refused."""
    asked = {}

    class Stubborn:
        def __init__(self, name: str | int) -> None: ...

        def isOpened(self) -> bool:  # noqa: N802 - as OpenCV has it
            return True

        def set(self, key: int, value: float) -> None:
            asked[key] = value

        def read(self) -> tuple[bool, NDArray[np.uint8]]:
            return True, np.zeros((48, 64, 3), np.uint8)

        def release(self) -> None: ...

    monkeypatch.setattr(cv2, "VideoCapture", Stubborn)
    path = tmp_path / "calibration.toml"
    path.write_text(f"size_px = [{cases.WIDTH}, {cases.HEIGHT}]\n{cases.PAIR_CALIBRATION}")
    ran = run_vista("live", "--no-page", "--camera", "0", "--calibration", path)
    assert_refused(ran, f"{path}: is for images of {cases.WIDTH}x{cases.HEIGHT} px, these have 32x48")
    assert asked[cv2.CAP_PROP_FRAME_WIDTH] == 2 * cases.WIDTH
    assert asked[cv2.CAP_PROP_FRAME_HEIGHT] == cases.HEIGHT


def test_a_camera_that_was_unplugged_is_found_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(live_camera, "REOPEN_S", 0.05)
    devices = {"left": Virtual(), "right": Virtual()}
    stopped = Event()
    for count, _ in enumerate(cameras_of(devices).shots(stopped), start=1):
        if count == 3:
            devices["right"].unplugged.set()
            Timer(0.5, devices["right"].unplugged.clear).start()
        if count == 10:
            stopped.set()
    err = capsys.readouterr().err
    assert err == "vista: right: lost; trying to open it again\nvista: right: back\n"
    assert devices["right"].opened == 2 and devices["left"].opened == 1


def test_cameras_of_two_sizes_are_refused_and_closed() -> None:
    devices = {"left": Virtual(), "right": Virtual(shape=(4, 8))}
    with pytest.raises(InputError, match="right: delivers 8x4 px, left 6x4 px"):
        cameras_of(devices)
    assert [device.closed for device in devices.values()] == [1, 1]
    with pytest.raises(InputError, match="no two views"):
        cameras_of({"odd": Virtual(shape=(4, 7))})
    with pytest.raises(InputError, match="dead: delivers no picture"):
        cameras_of({"dead": Virtual(pictures=0)})


@pytest.fixture
def calibration(tmp_path: Path) -> Path:
    path = tmp_path / "calibration.toml"
    path.write_text(cases.PAIR_CALIBRATION)
    return path


VIDEO_FRAMES = 10


@pytest.fixture
def video(tmp_path: Path) -> Path:
    """It takes the place of a camera: OpenCV opens both alike."""
    path = tmp_path / "both.avi"
    size = (2 * cases.WIDTH, cases.HEIGHT)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 20.0, size, isColor=True)
    for index in range(VIDEO_FRAMES):
        both = np.hstack(cases.texture_pair(index))
        writer.write(cv2.cvtColor(both, cv2.COLOR_GRAY2BGR))
    writer.release()
    return path


def test_a_device_of_opencv(video: Path) -> None:
    device = Capture(str(video))
    for index in range(10):
        picture = device.read()
        assert picture is not None and picture.shape == (cases.HEIGHT, 2 * cases.WIDTH)
        difference = picture.astype(int) - np.hstack(cases.texture_pair(index))
        assert np.abs(difference).mean() < 5.0  # of the compression
    assert device.read() is None
    device.close()


def came(live: Live) -> int:
    """Pairs that came so far, also those that were not worked on."""
    state = json.loads(live.get("/state")[2])
    return sum(state[name] for name in ("processed", "dropped", "duplicates"))


def test_a_camera_that_is_lost_and_found_in_a_run(video: Path, calibration: Path) -> None:
    """A video delivers as fast as it is read, and at its end it is lost as if it were unplugged."""
    with running("--camera", video, "--calibration", calibration) as live:
        until(lambda: came(live) > VIDEO_FRAMES)
        status, err = live.stop()
    assert status == 130
    assert f"vista: {video}: lost" in err and f"vista: {video}: back" in err


BAD = [
    ((), "takes SEQUENCE or --camera"),
    (("--camera", "0"), "needs --calibration FILE.toml"),
    (("--camera", "0", "1", "2", "--calibration", "CALIBRATION"), "takes one device or two"),
    (("here", "--size-px", "640x480"), "--size-px: goes with --camera"),
    (("--camera", "/dev/video99", "--calibration", "CALIBRATION"), "/dev/video99: no camera"),
    (("--camera", "99999999999999", "--calibration", "CALIBRATION"), "99999999999999: no camera"),
    (("--camera", "0", "--repeat"), "--repeat: goes with a recording"),
    (("--camera", "0", "--right", "x.avi", "--calibration", "CALIBRATION"), "--right: does not go with"),
]


@pytest.mark.parametrize("arguments, text", BAD)
def test_bad_sources_take_one_line(
    arguments: tuple[str, ...], text: str, calibration: Path, run_vista: Vista
) -> None:
    given = [calibration if a == "CALIBRATION" else a for a in arguments]
    assert_refused(run_vista("live", "--no-page", *given), text)
