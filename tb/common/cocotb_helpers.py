"""What every cocotb bench needs: a clock, a reset, a seed that is printed, and words packed into a port."""

from __future__ import annotations

import itertools
import os
import random
from collections.abc import Iterable

import cocotb
from cocotb.clock import Clock
from cocotb.handle import SimHandleBase
from cocotb.triggers import FallingEdge, Timer

PERIOD_NS = 10  # of the clock
SEED = int(os.environ.get("VISTA_SEED", "1"))
_tests = itertools.count()  # of the bench that is run


def seeded(dut: SimHandleBase) -> random.Random:
    """Dice for a test. Each test of a bench has others, also those that differ in their parameters alone."""
    cocotb.log.info("seed %d; rerun: VISTA_SEED=%d pytest tb/test_units.py -k %s", SEED, SEED, dut._name)
    return random.Random(SEED + (next(_tests) << 32))


def parameter(name: str) -> int:
    """A parameter of the module under test."""
    return int(os.environ[f"VISTA_{name.upper()}"])


async def start(dut: SimHandleBase, **idle: int) -> None:
    """Sets the inputs given, runs the clock and resets. Benches drive and look at the falling edge."""
    for name, value in idle.items():
        getattr(dut, name).value = value
    if mutant := os.environ.get("VISTA_MUTANT"):  # of rtl/flow/mutate_rtl.py
        dut.mutsel.value = int(mutant)
    if hasattr(dut, "rst_ni"):
        dut.rst_ni.value = 0
    await Timer(1, "ns")  # inputs start at random: none may change beside the first edge
    cocotb.start_soon(Clock(dut.clk_i, PERIOD_NS, "ns").start())
    if hasattr(dut, "rst_ni"):
        for _ in range(4):
            await FallingEdge(dut.clk_i)
        dut.rst_ni.value = 1
    await FallingEdge(dut.clk_i)


def pack(words: Iterable[int], width: int) -> int:
    return sum((int(word) & (1 << width) - 1) << i * width for i, word in enumerate(words))


def unpack(value: int, width: int, count: int) -> list[int]:
    return [int(value) >> i * width & (1 << width) - 1 for i in range(count)]
