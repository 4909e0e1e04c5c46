"""The requirements trace in both directions: what they name as evidence is there, and each hazard, kind of
fault and reason of health is somebody's."""

from __future__ import annotations

import ast
import json
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from vista.health.finding import Reason
from vista_eval.disturbances import KINDS

ROOT = Path(__file__).resolve().parents[2]
CONTENT: dict[str, list[dict[str, Any]]] = tomllib.loads((ROOT / "doc" / "requirements.toml").read_text())
SOURCES = {"paper", "engine contract", "interface", "hazard", "users' reports", "security"}


def evidence() -> Iterator[tuple[str, str]]:
    for requirement in CONTENT["requirement"]:
        for entry in requirement["evidence"]:
            kind, _, what = entry.partition(": ")
            yield kind, what


@cache
def functions_of(path: Path) -> set[str]:
    return {node.name for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef)}


def measured(name: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((ROOT / "doc" / "results" / "data" / f"{name}.json").read_text())
    return content


def is_there(kind: str, what: str) -> bool:
    if kind == "test":
        name, _, function = what.partition("::")
        path = ROOT / name
        return path.is_file() and (function in functions_of(path) or function == "*")
    if kind == "proof":
        return (ROOT / what).is_file()
    if kind == "figure":
        name, _, key = what.partition(".")
        return key in measured(name)["figures"]
    rows = [row[0] for found in measured("faults")["tables"] for row in found["rows"]]
    return kind == "campaign" and any(row.startswith(f"{what}, ") for row in rows)


@pytest.mark.parametrize(("kind", "what"), sorted(set(evidence())))
def test_evidence_is_there(kind: str, what: str) -> None:
    assert is_there(kind, what)


@pytest.mark.parametrize(
    ("kind", "what"),
    [("test", "scripts/tests/test_requirements.py::test_none"), ("proof", "rtl/formal/none.svh"),
     ("figure", "faults.none"), ("campaign", "none"), ("opinion", "ours")],
)  # fmt: skip
def test_evidence_that_is_not_there_is_noticed(kind: str, what: str) -> None:
    assert not is_there(kind, what)


def test_each_requirement_has_an_id_of_its_own_a_source_hazards_and_evidence() -> None:
    requirements = CONTENT["requirement"]
    hazards = {hazard["id"] for hazard in CONTENT["hazard"]}
    assert len({r["id"] for r in requirements}) == len(requirements)
    for r in requirements:
        assert r["source"] in SOURCES and r["evidence"] and r["hazards"] and set(r["hazards"]) <= hazards


def test_each_hazard_is_met_and_says_what_remains() -> None:
    met = {hazard for r in CONTENT["requirement"] for hazard in r["hazards"]}
    assert {hazard["id"] for hazard in CONTENT["hazard"]} == met
    assert all(hazard["causes"] and hazard["remains"] for hazard in CONTENT["hazard"])


def test_each_kind_of_fault_belongs_to_a_requirement() -> None:
    assert {what for kind, what in evidence() if kind == "campaign"} == set(KINDS)


def test_each_reason_of_health_is_described() -> None:
    described = (ROOT / "doc" / "output.md").read_text() + (
        ROOT / "doc" / "obstacles.schema.json"
    ).read_text()
    assert [reason for reason in Reason if reason not in described] == []
