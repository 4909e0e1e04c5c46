"""Arithmetic claims of the RTL, tried out in full."""

import re

import numpy as np
import pytest
from tools import ROOT

pytestmark = pytest.mark.slow


def test_division_by_hundred_is_exact() -> None:
    """vista_uniqueness_bound: floor(Smin * u / 100) by a multiplication, Smin below 2^17, all u."""
    source = (ROOT / "rtl/src/vista_uniqueness_bound.sv").read_text()
    reciprocal = int(re.search(r"Reciprocal = GainW'\((\d+)\)", source)[1])
    shift = int(re.search(r"Shift = (\d+)", source)[1])
    assert reciprocal == -(-(1 << shift) // 100)
    smin = np.arange(1 << 17, dtype=np.int64)
    for ratio in range(101):
        assert (smin * (ratio * reciprocal) >> shift == smin * ratio // 100).all()


def test_no_cost_is_the_all_ones_word() -> None:
    """The spare leaves of the tree, the empty chain and the saturated bound rely on it."""
    for block_size in range(5, 22, 2):
        largest = block_size * block_size * 255
        assert largest < (1 << largest.bit_length()) - 1
