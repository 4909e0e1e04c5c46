"""Addresses and fields of the registers, read from their one description, rtl/csr/vista_stereo_csr.rdl."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from systemrdl import RDLCompiler
from systemrdl.node import RegNode
from tools import ROOT


@dataclass(frozen=True)
class Field:
    """Bits high..low of a register, as software and hardware see them."""

    name: str
    low: int
    high: int
    reset: int | None
    kept: bool  # what software writes is what it reads
    clears: bool
    pulse: bool  # reads as 0

    @property
    def mask(self) -> int:
        return (1 << self.high + 1) - (1 << self.low)


@functools.cache
def registers() -> dict[str, tuple[int, tuple[Field, ...]]]:
    """Address and fields by name of the register."""
    compiler = RDLCompiler()
    compiler.compile_file(str(ROOT / "rtl" / "csr" / "vista_stereo_csr.rdl"))
    found = {}
    for node in compiler.elaborate().top.descendants(unroll=True):
        if isinstance(node, RegNode):
            fields = tuple(
                Field(f.inst_name, f.low, f.high, f.get_property("reset"),
                      f.is_sw_writable and f.is_sw_readable, f.get_property("onwrite") is not None,
                      f.get_property("singlepulse"))
                for f in node.fields()
            )  # fmt: skip
            found[node.inst_name] = (node.address_offset, fields)
    return found


def address(name: str) -> int:
    return registers()[name][0]


# Of a byte address, as the bus has them.
ADDRESS_BITS = max(a for a, _ in registers().values()).bit_length()

ID, VERSION, BUILD, BUILD_SIZE = (address(name) for name in ("ID", "VERSION", "BUILD", "BUILD_SIZE"))
CONTROL, SIZE, PREFILTER, TEXTURE = (address(name) for name in ("CONTROL", "SIZE", "PREFILTER", "TEXTURE"))
UNIQUENESS, LR_CHECK, ERRORS = (address(name) for name in ("UNIQUENESS", "LR_CHECK", "ERRORS"))
FRAMES_IN, FRAMES_OUT = address("FRAMES_IN"), address("FRAMES_OUT")
STALLS_IN, STALLS_OUT = address("STALLS_IN"), address("STALLS_OUT")
OUTPUT, COMMIT = address("OUTPUT"), address("COMMIT")
INTERRUPT, INTERRUPT_MASK = address("INTERRUPT"), address("INTERRUPT_MASK")
BUILD_FRONT_END, FRONT_END = address("BUILD_FRONT_END"), address("FRONT_END")
MAP, MAP_POINT, STATUS = address("MAP"), address("MAP_POINT"), address("STATUS")
ENABLE, SOFT_RESET = 1, 2  # of CONTROL
FRAME_DONE, ERROR, STOPPED = 1, 2, 4  # of INTERRUPT
NO_MAP, MAP_ROWS, MAP_SIZE = 1 << 5, 1 << 6, 1 << 7  # of ERRORS, which only a front end sets
UPSET = 1 << 8  # of ERRORS
PARITY, CONFIDENCE = 1 << 24, 1 << 25  # of BUILD
BEGIN_LOAD, MAP_READY = 1, 2  # of MAP
BUSY = 1  # of STATUS
SLVERR = 2  # response of the bus
COMMIT_SET, COMMIT_MAP = 1, 2  # of COMMIT
