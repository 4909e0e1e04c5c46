"""What is kept: found once for a digest, again for another one, from a damaged file, or when asked to."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import flight_on_disk as disk
import numpy as np
import pytest
from vista_eval.cache import digest_of, flight_files, kept, to_json


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
