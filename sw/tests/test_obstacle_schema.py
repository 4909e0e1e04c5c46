"""The published schema of obstacles.jsonl: whole, valid, and what real runs write."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sequence_cases as cases
import vista.chain
from command_line import Vista, call
from fake_pipeline import FakeDetector
from jsonschema import Draft202012Validator, ValidationError
from obstacle_schema import SCHEMA, VALIDATOR, valid_lines
from shared_data import REPOSITORY, SHARED_DATA
from vista.cli import main
from vista.health.finding import Reason, State
from vista.obstacle_line import schema_text
from vista.sequence import open_sequence

pytestmark = pytest.mark.slow

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"


@pytest.fixture
def run_vista(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Vista:
    monkeypatch.setattr(vista.chain, "Detector", FakeDetector)
    return partial(call, capsys)


def parts(schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The schema of every key, at any depth."""
    for content in schema.get("properties", {}).values():
        yield content
        yield from parts(content)
    if "items" in schema:
        yield from parts(schema["items"])


def test_the_schema_is_valid_and_describes_every_key() -> None:
    Draft202012Validator.check_schema(SCHEMA)
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert SCHEMA["required"] == list(SCHEMA["properties"])
    described = list(parts(SCHEMA))
    assert len(described) > 25
    for part in described:
        assert part["title"] and part["description"].endswith(".")


def test_one_schema_in_package_documentation_and_command(run_vista: Vista) -> None:
    assert (REPOSITORY / "doc" / "obstacles.schema.json").read_text() == schema_text()
    assert run_vista("config", "--schema") == (0, schema_text(), "")


@pytest.mark.parametrize("make", [cases.make_asl, cases.make_kitti, cases.make_flown_pairs, cases.make_pairs])
@pytest.mark.parametrize("options", [[], ["--all-tracks"]])
def test_lines_of_every_layout(tmp_path: Path, run_vista: Vista, make, options: list[str]) -> None:
    folder = make(tmp_path / "flight")
    assert run_vista("run", folder, "--out", tmp_path / "out", *options)[0] == 0
    lines = valid_lines(tmp_path / "out")
    unconfirmed = [o for line in lines for o in line["obstacles"] if not o["confirmed"]]
    assert bool(unconfirmed) == bool(options)
    assert {line["motion"] for line in lines} == {"unknown" if make is cases.make_pairs else "known"}


def test_positions_in_world_and_camera(tmp_path: Path, run_vista: Vista) -> None:
    """KITTI: the camera has flown 1 m a frame along its axis."""
    folder = cases.make_kitti(tmp_path / "flight")
    assert run_vista("run", folder, "--out", tmp_path / "out")[0] == 0
    for line in valid_lines(tmp_path / "out"):
        for obstacle in line["obstacles"]:
            moved_m = np.subtract(obstacle["position_m"], obstacle["position_camera_m"])
            np.testing.assert_allclose(moved_m, [0.0, 0.0, line["frame"]], atol=1e-9)


def test_lines_of_the_real_pipeline(tmp_path: Path) -> None:
    folder = cases.make_board_scenes(tmp_path / "pairs", 5, stills=False)
    assert main(["run", str(folder), "--out", str(tmp_path / "out"), "--no-overlay"]) == 0
    lines = valid_lines(tmp_path / "out")
    assert lines[-1]["obstacles"] and lines[-1]["nearest_collision"]


@pytest.mark.skipif(not STREET.is_dir(), reason="KITTI odometry 00 is not there")
def test_lines_of_a_real_street(tmp_path: Path) -> None:
    """Confirmed obstacles take a tenth of what every track took, and each stands where its ellipse is."""
    options = ["--no-overlay", "--frames", "0:12"]
    assert main(["run", str(STREET), "--out", str(tmp_path / "few"), *options]) == 0
    assert main(["run", str(STREET), "--out", str(tmp_path / "all"), *options, "--all-tracks"]) == 0
    lines = valid_lines(tmp_path / "few")
    assert all(line["health"] == {"state": "healthy", "reasons": []} for line in lines)
    few, every = ((tmp_path / name / "obstacles.jsonl").stat().st_size for name in ("few", "all"))
    assert few < 0.2 * every
    camera = open_sequence(STREET).calibration.left.matrix
    for obstacle in lines[-1]["obstacles"]:
        u, v, w = camera @ obstacle["position_camera_m"]
        if not obstacle["coasting"]:
            # Of a large thing far away a frame may show a part only: its extent is that of all frames.
            extent_px = max(obstacle["extent_m"]) * camera[0, 0] / w
            reach_px = max(obstacle["ellipse_px"]["axes"][0], extent_px / 2) + 10.0
            np.testing.assert_allclose([u / w, v / w], obstacle["ellipse_px"]["center"], atol=reach_px)


def test_a_line_of_another_version_is_refused(tmp_path: Path, run_vista: Vista) -> None:
    assert run_vista("run", cases.make_pairs(tmp_path / "pairs", 1), "--out", tmp_path / "out")[0] == 0
    line = valid_lines(tmp_path / "out")[0]
    for change in ({"version": 1}, {"motion": "perhaps"}, {"health": {"state": "clear", "reasons": []}}):
        with pytest.raises(ValidationError):
            VALIDATOR.validate(line | change)
    with pytest.raises(ValidationError):
        VALIDATOR.validate({key: value for key, value in line.items() if key != "health"})


def test_the_schema_explains_every_reason() -> None:
    reasons = SCHEMA["properties"]["health"]["properties"]["reasons"]
    assert reasons["items"]["enum"] == list(Reason)
    assert all(f"{reason}: " in reasons["description"] for reason in Reason)
    assert SCHEMA["properties"]["health"]["properties"]["state"]["enum"] == list(State)
