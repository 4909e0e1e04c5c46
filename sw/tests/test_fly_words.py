"""vista-fly over recorded words: passes, times and threads; nothing is allocated, and valgrind is silent."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import board_flight as scene
import pytest
import recording_cases as cases
from board_flight import board_flight
from fly_process import SANITIZED, VISTA_FLY, environment, fly, timeless
from pipeline_library import CALIBRATION
from vista.geometry import Pose
from vista.pipeline import Pipeline

pytestmark = pytest.mark.native

FRAMES = 9
STAGES = (
    "rectify,stereo,alignment,watch,motion,noise,words,foveation,health,surface,affinity,segmentation,refinement,regions,"
    "thin,reconstruction,tracking,blind_zone,terrain,space,map,footing,host,cpu,latency"
)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return cases.record(tmp_path_factory.mktemp("words") / "board.vista", board_flight()[:FRAMES])


def lines(recording: Path, folder: Path, *options: object) -> list[str]:
    target = folder / "lines.jsonl"
    target.unlink(missing_ok=True)
    run = fly("--recording", recording, "--all-frames", "--out", target, *options)
    assert run.returncode == 0, run.stderr
    return timeless(target)


@pytest.mark.parametrize("levels", [1, 2, 4])
def test_it_finds_what_the_pipeline_finds(tmp_path: Path, levels: int) -> None:
    flown = cases.record(tmp_path / "a.vista", board_flight()[:FRAMES], levels=levels)
    found = lines(flown, tmp_path)
    assert lines(flown, tmp_path, "--threads", 2) == found
    pipeline = Pipeline(CALIBRATION)
    for source, line in zip(board_flight()[:FRAMES], map(json.loads, found), strict=True):
        pose = Pose(scene.WORLD_FROM_CAMERA, source.position_m)
        words = cases.levels_of(source, levels)
        result = pipeline.process(source.left, words, source.t_ns, pose, scene.UP_WORLD)
        assert line["regions"] == result.outcome.region_count
        assert [(o["id"], o["distance_m"]) for o in line["obstacles"]] == [
            (o.id, round(o.distance_m, 3)) for o in result.obstacles if o.confirmed
        ]
    assert json.loads(found[-1])["nearest_collision"] is not None


def test_stills_are_judged_one_by_one(tmp_path: Path) -> None:
    still = board_flight()[8]
    found = lines(cases.record(tmp_path / "a.vista", [still] * 3, stills=True), tmp_path)  # at one time
    things = [
        [(o["id"], o["confirmed"], o["age_frames"]) for o in json.loads(line)["obstacles"]] for line in found
    ]
    assert things == [[(index, True, 1)] for index in (1, 2, 3)]


def test_the_first_frames_and_several_passes(tmp_path: Path, recording: Path) -> None:
    first = lines(recording, tmp_path)
    assert lines(recording, tmp_path) == first
    assert lines(recording, tmp_path, "--frames", 2) == first[:2]
    passes = lines(recording, tmp_path, "--passes", 3)
    assert len(passes) == 3 * FRAMES and passes[:FRAMES] == first


def test_times_of_every_frame(tmp_path: Path, recording: Path) -> None:
    lines(recording, tmp_path, "--frames", 4, "--passes", 3, "--times", tmp_path / "times.csv")
    head, *rows = (tmp_path / "times.csv").read_text().splitlines()
    assert head == STAGES
    assert len(rows) == 4 * 3
    between_ms = []
    for row in rows:
        *stages, host_ms, cpu_ms, latency_ms = map(float, row.split(","))
        assert min(stages) >= 0.0 and cpu_ms > 0.0 and latency_ms >= host_ms
        between_ms.append(host_ms - sum(stages[4:]))
    # Rounded numbers; the looks at the clock, and in some frame nothing else that runs meanwhile.
    assert -1e-4 <= min(between_ms) < 0.05


def test_times_that_cannot_be_written(recording: Path) -> None:
    run = fly("--recording", recording, "--all-frames", "--times", "/missing/times.csv")
    assert run.returncode == 2
    assert run.stderr.splitlines()[-1] == "vista-fly: /missing/times.csv: no such file or directory"


def test_a_pose_that_is_no_rotation_ends_the_tracks(tmp_path: Path) -> None:
    flown = board_flight()[:FRAMES]
    recording = cases.record(tmp_path / "a.vista", flown)
    content = bytearray(recording.read_bytes())
    frame_bytes = (len(content) - len(cases.record(tmp_path / "b.vista", flown[:1]).read_bytes())) // (
        FRAMES - 1
    )
    at = len(content) - frame_bytes + 16
    content[at : at + 72] = bytes(72)
    recording.write_bytes(content)
    run = fly("--recording", recording, "--all-frames")
    assert run.returncode == 0
    assert f"{FRAMES - 1} frames processed" in run.stderr and "1 refused" in run.stderr


@pytest.mark.skipif(SANITIZED, reason="AddressSanitizer replaces malloc itself")
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_frames_allocate_nothing(tmp_path: Path, recording: Path) -> None:
    counter, target = tmp_path / "count_allocations.so", tmp_path / "count"
    source = Path(__file__).with_name("count_allocations.c")
    command = ["gcc", "-std=c17", "-Wall", "-Wextra", "-Werror", "-O1", "-fPIC", "-fno-builtin", "-shared"]
    subprocess.run([*command, str(source), "-o", str(counter), "-ldl"], check=True, timeout=60)
    counts = []
    for options in (["--frames", 1], [], ["--passes", 5]):
        more = {"LD_PRELOAD": str(counter), "COUNT_ALLOCATIONS": str(target)}
        run = fly("--recording", recording, "--all-frames", *options, **more)
        assert run.returncode == 0, run.stderr
        counts.append(int(target.read_text()))
    assert counts[0] >= 4  # the detector, images and words: the counter counts
    assert counts == counts[:1] * 3


@pytest.mark.slow
@pytest.mark.skipif(SANITIZED, reason="valgrind does not run what AddressSanitizer instruments")
@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
def test_valgrind_finds_nothing(recording: Path) -> None:
    options = ["--quiet", "--error-exitcode=99", "--leak-check=full", "--show-leak-kinds=all"]
    command = ["valgrind", *options, VISTA_FLY, "--recording", recording, "--all-frames", "--frames", "2"]
    run = subprocess.run(
        [str(part) for part in (*command, "--watchdog", 300)],
        capture_output=True,
        text=True,
        timeout=300,
        env=environment(),
    )
    assert run.returncode == 0, run.stderr
