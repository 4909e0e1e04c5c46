"""What the requirements and the test plan of the RTL may name as evidence, and whether it is there.

Each entry is `kind: name`: a *test* of pytest or a cocotb bench, a *proof* of make formal, *bins* of make
coverage-rtl, a *point* of the test plan, a *figure* of the results, a row of the fault *campaign*.
"""

from __future__ import annotations

import ast
import json
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
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


@cache
def checks_in(path: Path) -> frozenset[str]:
    """The tests in a file: functions of pytest, or, in a bench, of cocotb."""
    bench = path.name.startswith("bench_")
    return frozenset(
        node.name
        for node in ast.walk(ast.parse(path.read_text()))
        if (isinstance(node, ast.AsyncFunctionDef) and is_cocotb_test(node) and bench)
        or (isinstance(node, ast.FunctionDef) and node.name.startswith("test_") and not bench)
    )


def is_cocotb_test(node: ast.AsyncFunctionDef) -> bool:
    return any(ast.unparse(decorator) == "cocotb.test()" for decorator in node.decorator_list)


@cache
def proofs() -> frozenset[str]:
    from formal_rtl import PROOFS

    return frozenset(proof.module for proof in PROOFS)


@cache
def bins() -> frozenset[str]:
    """The groups of bins: block and first word."""
    import coverage_front_end
    import coverage_rtl

    core = {f"core.{group}" for group, *_ in coverage_rtl.plan()}
    blocks = coverage_front_end.BLOCKS
    return frozenset(
        core | {f"{b.top}.{name.split()[0]}" for b in blocks for name in coverage_front_end.plan(b)}
    )


@cache
def measured(name: str) -> Entry:
    content: Entry = json.loads((ROOT / "doc" / "results" / "data" / f"{name}.json").read_text())
    return content


def is_test(name: str) -> bool:
    file, _, function = name.partition("::")
    path = ROOT / file
    return path.is_file() and (function in checks_in(path) or (function == "*" and bool(checks_in(path))))


def is_figure(name: str) -> bool:
    file, _, key = name.partition(".")
    return key in measured(file)["figures"]


def is_campaign(name: str) -> bool:
    rows = [row[0] for found in measured("faults")["tables"] for row in found["rows"]]
    return any(row.startswith(f"{name}, ") for row in rows)


KINDS = {
    "test": is_test,
    "proof": lambda name: name in proofs(),
    "bins": lambda name: name in bins(),
    "point": lambda name: name in {point["id"] for point in read(TESTPLAN)["point"]},
    "figure": is_figure,
    "campaign": is_campaign,
}


def is_there(kind: str, name: str) -> bool:
    return kind in KINDS and KINDS[kind](name)
