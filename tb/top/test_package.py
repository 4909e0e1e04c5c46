"""The FuseSoC core names the sources of the file lists, in their order."""

import re

from tools import ROOT, sources


def test_core_file_lists_the_sources() -> None:
    text = (ROOT / "rtl" / "vista_stereo.core").read_text()
    assert re.findall(r"- ((?:src|csr)/\S+\.sv)", text) == [
        str(f.relative_to(ROOT / "rtl")) for f in sources("vista_stereo.f")
    ]


def test_every_source_is_listed() -> None:
    assert {f.name for f in sources("vista_stereo.f")} == {f.name for f in (ROOT / "rtl").glob("*/*.sv")}
