"""Whether what requirements and points of the test plan name as evidence is there, and all there is."""

from __future__ import annotations

import ast
import json
from functools import cache
from pathlib import Path

import coverage_front_end
import coverage_rtl
from evidence import ROOT, TESTPLAN, Entry, read
from formal_rtl import PROOFS


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
    return frozenset(proof.module for proof in PROOFS)


@cache
def bins() -> frozenset[str]:
    """The groups of bins: block and first word."""
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
