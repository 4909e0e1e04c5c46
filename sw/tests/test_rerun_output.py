"""`vista run --rerun`: what Rerun's own reader finds in the file, and bad targets."""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused
from rerun.chunk import RrdReader
from vista.report.labels import obstacle_name

OBSTACLES = "/world/camera/obstacles"


@pytest.fixture
def board(tmp_path: Path) -> Path:
    """A board before a wall."""
    return cases.make_board_scenes(tmp_path / "board", 6, stills=False)


def logged(file: Path) -> dict[str, dict[int, dict[str, Any]]]:
    """What each entity has in each frame: the last part of a component's name -> value."""
    found: dict[str, dict[int, dict[str, Any]]] = defaultdict(dict)
    for chunk in RrdReader(file).stream():
        if chunk.is_static or chunk.is_empty:
            continue
        batch = chunk.to_record_batch()
        names = batch.schema.names
        for k, frame in enumerate(batch["frame"].to_pylist() if "frame" in names else ()):
            values = {name.rpartition(":")[2]: batch[name][k].as_py() for name in names if ":" in name}
            found[chunk.entity_path].setdefault(frame, {}).update(values)
    return found


def test_the_boards_are_where_the_lines_say(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    file = tmp_path / "run.rrd"
    assert run_vista("run", board, "--out", tmp_path / "out", "--rerun", file)[0] == 0
    lines = [json.loads(line) for line in (tmp_path / "out" / "obstacles.jsonl").read_text().splitlines()]
    entities = logged(file)
    boards, sigmas = entities[f"{OBSTACLES}/boards"], entities[f"{OBSTACLES}/one_sigma"]
    seen = 0
    for line in lines:
        shown = [obstacle for obstacle in line["obstacles"] if obstacle["confirmed"]]
        values = boards.get(line["frame"])
        assert (values is not None) == bool(shown)
        if values is None:
            continue
        seen += 1
        centers = np.array(values["centers"]).reshape(-1, 3)
        np.testing.assert_allclose(centers, [o["position_camera_m"] for o in shown], atol=6e-4)
        labels = [f"{obstacle_name(o['id'])} {o['distance_m']:.1f} m" for o in shown]
        assert [label.rpartition(" ")[0] for label in values["labels"]] == [
            label.rpartition(" ")[0] for label in labels
        ]
        half_sizes = np.array(sigmas[line["frame"]]["half_sizes"]).reshape(-1, 3)
        variances = [np.linalg.eigvalsh(np.array(o["covariance_m2"])) for o in shown]
        np.testing.assert_allclose(half_sizes, np.maximum(np.sqrt(variances), 0.05), rtol=2e-2)
    assert seen > 0


def test_pictures_depths_and_figures(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    file = tmp_path / "run.rrd"
    assert run_vista("run", board, "--out", tmp_path / "out", "--rerun", file)[0] == 0
    entities = logged(file)
    frames = set(range(6))
    for name in ("/world/camera/left", "/world/camera/depth", "/overlay", "/figures/path_seen_m"):
        assert set(entities[name]) == frames
    depth = entities["/world/camera/depth"][5]
    pixels = np.frombuffer(np.array(depth["buffer"], np.uint8).tobytes(), "<f4").reshape(240, 320)
    near_m = 300.0 * 0.5 / cases.BOARD_DISPARITY_PX
    assert np.median(pixels[80:160, 160:200]) == pytest.approx(near_m, rel=0.02)
    assert pixels.min() == 0.0
    assert "/world/camera" not in entities  # there are no poses
    assert [file.name for file in tmp_path.iterdir() if file.name.startswith(".")] == []


def test_bad_targets_take_one_line(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    (tmp_path / "there.rrd").write_text("something")
    for target, text in (
        (tmp_path / "there.rrd", "exists; name a new file"),
        (tmp_path / "no" / "run.rrd", "cannot be written"),
        ("rerun+http://192.0.2.1:9876/proxy", "no viewer on this machine"),
    ):
        outcome = run_vista("run", board, "--out", tmp_path / "out", "--rerun", target)
        assert_refused(outcome, text)
    assert (tmp_path / "there.rrd").read_text() == "something"


def test_frames_before_an_error_are_kept(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    sorted(board.glob("*_left.png"))[3].write_bytes(b"no image")
    file = tmp_path / "run.rrd"
    status, _, err = run_vista("run", board, "--out", tmp_path / "out", "--rerun", file)
    assert status == 2 and "scene03_left.png" in err
    assert set(logged(file)["/overlay"]) == {0, 1, 2}


def test_the_extra_is_named_where_it_is_missing(
    tmp_path: Path, board: Path, run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "vista.rerun_log", None)
    outcome = run_vista("run", board, "--out", tmp_path / "out", "--rerun", tmp_path / "run.rrd")
    assert_refused(outcome, "needs the extra [rerun]")
