"""vista-fly corrects a camera that turns in flight as `vista run` does, and says when it cannot."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from fake_autopilot import Autopilot
from fly_process import SANITIZED, allocations_of_one_pass_and_ten, compare, fly, frames_at, prepare, timeless
from fly_shared import flying
from shared_data import SHARED_DATA
from turned_camera import degrees
from turned_recordings import RAW, write_turned_asl, write_turned_kitti, write_turned_pairs
from vista.alignment import Turn

pytestmark = [pytest.mark.native, pytest.mark.slow]

EUROC, KITTI = SHARED_DATA / "euroc_v101", SHARED_DATA / "kitti_odometry" / "sequences" / "00"
ON = '[alignment]\ncorrect = "on"\n'
FRAMES, FIRST = 30, 8


def said(run: subprocess.CompletedProcess[str]) -> tuple[float, float, int]:
    """Pitch and roll that were corrected at the end, and how often that changed."""
    found = re.search(r"by (\S+) degrees in pitch, (\S+) in roll at the end; changed (\d+) times", run.stderr)
    assert found is not None, run.stderr
    return float(found[1]), float(found[2]), int(found[3])


def corrected(run: subprocess.CompletedProcess[str], turn: Turn) -> None:
    pitch_deg, roll_deg, changes = said(run)
    assert pitch_deg == pytest.approx(turn.pitch_deg, abs=0.06)
    assert roll_deg == pytest.approx(turn.roll_deg, abs=0.12)
    assert 1 <= changes <= 5


def corrected_flight(folder: Path, flight: Path) -> list[object]:
    """The options that play it with the correction on."""
    (folder / "my.toml").write_text(ON)
    return prepare(folder, flight, "--config", folder / "my.toml")


DRAWN = degrees(-0.5, 0.4)


# Tests below fly rectified pairs and radial lenses as well.
SAME_C = [pytest.param(lens, marks=pytest.mark.same_c) for lens in (None, *RAW) if lens != "fisheye"]


@pytest.fixture(scope="module", params=[*SAME_C, "fisheye"])
def drawn_flight(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Rectified pairs, and lenses of each kind."""
    folder = tmp_path_factory.mktemp("drawn") / "flight"
    return write_turned_pairs(folder, DRAWN, FIRST, FRAMES, request.param)


@pytest.mark.parametrize(
    "rows",
    [pytest.param(0, id="maps"), pytest.param(128, id="control grids", marks=pytest.mark.same_c)],
)
def test_a_drawn_flight(tmp_path: Path, drawn_flight: Path, rows: int) -> None:
    lines, run = compare(tmp_path, drawn_flight, f"{ON}[stereo]\nrectify_rows = {rows}\n", FRAMES)
    corrected(run, DRAWN)
    states = [json.loads(line)["health"] for line in lines]
    for state in states:  # in this texture everything moves alike, and not as the poses say
        moved = {"motion_doubtful", "disparities_off"}
        state["reasons"] = [reason for reason in state["reasons"] if reason not in moved]
    assert states[FIRST] == {"state": "blind", "reasons": ["rows_misaligned"]}
    assert states[FIRST - 1]["reasons"] == states[-1]["reasons"] == []


@pytest.mark.same_c
@pytest.mark.skipif(not EUROC.is_dir(), reason="EuRoC V1_01 is not there")
@pytest.mark.parametrize("rows", [0, 128])
def test_a_room(tmp_path: Path, rows: int) -> None:
    turn = degrees(0.5, 0.0)
    room = write_turned_asl(EUROC, tmp_path / "room", turn, FIRST, FRAMES)
    _, run = compare(tmp_path, room, f"{ON}[stereo]\nrectify_rows = {rows}\n", FRAMES)
    corrected(run, turn)


@pytest.mark.same_c
@pytest.mark.skipif(not KITTI.is_dir(), reason="KITTI odometry 00 is not there")
def test_a_street(tmp_path: Path) -> None:
    turn = degrees(0.5, 0.0)
    street = write_turned_kitti(KITTI, tmp_path / "street", turn, FIRST, FRAMES)
    _, run = compare(tmp_path, street, ON, FRAMES)
    corrected(run, turn)


@pytest.mark.skipif(SANITIZED, reason="AddressSanitizer replaces malloc itself")
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_maps_are_made_without_the_heap(tmp_path: Path) -> None:
    """Each of ten passes over the frames makes a new one."""
    flight = write_turned_pairs(tmp_path / "flight", degrees(0.5, 0.0), 2, 16, "radial")
    counts, run = allocations_of_one_pass_and_ten(tmp_path, corrected_flight(tmp_path, flight))
    assert counts[0] == counts[1]
    assert said(run)[2] >= 10


def test_a_turn_that_is_too_large_reaches_the_autopilot(tmp_path: Path) -> None:
    played = corrected_flight(tmp_path, write_turned_pairs(tmp_path / "flight", degrees(3.0, 0.0), 10, 60))
    autopilot = Autopilot()
    try:
        options = ["--to", autopilot.target, "--repeat"]
        with flying(*played, *options, "--out", tmp_path / "lines.jsonl"):
            deadline_s = time.monotonic() + 60.0
            while time.monotonic() < deadline_s and not any(
                "alignment_lost" in text for text in heard(autopilot)
            ):
                time.sleep(0.05)
        assert any("alignment_lost" in text for text in heard(autopilot)), heard(autopilot)
    finally:
        autopilot.close()


def heard(autopilot: Autopilot) -> list[str]:
    return [message.text for _, message in autopilot.of_kind("STATUSTEXT")]


def test_another_flight_begins_with_the_calibration(tmp_path: Path) -> None:
    """The same flight twice, in one file."""
    flight = write_turned_pairs(tmp_path / "flight", degrees(0.4, 0.0), 3, 16, "radial")
    played = Path(str(corrected_flight(tmp_path, flight)[1]))
    content = played.read_bytes()
    (tmp_path / "twice.vista").write_bytes(content + content[frames_at(played) :])
    options = ["--all-frames", "--out", tmp_path / "lines.jsonl"]
    run = fly("--recording", tmp_path / "twice.vista", *options)
    assert "1 restarts" in run.stderr
    lines = [re.sub('"id": [0-9]+', "", line) for line in timeless(tmp_path / "lines.jsonl")]  # ids go on
    assert not any("time_jump" in line for line in lines[:16]) and "time_jump" in lines[16]
    without_health = [re.sub('"health": .*?]}', "", line) for line in lines]
    assert without_health[:16] == without_health[16:]
    assert said(run)[2] >= 2 and said(run)[2] % 2 == 0
