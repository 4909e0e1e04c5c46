"""The engine of the SystemC model equals the RTL in every clock, word and stall. More cases: make soak."""

from __future__ import annotations

import os

import numpy as np
import pytest
from frames import Frame, random_pair, random_parameters
from system_model import Case, Traced, check_case, random_case, trace_model
from verilated import CONFIGS, Config, Pace, Rtl

pytestmark = pytest.mark.slow

CASES = 3  # of each build


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
def test_model_equals_rtl_in_every_clock(config: Config) -> None:
    seeds = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(CASES)
    with Rtl(config) as rtl:
        for seed in seeds:
            check_case(rtl, random_case(config, seed))


def test_whole_frames() -> None:
    """Two of 640x480, with both sides stalling."""
    rng = np.random.default_rng(0)
    parameters = random_parameters(rng, 32, 11)
    frames = [Frame(*random_pair(rng, "shifted", 480, 640), parameters) for _ in range(2)]
    config = Config(32, 11)
    with Rtl(config) as rtl:
        check_case(rtl, Case(config, frames, Pace(5, 5), Pace(50, 200), seed=1))


def test_comparison_sees_one_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """A model that is late by a clock, once, fails."""
    config = CONFIGS[0]

    def late(case: Case) -> Traced:
        traced = trace_model(case)
        traced.out_clock[len(traced.out_clock) // 2] += 1
        return traced

    monkeypatch.setattr("system_model.trace_model", late)
    with Rtl(config) as rtl, pytest.raises(AssertionError, match="out_clock: 1 differ"):
        check_case(rtl, random_case(config, 0))
