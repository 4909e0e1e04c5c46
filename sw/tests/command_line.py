"""The command line called in this process: exit status, and what it printed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from vista.cli import main

Outcome = tuple[int, str, str]
Vista = Callable[..., Outcome]


def call(capsys: pytest.CaptureFixture[str], *arguments: object) -> Outcome:
    """Status, stdout and stderr of `vista ARGUMENTS`."""
    try:
        status = main([str(argument) for argument in arguments])
    except SystemExit as stop:
        status = int(stop.code or 0)
    out, err = capsys.readouterr()
    return status, out, err


def assert_refused(outcome: Outcome, text: str) -> None:
    """Bad input: exit status 2, and nothing printed but one line that holds the text."""
    status, out, err = outcome
    assert (status, out) == (2, "")
    assert err.startswith("vista: ") and err.count("\n") == 1
    assert text in err


def lines_without_times(folder: Path) -> list[str]:
    """The bytes of obstacles.jsonl with nothing but the value of processing_ms taken out."""
    return [without_time(line) for line in (folder / "obstacles.jsonl").read_text().splitlines()]


def without_time(line: str) -> str:
    time = f'"processing_ms": {json.dumps(json.loads(line)["processing_ms"])}'
    assert line.count(time) == 1
    return line.replace(time, '"processing_ms": 0')
