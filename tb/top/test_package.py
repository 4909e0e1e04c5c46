"""The FuseSoC core names the sources of the file lists, in their order; every file says its license."""

import re
from pathlib import Path

import formal_rtl
import pytest
from tools import ROOT, sources

pytestmark = pytest.mark.slow


def listed() -> list[Path]:
    return sources("vista_stereo.f")


def test_core_file_lists_the_sources() -> None:
    text = (ROOT / "rtl" / "vista_stereo.core").read_text()
    assert re.findall(r"- ((?:src|csr)/\S+\.sv)", text) == [
        str(f.relative_to(ROOT / "rtl")) for f in listed()
    ]


def test_core_file_has_the_version_of_the_whole() -> None:
    text = (ROOT / "rtl" / "vista_stereo.core").read_text()
    assert f"name: vista:stereo:engine:{(ROOT / 'VERSION').read_text().strip()}\n" in text


def test_core_file_lists_the_properties() -> None:
    """Once as includes, for a simulation, and once as files, for sby."""
    text = (ROOT / "rtl" / "vista_stereo.core").read_text()
    names = sorted(f.name for f in (ROOT / "rtl" / "formal").glob("*.svh"))
    assert re.findall(r"- formal/(\S+\.svh): {is_include_file: true}", text) == names
    assert re.findall(r"- formal/(\S+\.svh)\n", text) == names


def test_fusesoc_proves_what_make_formal_does() -> None:
    assert formal_rtl.TEMPLATE.read_text() == formal_rtl.template(), "formal_rtl.py --template"


def test_every_source_is_listed() -> None:
    assert {f.name for f in listed()} == {f.name for f in (ROOT / "rtl").glob("*/*.sv")}


def test_every_file_of_the_core_says_its_license() -> None:
    """JSON has no comments."""
    files = [
        file for file in (ROOT / "rtl").rglob("*") if file.is_file() and file.suffix not in (".json", ".pyc")
    ]
    assert len(files) > 40
    without = [
        file.name
        for file in files
        if "SPDX-License-Identifier: Apache-2.0" not in "".join(file.read_text().splitlines()[:2])
    ]
    assert not without
