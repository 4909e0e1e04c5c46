"""Constants and packed structs of rtl/src/vista_stereo_pkg.sv, the one place where they are written."""

from __future__ import annotations

import re
from collections.abc import Mapping

from tools import ROOT

_TEXT = (ROOT / "rtl" / "src" / "vista_stereo_pkg.sv").read_text()


def _found(pattern: str) -> str:
    match = re.search(pattern, _TEXT)
    assert match, f"the package has no {pattern}"
    return match[1]


def package_constant(name: str) -> int:
    """A number of the package."""
    return int(_found(rf"parameter int unsigned {name} = (\d+);"))


def struct_fields(name: str) -> dict[str, int]:
    """The widths of the fields of a packed struct, from its highest bits to its lowest."""
    body = _found(rf"typedef struct packed {{([^}}]*)}} {name};")
    members = re.findall(r"^ *logic *(?:\[(\d+):0\])? *(\w+);", body, re.M)
    return {field: int(high or 0) + 1 for high, field in members}


def struct_bits(fields: Mapping[str, int], values: Mapping[str, int]) -> int:
    """A packed struct as one number; fields that are not named are 0."""
    assert set(values) <= set(fields), f"no such field: {set(values) - set(fields)}"
    bits = 0
    for name, width in fields.items():
        value = int(values.get(name, 0))
        assert 0 <= value < 1 << width, f"{name}: {value} does not fit into {width} bits"
        bits = bits << width | value
    return bits
