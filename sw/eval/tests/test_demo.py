"""What `make demo` shows: an outdoor flight with the sign that is detected, and a forest, flown through."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from vista.cli import main
from vista_eval.render.flight import Flight, render_flight
from vista_eval.render.rig import LEFT
from vista_eval.worlds.farm import SIGN_AT_30_FT_S

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
FRAMES = 9


def beginning() -> Flight:
    """The first frames of the demo's flight."""
    whole = SIGN_AT_30_FT_S.approach
    cut_s = (whole.frames - FRAMES) / whole.rate_hz
    last_range_m = whole.last_range_m + whole.speed_m_s * cut_s
    approach = replace(
        whole, frames=FRAMES, last_range_m=last_range_m, sway_phase_s=whole.sway_phase_s - cut_s
    )
    return replace(SIGN_AT_30_FT_S, approach=approach)


def commands() -> str:
    return subprocess.run(
        ["make", "--dry-run", "--no-print-directory", "demo"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def test_the_flight_comes_before_the_stills() -> None:
    told = commands()
    runs = re.findall(r"vista run (\S+)", told)
    assert [Path(folder).name for folder in runs] == ["flight", "oak-d"]
    assert told.rindex("flight-out/report.html") < told.rindex("oak-d-out/report.html")


def test_the_planner_flies_through_the_forest_that_is_shown(tmp_path: Path) -> None:
    pytest.importorskip("rotorpy")
    told = commands()
    options = re.search(r"vista fly \S+ (.*?) --films", told)
    film = re.search(r"forest/(\S+)/flight\.webm", told)
    assert options and film
    assert main(["fly", str(tmp_path), *options[1].split(), "--jobs", "1"]) == 0
    found = json.loads((tmp_path / film[1] / "flight.jsonl").read_text().splitlines()[0])
    assert (found["end"], found["stops"]) == ("reached", 0)
    assert found["evasions"] > 0


def test_the_first_picture_is_a_correct_detection(tmp_path: Path) -> None:
    flight = beginning()
    for _ in render_flight(flight, tmp_path / "flight"):
        pass
    assert main(["run", str(tmp_path / "flight"), "--out", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "report.html").read_text()
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])
    opened = data["frames"][data["shown"]]
    assert opened["hit"] is not None and opened["uri"].startswith("data:image/jpeg")

    sign_m = np.array([0.0, 0.0, flight.approach.altitude_m])
    lines = [json.loads(line) for line in (tmp_path / "out" / "obstacles.jsonl").read_text().splitlines()]
    found = lines[data["shown"]]["nearest_collision"]
    assert np.linalg.norm(np.array(found["position_m"]) - sign_m) < 2.0
    world_from_camera = flight.approach.state_at(data["shown"]).world_from_body @ flight.rig.body_from_camera(
        LEFT
    )
    u, v = flight.rig.project((np.linalg.inv(world_from_camera) @ [*sign_m, 1.0])[:3])
    ellipse = next(e for e in opened["ellipses"] if e[0] == found["id"])
    assert np.hypot(ellipse[1] - u, ellipse[2] - v) < max(ellipse[3], ellipse[4])
    assert all(line["nearest_collision"] is None for line in lines[: data["shown"]])
