"""The mechanisms that `ablation.py` switches off: each edit applies to the sources as they are."""

from __future__ import annotations

import importlib.util
import shutil
import sys
from pathlib import Path

import pytest
from vista import parameters

ROOT = Path(__file__).resolve().parents[3]
SPEC = importlib.util.spec_from_file_location("ablation", ROOT / "sw" / "eval" / "bench" / "ablation.py")
assert SPEC is not None and SPEC.loader is not None
ablation = sys.modules["ablation"] = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(ablation)
MECHANISMS = {one.name: one for one in ablation.read_mechanisms()}


@pytest.fixture
def sources(tmp_path):
    """A copy of what the mechanisms edit."""
    for file in {edit.file for one in MECHANISMS.values() for edit in one.edits}:
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ablation.SOURCES / file, tmp_path / file)
    return tmp_path


def test_every_mechanism_changes_sources_or_parameters(sources):
    values = parameters.defaults()
    for one in MECHANISMS.values():
        before = {edit.file: (sources / edit.file).read_text() for edit in one.edits}
        ablation.apply(one, sources)
        assert all((sources / file).read_text() != text for file, text in before.items()), one.name
        for file, text in before.items():
            (sources / file).write_text(text)
        assert one.edits or ablation.with_values(values, one.values) != values, one.name


def test_an_edit_whose_text_has_gone_is_an_error(sources):
    gone = ablation.Mechanism("gone", (ablation.Edit("detector/pipeline.c", "no such text", ""),))
    with pytest.raises(ValueError, match=r"gone: .* has the old text 0 times"):
        ablation.apply(gone, sources)


def test_the_table_says_which_families_win():
    of = {"hits": 5, "asked": 9, "false": 1, "frames": 20, "through": 2, "clear": 3, "good": 4, "matched": 5}
    worse, better = of | {"hits": 3, "false": 2}, of | {"hits": 6}
    results = {
        "poles_000": {"as it is": of, "it": worse},
        "poles_001": {"as it is": of, "it": of},
        "rows_000": {"as it is": of, "it": better},
    }
    row = ablation.row_of(ablation.Mechanism("it"), results)
    assert row == ("it", "-1", "+1", "+0", "+0.0 %", "poles 3", "rows 1", "")
