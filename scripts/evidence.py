"""The requirements and the test plan of the RTL, and what they name as evidence.

Each entry is `kind: name`: a *test* of pytest or a cocotb bench, a *proof* of make formal, *bins* of make
coverage-rtl, a *point* of the test plan, a *figure* of the results, a row of the fault *campaign*.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
REQUIREMENTS = ROOT / "doc" / "requirements.toml"
TESTPLAN = ROOT / "rtl" / "testplan.toml"

Entry = dict[str, Any]


def read(file: Path) -> dict[str, list[Entry]]:
    return tomllib.loads(file.read_text())


def named(entries: Iterable[Entry]) -> Iterator[tuple[str, str]]:
    """Kind and name of all evidence of requirements or points."""
    for entry in entries:
        for evidence in entry["evidence"]:
            kind, _, name = evidence.partition(": ")
            yield kind, name
