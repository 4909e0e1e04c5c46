"""A frame whose first pixel is offered in the clock of the response to a write finds the write done; one
whose first pixel was offered before a commit keeps its own set and map, however long its
pixels wait."""

from __future__ import annotations

import os

import numpy as np
import pytest
from behind_writes import LAST, behind_the_first_pixel, right_behind
from verilated import FRONT_END, Config, Rtl

pytestmark = pytest.mark.slow

CONFIGS = [Config(16, 5), FRONT_END]
SEEDS = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(12)


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
@pytest.mark.parametrize("last", LAST)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_frame_right_behind_a_write(config: Config, last: str, seed: int) -> None:
    rng = np.random.default_rng([seed, LAST.index(last)])
    rerun = f"VISTA_SEED={seed} pytest tb/top/test_behind_writes.py -k '{config.name} and {last}'"
    with Rtl(config, seed + 1) as rtl:
        for trial in range(4):
            print(f"trial {trial}; {rerun}")
            right_behind(rtl, rng, last, seed)


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_commit_behind_the_first_pixel_of_a_frame(config: Config, seed: int) -> None:
    rng = np.random.default_rng([seed, 77])
    rerun = f"VISTA_SEED={seed} pytest tb/top/test_behind_writes.py -k '{config.name} and first_pixel'"
    with Rtl(config, seed + 1) as rtl:
        for trial in range(5):
            print(f"trial {trial}; {rerun}")
            behind_the_first_pixel(rtl, rng, seed)
