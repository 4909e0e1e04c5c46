"""vista scenes on two small scenes: one in each half, nothing rendered."""

from __future__ import annotations

import json
import re
from pathlib import Path

import flight_on_disk as disk
import pytest
from vista.cli import main
from vista.errors import EXIT_INPUT, EXIT_OK


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    disk.write_flight(tmp_path / "scene_0000", frames=1, last_range_m=20.0, split="dev")
    disk.write_flight(tmp_path / "scene_0001", frames=1, last_range_m=24.0, split="test")
    return tmp_path


@pytest.mark.slow
def test_scenes_are_scored_by_half(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", str(folder), "--no-render"]) == EXIT_OK
    scores = json.loads((folder / "scenes.json").read_text())
    assert list(scores["halves"]) == ["dev", "test"]
    assert [scene["name"] for scene in scores["scenes"]] == ["scene_0000", "scene_0001"]
    for scene in scores["scenes"]:
        cut = scene["partitions"]["cut"]["things"]
        assert {one["thing"]["name"] for one in cut} == {"sign", "wall"}
        limit = scene["partitions"]["grid limit"]["things"]
        for one, best in zip(cut, limit, strict=True):
            assert 0.0 <= one["iou"] <= 1.0
            assert best["iou"] > 0.5
    printed = capsys.readouterr().out
    for name in (
        "cut",
        "reference method",
        "reference method, surfaces",
        "grid limit",
        "cut - reference method, 95 %",
    ):
        assert re.search(rf"^{name} +[-0-9.]", printed, re.MULTILINE), name
    page = (folder / "scenes.html").read_text()
    assert page.count("data:image/jpeg;base64,") == 2
    assert "http" not in page  # nothing from outside


@pytest.mark.slow
def test_the_same_scenes_score_the_same(folder: Path) -> None:
    assert main(["scenes", str(folder), "--no-render"]) == EXIT_OK
    first = json.loads((folder / "scenes.json").read_text())
    assert main(["scenes", str(folder), "--no-render"]) == EXIT_OK
    again = json.loads((folder / "scenes.json").read_text())
    assert again["scenes"] == first["scenes"]
    assert again["halves"] == first["halves"]


def test_an_empty_folder_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", str(tmp_path), "--no-render"]) == EXIT_INPUT
    assert capsys.readouterr().err == f"vista: {tmp_path}: holds no labelled scenes\n"


def test_damaged_truth_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    label = next((folder / "scene_0001" / "truth" / "label").iterdir())
    label.write_bytes(b"")
    assert main(["scenes", str(folder), "--no-render"]) == EXIT_INPUT
    assert str(label) in capsys.readouterr().err
    assert not (folder / "scenes.json").exists()


def test_every_interval_is_drawn_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bootstraps are the slowest part of scoring: the table and scenes.json share them."""
    from vista_eval.metrics.scenes import REFERENCES
    from vista_eval.metrics.segmentation import STATISTICS
    from vista_eval.suites import scenes

    drawn = []

    def difference_interval(*arguments: object) -> tuple[float, float]:
        drawn.append(arguments)
        return 0.0, 0.0

    monkeypatch.setattr(scenes, "difference_interval", difference_interval)
    assert main(["scenes", str(folder), "--no-render", "--jobs", "1"]) == EXIT_OK
    assert len(drawn) == 2 * len(REFERENCES) * len(STATISTICS)
