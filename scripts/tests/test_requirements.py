"""The requirements trace in both directions: what they name as evidence is there, and each hazard, kind of
fault and reason of health is somebody's."""

from __future__ import annotations

import pytest
from evidence import REQUIREMENTS, ROOT, named, read
from traced import is_there
from vista.health.finding import Reason
from vista_eval.disturbances import CONTROL, KINDS

CONTENT = read(REQUIREMENTS)
NAMED = set(named(CONTENT["requirement"]))
SOURCES = {"paper", "engine contract", "interface", "hazard", "users' reports", "security"}


@pytest.mark.parametrize(("kind", "what"), sorted(NAMED))
def test_evidence_is_there(kind: str, what: str) -> None:
    assert is_there(kind, what)


@pytest.mark.parametrize(
    ("kind", "what"),
    [("test", "scripts/tests/test_requirements.py::test_none"), ("proof", "vista_none"),
     ("bins", "core.none"), ("point", "WORDS-0"),
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
    assert {what for kind, what in NAMED if kind == "campaign"} == set(KINDS) - {CONTROL}


def test_each_reason_of_health_is_described() -> None:
    described = (ROOT / "doc" / "output.md").read_text() + (
        ROOT / "doc" / "obstacles.schema.json"
    ).read_text()
    assert [reason for reason in Reason if reason not in described] == []
