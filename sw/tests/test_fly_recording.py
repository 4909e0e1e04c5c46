"""vista-fly finds in a recording what `vista run` finds, but for the times. Bad files are refused."""

from __future__ import annotations

import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused
from flight_on_disk import write_flight
from fly_process import SANITIZED, compare, fly, frames_at, prepare, timeless
from shared_data import SHARED_DATA
from vista.recording import HEAD

pytestmark = pytest.mark.native

EUROC, KITTI = SHARED_DATA / "euroc_v101", SHARED_DATA / "kitti_odometry" / "sequences" / "00"


@pytest.mark.slow
@pytest.mark.same_c
def test_a_flight(tmp_path: Path) -> None:
    lines, _ = compare(tmp_path, write_flight(tmp_path / "flight", frames=20), frames=20)
    assert len(lines) == 20
    assert any('"confirmed": true' in line for line in lines)  # something to compare
    assert any('"time_to_collision_s": ' in line for line in lines)


@pytest.mark.parametrize(
    "config",
    [
        pytest.param("", marks=pytest.mark.same_c),
        pytest.param("[stereo]\nrectify_rows = 128\n", marks=pytest.mark.same_c),
        '[stereo]\nsmooth = "binomial3"\nlevels = 2\nlr_max_diff = -1\nprefilter = "none"\n'
        "[host]\nthreads = 2\n",
    ],
    ids=["map", "grid", "engine"],
)
@pytest.mark.slow
@pytest.mark.skipif(not EUROC.is_dir(), reason="EuRoC V1_01 is not there")
def test_raw_images_of_a_room(tmp_path: Path, config: str) -> None:
    compare(tmp_path, EUROC, config, 6)


@pytest.mark.slow
@pytest.mark.same_c
@pytest.mark.skipif(not KITTI.is_dir(), reason="KITTI odometry 00 is not there")
def test_a_street(tmp_path: Path) -> None:
    compare(tmp_path, KITTI, frames=8)


def test_distorted_images(tmp_path: Path) -> None:
    """It runs without the shared data too: a lens whose map leads beyond the image."""
    flight = cases.make_raw(cases.make_flown_pairs(tmp_path / "flight", 5))
    compare(tmp_path, flight)


# ---- prepare ----


def test_a_rig_of_cameras(tmp_path: Path, run_vista: Vista) -> None:
    pairs = cases.make_flown_pairs(tmp_path / "flight", 2)
    prepare(tmp_path / "whole", pairs)
    calibration = pairs / "calibration.toml"
    size = "x".join(map(str, struct.unpack_from("<2I", (tmp_path / "whole" / "rig.vista").read_bytes(), 12)))
    options = ["--calibration", calibration, "--size-px", size, "--out", tmp_path / "cameras"]
    assert run_vista("prepare", *options)[0] == 0
    assert [file.name for file in (tmp_path / "cameras").iterdir()] == ["rig.vista"]
    rigs = [(tmp_path / name / "rig.vista").read_bytes() for name in ("cameras", "whole")]
    assert rigs[0] == rigs[1]


@pytest.mark.parametrize(
    "arguments, text",
    [
        ([], "takes SEQUENCE, or --calibration and --size-px"),
        (["--size-px", "640"], "'640' is no size such as 640x480"),
        (["flight", "--size-px", "64x64"], "goes with cameras"),
        (["flight", "--poses", "odometry"], "not estimated"),
    ],
)
def test_prepare_refuses(tmp_path: Path, run_vista: Vista, arguments: list[str], text: str) -> None:
    flight = cases.make_flown_pairs(tmp_path / "flight", 2)
    named = [flight if argument == "flight" else argument for argument in arguments]
    assert_refused(run_vista("prepare", *named, "--out", tmp_path / "out"), text)
    assert not (tmp_path / "out").exists()


def test_an_image_that_cannot_be_read_leaves_nothing(tmp_path: Path, run_vista: Vista) -> None:
    flight = cases.make_flown_pairs(tmp_path / "flight", 3)
    (flight / "scene02_left.png").write_bytes(b"no image")
    assert_refused(run_vista("prepare", flight, "--out", tmp_path / "out"), "scene02_left.png")
    assert list((tmp_path / "out").iterdir()) == []


# ---- bad files ----


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("prepared")
    prepare(folder, cases.make_raw(cases.make_flown_pairs(folder / "flight", 2)))
    return folder


def refused(run: subprocess.CompletedProcess[str], text: str) -> None:
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr.startswith("vista-fly: ") and run.stderr.count("\n") == 1
    assert text in run.stderr


def with_bytes(source: Path, target: Path, at: int, data: bytes) -> Path:
    content = bytearray(source.read_bytes())
    content[at : at + len(data)] = data
    target.write_bytes(content)
    return target


@pytest.mark.parametrize(
    "at, data, text",
    [
        (0, b"NO", "no file of vista prepare"),
        (8, b"\x07", "another version"),
        (12, bytes(4), "damaged"),  # the width
        (12, b"\xff\xff\xff\xff", "damaged"),
        (20, b"\x09", "damaged"),  # how images are rectified
        (28, b"\x09", "damaged"),  # what a frame holds
        (36, b"\xff\xff\xff\xff", "damaged"),  # how many parameters there are
        (40, struct.pack("<d", np.nan), "not finite"),  # the focal length
        (64, bytes(8), "range"),  # the baseline
        (HEAD.size - 464, struct.pack("<d", np.nan), "damaged"),  # the rotation of the right camera
        (HEAD.size - 392, b"\x07", "damaged"),  # its lens
        (HEAD.size, b"wrong.name" + bytes(38), "unknown parameter or value: wrong.name"),
        (HEAD.size, b"two\nlines\x1b" + bytes(38), "unknown parameter or value: two?lines?"),
        (HEAD.size + 80, struct.pack("<d", np.nan), "unknown parameter or value: "),
        (HEAD.size + 80, struct.pack("<d", -1.0), " is out of range"),
        (-2, b"\xff\xff", "damaged"),  # the last fraction
        (16, struct.pack("<d", np.inf), "a pose is not finite"),
    ],
)
def test_damaged_files_take_one_line(tmp_path: Path, prepared: Path, at: int, data: bytes, text: str) -> None:
    frames = prepared / "frames.vista"
    end_of_rig = frames_at(frames)
    of_frame = "pose" in text
    at = end_of_rig + at if at < 0 or of_frame else at
    run = fly("--recording", with_bytes(frames, tmp_path / "bad.vista", at, data), "--all-frames")
    if of_frame:  # in flight: what came before was done
        assert run.returncode == 2 and text in run.stderr
    else:
        refused(run, text)


@pytest.mark.parametrize("share", [0.0, 0.0001, 0.5, 0.9999])
def test_files_that_are_cut_off(tmp_path: Path, prepared: Path, share: float) -> None:
    content, short = (prepared / "frames.vista").read_bytes(), tmp_path / "short.vista"
    short.write_bytes(content[: int(share * len(content))])
    refused(fly("--recording", short), "short.vista: ")


def test_a_rig_is_no_recording(prepared: Path) -> None:
    refused(fly("--recording", prepared / "rig.vista"), "rig.vista: holds no frame")


def test_parameters_travel_in_the_file(tmp_path: Path, prepared: Path) -> None:
    """Those of the configuration that it was prepared with."""
    (tmp_path / "my.toml").write_text(
        "[tracker]\nconfirm_hits = 1\nconfirm_window = 1\n[stereo]\nlevels = 1\n"
    )
    flight = write_flight(tmp_path / "flight", frames=2)
    first = []
    for name, options in (("plain", ()), ("own", ("--config", tmp_path / "my.toml"))):
        run = fly(
            *prepare(tmp_path / name, flight, *options), "--all-frames", "--out", tmp_path / name / "lines"
        )
        assert run.returncode == 0, run.stderr
        first.append('"confirmed": true' in (tmp_path / name / "lines").read_text().splitlines()[0])
    assert first == [False, True]


@pytest.mark.parametrize(
    "arguments, text",
    [
        (["--shared", "x"], "--rig: is needed"),
        (["--rig", "x", "--recording", "x"], "--rig: is not needed"),
        (["--rig", "x"], "takes one of --camera, --shared, --board and --recording"),
        (["--rig", "x", "--recording", "x", "--shared", "x"], "takes one of"),
        (["--recording", "/nowhere"], "/nowhere: no such file or directory"),
        (["--wrong"], "--wrong: no such option"),
        (["--watchdog", "0"], "--watchdog: 0 is not from 0.5 to 3600"),
        (["--rig"], "--rig: takes a value"),
        (["--rig", "x", "--shared", "y", "--repeat"], "--repeat: goes with --recording"),
        (["--rig", "x", "--shared", "y", "--times", "z"], "--times: goes with --recording"),
        (["--recording", "x", "--times", "z", "--repeat"], "--times: goes with --passes"),
        (["--recording", "x", "--passes", "2", "--repeat"], "--passes: does not go with --repeat"),
        (["--recording", "x", "--frames", "0"], "--frames: 0 is not from 1"),
        (["--recording", "x", "--frames", "2x"], "--frames: 2x is not from 1"),
        (["--recording", "x", "--frames", "1.5"], "1.5 is no whole number"),
        (["--rig", "x", "--shared", "y", "--poses", "mavlink"], "needs --to"),
        (["--rig", "x", "--shared", "y", "--poses", "gps"], "is mavlink or source"),
        (["--rig", "x", "--shared", "y", "--listen", "1.5", "--to", "udp:127.0.0.1:1"], "no port"),
        (["--rig", "x", "--camera", "a", "b", "c"], "takes one device or two"),
    ],
)
def test_bad_arguments_take_one_line(arguments: list[str], text: str) -> None:
    refused(fly(*arguments), text)


@pytest.mark.parametrize(
    "target, text",
    [
        ("udp:127.0.0.1", "is neither"),
        ("udp:127.0.0.1:0", "is neither"),
        ("udp:autopilot:14550", "no numeric address"),
        ("serial:", "is neither"),
        ("serial:/dev/null", "inappropriate ioctl"),
        ("serial:/dev/nothing:57600", "no such file"),
        ("serial:/dev/null:12345", "no speed of a serial line"),
    ],
)
def test_bad_targets_take_one_line(prepared: Path, target: str, text: str) -> None:
    files = ["--recording", prepared / "frames.vista"]
    refused(fly(*files, "--to", target), text)


def test_help_and_version() -> None:
    assert fly("--help").stdout.startswith("usage: vista-fly")
    assert fly("--version").stdout.startswith("vista-fly 0.")


@pytest.mark.skipif(SANITIZED, reason="a sanitized program takes memory of its own")
def test_a_disk_that_is_full_ends_the_file_and_not_the_flight(tmp_path: Path, prepared: Path) -> None:
    files = ["--recording", prepared / "frames.vista"]
    run = fly(*files, "--all-frames", "--out", "/dev/full")
    assert run.returncode == 0
    assert "/dev/full: no space left on device; the flight goes on without it" in run.stderr
    assert "2 frames processed" in run.stderr


def test_a_line_that_was_cut_off_is_taken_away(tmp_path: Path, prepared: Path) -> None:
    files = ["--recording", prepared / "frames.vista", "--all-frames"]
    out = tmp_path / "lines.jsonl"
    assert fly(*files, "--out", out).returncode == 0
    whole = timeless(out)
    out.write_text(out.read_text() + '{"version": 2, "fra')
    assert fly(*files, "--out", out).returncode == 0
    assert timeless(out) == whole + whole


@pytest.mark.slow
def test_a_frame_that_comes_twice(tmp_path: Path) -> None:
    """A recording that is played patiently repeats nothing; one that is played in time says nothing twice."""
    flight = cases.make_flown_pairs(tmp_path / "flight", 6)
    for side in ("left", "right"):
        (flight / f"scene03_{side}.png").write_bytes((flight / f"scene02_{side}.png").read_bytes())
    compare(tmp_path, flight)
    run = fly("--recording", tmp_path / "fly" / "frames.vista")
    assert "5 frames processed, 0 dropped for newer ones, 1 duplicates" in run.stderr
