"""The replay program: Python's numbers to the last digit, nothing allocated, one line for a bad recording."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
from collections.abc import Callable
from pathlib import Path

import board_flight as scene
import pytest
import recording_cases as cases
from board_flight import board_flight
from pipeline_library import CALIBRATION
from vista import native, obstacle_line, parameters
from vista.geometry import Pose
from vista.pipeline import Pipeline, Result
from vista.recording import FRAME, HEADER, PARAMETER

pytestmark = pytest.mark.native

REPLAY = native.build_folder() / "bin" / "replay"
STAGES = (
    "motion,noise,words,foveation,health,surface,affinity,segmentation,refinement,regions,thin,reconstruction,tracking,"
    "blind_zone,terrain,map,path_view,footing,host,cpu"
)
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")


def replay(*arguments: object, **environment: str) -> subprocess.CompletedProcess[str]:
    """A stand-alone program: what is preloaded for Python's sake is not for it."""
    kept = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    command = [str(REPLAY), *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=300, env=kept | environment, cwd="/"
    )  # from any folder


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return cases.record(tmp_path_factory.mktemp("replay") / "board.rec", board_flight()[:9])


# ---- the same numbers ----


def as_line(index: int, result: Result) -> dict:
    """A result as the program prints it."""
    nearest = result.nearest_collision
    return {
        "frame": index,
        "cells": result.cell_intensity.size,
        "regions": result.regions,
        "valid_fraction": result.valid_fraction,
        "obstacles": [
            {
                "id": o.id,
                "confirmed": o.confirmed,
                "age_frames": o.age_frames,
                "position_m": o.position_m.tolist(),
                "distance_m": o.distance_m,
                "extent_m": list(o.extent_m),
                "disparity_px": o.disparity_px,
                "in_collision_volume": o.in_collision_volume,
            }
            for o in result.obstacles
        ],
        "nearest_collision": None
        if nearest is None
        else {
            "id": nearest.id,
            "distance_m": nearest.distance_m,
            "time_to_collision_s": nearest.time_to_collision_s,
        },
        "path_seen_m": result.path_seen_m,
    }


@pytest.mark.parametrize("levels", [1, 2, 4])
def test_replay_prints_the_numbers_of_python(tmp_path: Path, levels: int) -> None:
    flown = cases.record(tmp_path / "a.rec", board_flight()[:9], levels=levels)
    run = replay(flown)
    assert run.returncode == 0, run.stderr
    assert replay(flown, "--threads", 2).stdout == run.stdout
    pipeline = Pipeline(CALIBRATION)
    expected = []
    for index, source in enumerate(board_flight()[:9]):
        pose = Pose(scene.WORLD_FROM_CAMERA, source.position_m)
        words = cases.levels_of(source, levels)
        result = pipeline.process(source.left, words, source.t_ns, pose, scene.UP_WORLD)
        expected.append(as_line(index, result))
    assert [json.loads(line) for line in run.stdout.splitlines()] == expected
    assert expected[-1]["nearest_collision"] is not None


def test_its_keys_are_those_of_the_schema(recording: Path) -> None:
    """The program prints no file format of its own: its keys mean what they mean in obstacles.jsonl."""
    schema = json.loads(obstacle_line.schema_text())["properties"]
    line = json.loads(replay(recording, "--frames", 9).stdout.splitlines()[-1])
    assert line.keys() - {"cells"} <= schema.keys()
    assert line["obstacles"][0].keys() <= schema["obstacles"]["items"]["properties"].keys()
    assert line["nearest_collision"].keys() <= schema["nearest_collision"]["properties"].keys()


def test_the_recorded_parameters_count(tmp_path: Path) -> None:
    values = parameters.defaults()
    values["foveation"]["sector_count"] = 64
    values["affinity"]["form"] = "sum"
    values["tracker"]["confirm_hits"] = 1
    run = replay(cases.record(tmp_path / "a.rec", board_flight()[:1], values))
    source = board_flight()[0]
    pose = Pose(scene.WORLD_FROM_CAMERA, source.position_m)
    result = Pipeline(CALIBRATION, values).process(
        source.left, source.words, source.t_ns, pose, scene.UP_WORLD
    )
    assert json.loads(run.stdout) == as_line(0, result)
    assert result.obstacles[0].confirmed


def test_stills_are_judged_one_by_one(tmp_path: Path) -> None:
    values = parameters.defaults()
    values["tracker"] |= {"confirm_hits": 1, "confirm_window": 1}
    still = board_flight()[8]
    run = replay(cases.record(tmp_path / "a.rec", [still] * 3, values, stills=True))  # three at one time
    assert run.returncode == 0, run.stderr
    frames = [json.loads(line)["obstacles"] for line in run.stdout.splitlines()]
    assert [[(o["id"], o["confirmed"], o["age_frames"]) for o in frame] for frame in frames] == [
        [(index, True, 1)] for index in (1, 2, 3)
    ]
    assert len({tuple(o["position_m"]) for frame in frames for o in frame}) == 1


def test_run_after_run_the_same_bytes(recording: Path) -> None:
    first = replay(recording)
    assert replay(recording).stdout == first.stdout
    assert replay(recording, "--repeat", 3).stdout == first.stdout
    head = "".join(first.stdout.splitlines(keepends=True)[:2])
    assert replay(recording, "--frames", 2).stdout == head
    assert replay("--frames", 1000, recording).stdout == first.stdout


def test_times_of_every_frame(tmp_path: Path, recording: Path) -> None:
    run = replay(recording, "--frames", 4, "--repeat", 3, "--times", tmp_path / "times.csv")
    assert run.returncode == 0, run.stderr
    assert [line.split()[0] for line in run.stderr.splitlines()] == ["stage", *STAGES.split(",")]
    assert "of 12 frames" in run.stderr
    head, *rows = (tmp_path / "times.csv").read_text().splitlines()
    assert head == STAGES
    assert len(rows) == 4 * 3
    between_ms = []
    for row in rows:
        *stages, host_ms, cpu_ms = map(float, row.split(","))
        assert min(stages) >= 0.0 and cpu_ms >= 0.0
        between_ms.append(host_ms - sum(stages))
    # Rounded numbers; the looks at the clock, and in some frame nothing else that runs meanwhile.
    assert -1e-4 <= min(between_ms) < 0.05


# ---- memory ----


def count_allocations(counter: Path, target: Path, *arguments: object) -> int:
    run = replay(*arguments, LD_PRELOAD=str(counter), COUNT_ALLOCATIONS=str(target))
    assert run.returncode == 0, run.stderr
    return int(target.read_text())


@pytest.mark.skipif(SANITIZED, reason="AddressSanitizer replaces malloc itself")
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_frames_allocate_nothing(tmp_path: Path, recording: Path) -> None:
    counter, target = tmp_path / "count_allocations.so", tmp_path / "count"
    source = Path(__file__).with_name("count_allocations.c")
    command = ["gcc", "-std=c17", "-Wall", "-Wextra", "-Werror", "-O1", "-fPIC", "-fno-builtin", "-shared"]
    subprocess.run([*command, str(source), "-o", str(counter), "-ldl"], check=True, timeout=60)
    one_frame = count_allocations(counter, target, recording, "--frames", 1)
    assert one_frame >= 4  # pipeline, image, words, times: the counter counts
    assert count_allocations(counter, target, recording) == one_frame
    assert count_allocations(counter, target, recording, "--repeat", 5) == one_frame


@pytest.mark.skipif(SANITIZED, reason="valgrind does not run what AddressSanitizer instruments")
@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
def test_valgrind_finds_nothing(recording: Path) -> None:
    options = ["--quiet", "--error-exitcode=99", "--leak-check=full", "--show-leak-kinds=all"]
    command = ["valgrind", *options, str(REPLAY), str(recording), "--frames", "2"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    assert run.stdout == replay(recording, "--frames", 2).stdout


# ---- bad input: status 2, one line, nothing printed ----


def refused(*arguments: object) -> str:
    run = replay(*arguments)
    assert (run.returncode, run.stdout) == (2, ""), run.stderr
    assert run.stderr.startswith("replay: ") and run.stderr.count("\n") == 1
    return run.stderr


def header(**changes: object) -> bytes:
    fields = {
        "magic": b"VISTAREC",
        "version": 4,
        "width": CALIBRATION.width,
        "height": CALIBRATION.height,
        "parameters": cases.PARAMETER_COUNT,
        "focal_px": CALIBRATION.focal_px,
        "cx": CALIBRATION.cx,
        "cy": CALIBRATION.cy,
        "baseline_m": CALIBRATION.baseline_m,
        "coarser_levels": 0,
    }
    assert not changes.keys() - fields.keys()
    return HEADER.pack(*(fields | changes).values())


CUTS = {
    0: "not a recording",
    5: "not a recording",
    8: "cut off in the header",
    11: "cut off in the header",
    HEADER.size - 1: "cut off in the header",
    cases.PARAMETERS_AT: "cut off in the parameters",
    cases.PARAMETERS_AT + 47: "cut off in the parameters",
    cases.PARAMETERS_AT + PARAMETER.size + 50: "cut off in the parameters",
    cases.FRAMES_AT - 1: "cut off in the parameters",
    cases.FRAMES_AT: "no frames",
    cases.FRAMES_AT + 1: "cut off in a frame",
    cases.FRAMES_AT + 100: "cut off in a frame",
    cases.FRAMES_AT + 5000: "cut off in a frame",
    cases.FRAMES_AT + cases.FRAME_BYTES - 1: "cut off in a frame",
    cases.FRAMES_AT + cases.FRAME_BYTES + 8: "cut off in a frame",
}


@pytest.mark.parametrize("kept", CUTS)
def test_cut_off_recordings(tmp_path: Path, recording: Path, kept: int) -> None:
    path = tmp_path / "cut.rec"
    path.write_bytes(recording.read_bytes()[:kept])
    assert refused(path) == f"replay: {path}: {CUTS[kept]}\n"


BAD_HEADERS = {
    "magic": ({"magic": b"VISTAREX"}, "not a recording"),
    "version 3": ({"version": 3}, "recorded by another version of vista"),
    "version 2^31": ({"version": 1 << 31}, "recorded by another version of vista"),
    "width 0": ({"width": 0}, "cut off in a frame"),
    "width 15": ({"width": 15}, "cut off in a frame"),
    "width 8192": ({"width": 8192, "height": 8192}, "cut off in a frame"),
    "width 8193": ({"width": 8193}, "larger than 8192x8192"),
    "height 2^32 - 1": ({"height": 0xFFFFFFFF}, "larger than 8192x8192"),
    "parameters 2^32 - 1": ({"parameters": 0xFFFFFFFF}, "unknown parameter or value: "),
    "parameters one too many": ({"parameters": cases.PARAMETER_COUNT + 1}, "unknown parameter or value: "),
    "focal length NaN": ({"focal_px": float("nan")}, "a number is not finite"),
    "baseline 0": ({"baseline_m": 0.0}, "range"),
}


@pytest.mark.parametrize("name", BAD_HEADERS)
def test_bad_headers(tmp_path: Path, recording: Path, name: str) -> None:
    changes, message = BAD_HEADERS[name]
    path = tmp_path / "bad.rec"
    path.write_bytes(header(**changes) + recording.read_bytes()[HEADER.size :])
    line = refused(path)
    assert line.startswith(f"replay: {path}: ") and message in line


@pytest.mark.parametrize("size,message", [((0, 240), "range"), ((15, 16), "size"), ((16, 15), "size")])
def test_images_of_no_size(tmp_path: Path, recording: Path, size: tuple[int, int], message: str) -> None:
    path = tmp_path / "bad.rec"
    recorded = recording.read_bytes()[cases.PARAMETERS_AT : cases.FRAMES_AT]
    frame = bytes(FRAME.size + 3 * size[0] * size[1])
    path.write_bytes(header(width=size[0], height=size[1]) + recorded + frame)
    assert message in refused(path)


def test_the_header_above_is_the_recorders(recording: Path) -> None:
    assert recording.read_bytes().startswith(header())


BAD_PARAMETERS = {
    (b"foveation.rho", b"", 4.0): "unknown parameter or value: foveation.rho",
    (b"", b"", 4.0): "unknown parameter or value: ",
    (b"two\nlines\x1b", b"", 4.0): "unknown parameter or value: two?lines?",
    (b"x" * 48, b"", 4.0): "unknown parameter or value: " + 48 * "x",
    (b"foveation.rho_0_px", b"", float("nan")): "unknown parameter or value: foveation.rho_0_px",
    (b"foveation.rho_0_px", b"", 0.5): "foveation.rho_0_px is out of range",
    (b"affinity.form", b"", -1.0): "affinity.form is out of range",
    (b"tracker.confirm_window", b"", 2.0): "tracker.confirm_hits is out of range",
    (b"affinity.form", b"none", 0.0): "unknown parameter or value: affinity.form",
    (b"region.foot_m", b"sum", 0.0): "unknown parameter or value: region.foot_m",
}


@pytest.mark.parametrize("given", BAD_PARAMETERS, ids=BAD_PARAMETERS.get)
def test_bad_parameters(tmp_path: Path, recording: Path, given: tuple[bytes, bytes, float]) -> None:
    path = tmp_path / "bad.rec"
    frames = recording.read_bytes()[cases.FRAMES_AT :]
    path.write_bytes(header(parameters=1) + PARAMETER.pack(*given) + frames)
    assert refused(path) == f"replay: {path}: {BAD_PARAMETERS[given]}\n"


def poke(at: int, content: bytes) -> Callable[[bytearray], None]:
    def change(data: bytearray) -> None:
        data[at : at + len(content)] = content

    return change


SECOND_FRAME = cases.FRAMES_AT + cases.FRAME_BYTES
BAD_FRAMES = {
    "time stands still": (poke(SECOND_FRAME, struct.pack("<q", scene.START_NS)), "do not increase"),
    "NaN in the pose": (poke(SECOND_FRAME + 20, struct.pack("<d", float("nan"))), "a number is not finite"),
    "zeros as rotation": (poke(SECOND_FRAME + 20, bytes(72)), "range"),
}


@pytest.mark.parametrize("name", BAD_FRAMES)
def test_a_bad_frame_ends_the_replay(tmp_path: Path, recording: Path, name: str) -> None:
    change, message = BAD_FRAMES[name]
    data = bytearray(recording.read_bytes())
    change(data)
    path = tmp_path / "bad.rec"
    path.write_bytes(data)
    run = replay(path)
    assert run.returncode == 2
    assert run.stdout == replay(recording, "--frames", 1).stdout  # whole lines of the frames before
    assert run.stderr.startswith(f"replay: {path}: ") and run.stderr.count("\n") == 1
    assert message in run.stderr


BAD_OPTIONS = [
    [],
    ["--frames"],
    ["RECORDING", "--frames"],
    ["RECORDING", "--frames", "0"],
    ["RECORDING", "--frames", "-3"],
    ["RECORDING", "--frames", "2x"],
    ["RECORDING", "--frames", ""],
    ["RECORDING", "--repeat", "1000001"],
    ["RECORDING", "--repeat", "99999999999999999999"],
    ["RECORDING", "--times"],
    ["RECORDING", "--fast"],
    ["RECORDING", "RECORDING"],
]


@pytest.mark.parametrize("options", BAD_OPTIONS, ids=" ".join)
def test_bad_options(recording: Path, options: list[str]) -> None:
    line = refused(*(recording if option == "RECORDING" else option for option in options))
    assert line.startswith("replay: usage: replay RECORDING")


def test_files_that_cannot_be_opened(tmp_path: Path) -> None:
    missing = tmp_path / "missing.rec"
    assert refused(missing) == f"replay: {missing}: No such file or directory\n"
    assert refused(tmp_path) == f"replay: {tmp_path}: not a recording\n"


def test_files_that_cannot_be_written(recording: Path) -> None:
    run = replay(recording, "--times", "/missing/times.csv")
    assert run.returncode == 2
    assert run.stderr.splitlines()[-1] == "replay: /missing/times.csv: No such file or directory"
    with Path("/dev/full").open("w") as full:
        environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
        command = [str(REPLAY), str(recording)]
        run = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, env=environment)
    assert (run.returncode, run.stderr) == (2, "replay: stdout: cannot be written\n")
