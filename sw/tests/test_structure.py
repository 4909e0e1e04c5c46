"""The sources of libvista call each other one way, and small helpers exist once."""

from __future__ import annotations

import os
import re
import subprocess
from collections import defaultdict

import networkx
import pytest
from shared_data import REPOSITORY

BUILD = REPOSITORY / os.environ.get("VISTA_BUILD", "build")
SOURCES = REPOSITORY / "sw" / "src"
STATIC = re.compile(
    r"^static (?:inline )?[\w *]+?\b(\w+)\([^;]*?\) \{(.*?)(?:^\}|\}$)", re.MULTILINE | re.DOTALL
)


def objects() -> dict[str, str]:
    """Name of each source -> what nm says of its object, those of the library with its stages in reach."""
    found = {}
    for path in (BUILD / "sw/CMakeFiles/vista_stages.dir").rglob("*.c.o"):
        run = subprocess.run(["nm", path], capture_output=True, text=True, check=True)
        found[path.name.removesuffix(".c.o")] = run.stdout
    return found


@pytest.mark.slow
def test_no_two_sources_call_each_other() -> None:
    """Neither directly nor around a corner: data runs from the first stage to the last."""
    owner, needs = {}, defaultdict(set)
    for source, table in objects().items():
        for line in table.splitlines():
            *_, kind, name = line.split()
            if kind in "TDR":
                owner[name] = source
            elif kind == "U":
                needs[source].add(name)
    calls = networkx.DiGraph(
        (source, owner[name]) for source, names in needs.items() for name in names if name in owner
    )
    assert {"pipeline", "seeds", "merge", "motion"} <= set(calls)
    assert list(networkx.simple_cycles(calls)) == []
    assert set(calls.successors("obstacle_map")).isdisjoint({"regions", "pipeline"})
    assert not calls.has_edge("collision_volume", "obstacle_map")


def test_no_helper_is_written_twice() -> None:
    bodies = defaultdict(list)
    for path in sorted([*SOURCES.rglob("*.c"), *SOURCES.rglob("*.h")]):
        for match in STATIC.finditer(path.read_text()):
            body = re.sub(r"\s+", " ", match.group(2)).strip()
            if len(body) > 12:
                bodies[body].append(f"{path.name}:{match.group(1)}")
    assert len(bodies) > 50
    assert [places for places in bodies.values() if len(places) > 1] == []
