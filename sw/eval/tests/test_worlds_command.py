"""`vista worlds`: families by name, rendering that continues, and what may be scored of the test set."""

from __future__ import annotations

import argparse
from pathlib import Path

import pytest
from command_line import Vista, assert_refused, call
from small_worlds import small_families
from vista_eval.command import worlds as command
from vista_eval.worlds.sampled import catalog


@pytest.fixture
def families(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalog, "FAMILIES", small_families(one="dev", two="dev", three="test"))


@pytest.fixture
def vista(capsys: pytest.CaptureFixture[str]) -> Vista:
    return lambda *arguments: call(capsys, *arguments)


def test_the_list_tells_the_split(vista: Vista, tmp_path: Path) -> None:
    status, printed, _ = vista("worlds", tmp_path, "--list")
    lines = [line.split() for line in printed.splitlines()]
    assert status == 0 and len(lines) == len(catalog.FAMILIES)
    assert {line[0]: line[1] for line in lines} == {n: f.split for n, f in catalog.FAMILIES.items()}


@pytest.mark.slow
def test_a_split_is_rendered_and_continued(families: None, vista: Vista, tmp_path: Path) -> None:
    arguments = ("worlds", tmp_path, "--count", 2, "--render-only", "--jobs", 1)
    assert vista(*arguments)[0] == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one_000", "one_001", "two_000", "two_001"]
    images = sorted((tmp_path / "one_000" / "mav0" / "cam0" / "data").iterdir())
    first, second = (image.read_bytes() for image in images)
    images[1].unlink()
    (tmp_path / "one_000" / "truth.json").unlink()
    kept_ns = images[0].stat().st_mtime_ns
    assert vista(*arguments)[0] == 0
    assert [image.read_bytes() for image in images] == [first, second]
    assert images[0].stat().st_mtime_ns == kept_ns
    other = tmp_path / "other"
    assert vista("worlds", other, "--family", "two", "--seed", 5, "--count", 1, "--render-only")[0] == 0
    assert [path.name for path in other.iterdir()] == ["two_000"]
    theirs = next((other / "two_000" / "mav0" / "cam0" / "data").iterdir()).read_bytes()
    assert theirs != next((tmp_path / "two_000" / "mav0" / "cam0" / "data").iterdir()).read_bytes()


def test_a_family_of_another_split_is_refused(families: None, vista: Vista, tmp_path: Path) -> None:
    assert_refused(vista("worlds", tmp_path, "--family", "three"), "no family three in the split dev")
    assert_refused(vista("worlds", tmp_path, "--family", "four"), "no family four")


def test_a_rival_that_nobody_knows_is_refused(families: None, vista: Vista, tmp_path: Path) -> None:
    assert_refused(vista("worlds", tmp_path / "none", "--beside", "four paths", "SGM"), "no rival 'SGM'")
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("option", [("--seed", 2), ("--count", 8), ("--family", "three")])
def test_the_test_set_is_scored_as_frozen_only(
    families: None, vista: Vista, tmp_path: Path, option: tuple[str, object]
) -> None:
    assert_refused(vista("worlds", tmp_path, "--split", "test", *option), "is scored as frozen")
    assert not list(tmp_path.iterdir())


def test_the_size_of_a_set_is_the_catalogs_unless_said() -> None:
    asked = argparse.Namespace(count=None, seed=None, split="test", family=[], render_only=False)
    assert command.size_of_set(asked) == (catalog.COUNT, catalog.SEED)
