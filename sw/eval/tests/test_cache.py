"""What is kept: found once for a digest, again for another one, from a damaged file, or when asked to.

What a digest of code changes with: all code that a module imports, and no comment."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import flight_on_disk as disk
import numpy as np
import pytest
from vista_eval.cache import (
    Roots,
    code_digest,
    code_of,
    digest_of,
    flight_files,
    kept,
    module_code,
    our_packages,
    to_json,
)

pytestmark = pytest.mark.slow


@pytest.fixture
def ask(tmp_path: Path) -> Callable[..., list[int]]:
    """Asks for what is kept in one file; the answer says how many times it has been looked for."""
    times = [0]

    def find() -> tuple[int, ...]:
        times[0] += 1
        return tuple(times)

    def ask(digest: str, **options: bool) -> list[int]:
        return list(kept(tmp_path / "kept.json", digest, find, list, **options))

    return ask


def test_found_once_for_a_digest(ask: Callable[..., list[int]]) -> None:
    assert [ask("a"), ask("a"), ask("b"), ask("b"), ask("a")] == [[1], [1], [2], [2], [3]]


def test_found_anew_when_asked_to(ask: Callable[..., list[int]]) -> None:
    assert [ask("a"), ask("a", anew=True), ask("a")] == [[1], [2], [2]]


@pytest.mark.parametrize("content", ["", "[]", "{", '{"digest": "a"}', '{"digest": "a", "found": 3}'])
def test_damaged_files_are_replaced(tmp_path: Path, ask: Callable[..., list[int]], content: str) -> None:
    (tmp_path / "kept.json").write_text(content)
    assert [ask("a"), ask("a")] == [[1], [1]]


def test_digests_are_of_texts_and_of_what_files_hold(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("text")
    assert digest_of(file) == digest_of("text") != digest_of("Text")


def test_every_file_of_a_flight_counts(tmp_path: Path) -> None:
    folder = disk.write_flight(tmp_path / "sign", frames=2)
    digests = {digest_of(*flight_files(folder))}
    files = sorted(path for path in (folder / "mav0").rglob("*.*") if path.is_file())
    assert len(files) == 4 + 2 + 2 + 1  # images, their lists, their cameras, the poses
    for file in files:
        if file.suffix == ".png":
            os.utime(file, ns=(0, 0))
        else:
            file.write_text(file.read_text() + "#")
        digests.add(digest_of(*flight_files(folder)))
    assert len(digests) == 1 + len(files)


def test_arrays_and_dataclasses_become_json() -> None:
    @dataclass(frozen=True)
    class Inner:
        row: np.ndarray
        text: str | None

    found = {"a": (Inner(np.array([[1.5, 2.0]]), None), np.float64(0.25)), "b": [np.int32(3), True]}
    assert to_json(found) == {"a": [{"row": [[1.5, 2.0]], "text": None}, 0.25], "b": [3, True]}


# ---- code ----

KEPT = ("vista_eval.baselines.stereo_alone", "vista_eval.fly", "vista_eval.metrics.flight_segmentation")


@pytest.fixture
def copied(tmp_path: Path) -> Roots:
    """Our packages where a test may change them."""
    for name, folder in our_packages():
        shutil.copytree(folder, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    return tuple((name, tmp_path / name) for name, _ in our_packages())


def file_of(module: str, roots: Roots) -> Path:
    top, *below = module.split(".")
    path = dict(roots)[top].joinpath(*below)
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def digest_anew(entry: str, roots: Roots) -> str:
    module_code.cache_clear()
    return code_digest(entry, roots)


@pytest.mark.parametrize("entry", KEPT)
def test_code_that_is_imported_counts_wherever_it_lies(copied: Roots, entry: str) -> None:
    before = digest_anew(entry, copied)
    assert before == digest_anew(entry, our_packages())
    modules = code_of(entry, copied)
    assert {"vista.engine.golden", "vista.geometry", "vista.sequence.asl", "vista.sequence.image"} <= set(
        modules
    )
    for module in modules:
        with file_of(module, copied).open("a") as file:
            file.write("\nADDED = 1\n")
    module_code.cache_clear()
    changed = code_of(entry, copied)
    assert set(changed) == set(modules)
    assert {module for module in modules if changed[module] == modules[module]} == set()
    assert code_digest(entry, copied) != before


def test_modules_that_are_not_imported_do_not_count(copied: Roots) -> None:
    before = digest_anew(KEPT[0], copied)
    for module in (
        "vista.report.plots",
        "vista.cli",
        "vista_eval.worlds.street",
        "vista_eval.report.filmstrip",
    ):
        with file_of(module, copied).open("a") as file:
            file.write("\nADDED = 1\n")
    assert digest_anew(KEPT[0], copied) == before


def package(folder: Path, **modules: str) -> Roots:
    (folder / "ours").mkdir(parents=True)
    for name, text in ({"__init__": ""} | modules).items():
        (folder / "ours" / f"{name}.py").write_text(text)
    return (("ours", folder / "ours"),)


PLAIN = """
from __future__ import annotations
from ours.below import value

def twice(x: int) -> int:
    return 2 * value(x)
"""
REWORDED = '''"""A docstring."""

from __future__ import annotations
from ours.below import (
    value,  # with a comment
)


# A comment.
def twice(x: int) -> int:
    """Another docstring."""
    return 2 * value(x)
'''
BELOW = "def value(x):\n    return x\n"


def test_words_do_not_count(tmp_path: Path) -> None:
    plain = package(tmp_path / "a", above=PLAIN, below=BELOW)
    reworded = package(tmp_path / "b", above=REWORDED, below=BELOW)
    other = package(tmp_path / "c", above=PLAIN.replace("2 *", "3 *"), below=BELOW)
    assert code_digest("ours.above", plain) == code_digest("ours.above", reworded)
    assert code_digest("ours.above", plain) != code_digest("ours.above", other)


def test_a_module_that_moves_stays_the_same(tmp_path: Path) -> None:
    plain = package(tmp_path / "a", above=PLAIN, below=BELOW)
    moved = package(tmp_path / "b", top=PLAIN.replace("ours.below", "ours.deep"), deep=BELOW)
    assert code_digest("ours.above", plain) == code_digest("ours.top", moved)


@pytest.mark.parametrize(
    "statement",
    [
        "import ours.below",
        "from ours import below",
        "from . import below",
        "from .below import value as v",
        "def f():\n    from ours.below import value",
        "from ours import other",  # which imports it
    ],
)
def test_imports_of_all_kinds_are_followed(tmp_path: Path, statement: str) -> None:
    modules = {"above": statement + "\n", "other": "from ours import below\n"}
    digests = {
        code_digest("ours.above", package(tmp_path / str(k), **modules, below=f"K = {k}\n")) for k in (1, 2)
    }
    assert len(digests) == 2


def test_imports_for_types_are_not_followed(tmp_path: Path) -> None:
    text = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ours.below import Value\n"
    assert list(code_of("ours.above", package(tmp_path, above=text, below=BELOW))) == ["ours.above"]
