# SPDX-License-Identifier: Apache-2.0
"""The netlist of `make synth`, simulated cell by cell: it sends the words of the C model."""

from __future__ import annotations

import os

import numpy as np
import pytest
from frames import beats, expected_flags, expected_words, random_frame, set_up
from netlist import CHANGED, NETLIST
from registers import CONTROL, ENABLE, ERRORS
from verilated import PACES, Config, Rtl

pytestmark = pytest.mark.slow

CONFIG = Config(16, 5, stand=NETLIST)
FRAMES = 40
LARGEST = 64  # px wide
SEEN = 0.75  # of the inverted cells, at least


def differing_words(rtl: Rtl, seed: int) -> int:
    """Counts differing words of one random frame, at random paces; a word that is missing differs."""
    rng = np.random.default_rng(seed)
    frame = random_frame(rng, CONFIG.num_disparities, CONFIG.block_size, LARGEST)
    frame.narrow = bool(rng.random() < 0.3)
    pace_in, pace_out = (PACES[i] for i in rng.integers(len(PACES), size=2))
    set_up(rtl, frame)
    expected = expected_words(frame)
    flags = expected_flags(*frame.shape, frame.narrow)
    got = rtl.stream(beats(frame.left, frame.right), len(expected), pace_in, pace_out, seed, quiet=3000)
    count = len(got.words)
    wrong = (got.words != expected[:count]) | (got.flags != flags[:count])
    return int(wrong.sum()) + len(expected) - count


def test_netlist_sends_the_words_of_the_model() -> None:
    first = int(os.environ.get("VISTA_SEED", 1))
    with Rtl(CONFIG) as rtl:
        rtl.select_mutant(0)
        rtl.write(CONTROL, ENABLE)
        for seed in range(first, first + FRAMES):
            wrong = differing_words(rtl, seed)
            assert not wrong, f"{wrong} words differ; VISTA_SEED={seed} pytest rtl/flow/tests/test_netlist.py"
        assert rtl.read(ERRORS) == 0


def test_inverted_cells_are_seen() -> None:
    """One at a time. A few are drawn that hardly show: the last bit of a cost, a case that does not come."""
    seen = set()
    with Rtl(CONFIG) as rtl:
        for number in range(1, CHANGED + 1):
            rtl.select_mutant(number)
            rtl.write(CONTROL, ENABLE)
            if any(differing_words(rtl, seed) for seed in range(FRAMES // 2)):
                seen.add(number)
    assert len(seen) >= SEEN * CHANGED, f"of {CHANGED} only {sorted(seen)}"
