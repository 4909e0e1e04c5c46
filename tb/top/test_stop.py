"""A stop ends what is inside, and tells when its last word was taken; a soft reset withdraws no word."""

from __future__ import annotations

import os

import numpy as np
import pytest
from raw_frames import LEFT_BY_A_RESET, check, random_one, written
from registers import CONTROL, ENABLE, INTERRUPT, SOFT_RESET, STATUS, STOPPED
from stops import NOTHING, stopped_inside
from verilated import FRONT_END, Config, Pace, Rtl

pytestmark = pytest.mark.slow

CONFIGS = [Config(16, 5), FRONT_END]
SEEDS = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(12)


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_stop_ends_what_is_inside(config: Config, seed: int) -> None:
    rng = np.random.default_rng(seed)
    with Rtl(config, seed + 1) as rtl:
        for _ in range(4):
            stopped_inside(rtl, random_one(rng, config), rng, seed)
        assert rtl.read(INTERRUPT) & STOPPED == 0, "it is told once"
        rtl.write(CONTROL, ENABLE)
        rtl.write(CONTROL, 0)
        assert rtl.read(INTERRUPT) & STOPPED, "nothing was inside"


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_soft_reset_withdraws_no_word(config: Config, seed: int) -> None:
    """Anywhere in a frame, while the reader stalls: what was offered can still be taken, and the next frame
    is right. The rules of the bus are checked in each clock (rtl/formal/vista_bus_properties.svh)."""
    rng = np.random.default_rng(seed)
    with Rtl(config, seed + 1) as rtl:
        for trial in range(6):
            frame = random_one(rng, config)
            rtl.write(CONTROL, ENABLE)
            written(rtl, frame.writes())
            expected = frame.words()
            part = frame.stream[: int(rng.integers(1, frame.left.size + 1))]
            got = rtl.stream(part, int(rng.integers(len(expected))), quiet=int(rng.integers(20, 300)))
            rtl.write(CONTROL, ENABLE | SOFT_RESET)
            left = rtl.stream(NOTHING, LEFT_BY_A_RESET + 10, Pace(), Pace(300, 300), trial, quiet=50).words
            assert len(left) <= LEFT_BY_A_RESET
            assert (left == expected[len(got.words) : len(got.words) + len(left)]).all()
            assert rtl.read(STATUS) == 0
            written(rtl, frame.writes(load_map=False))
            check(rtl, frame, seed=seed)
