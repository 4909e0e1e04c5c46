"""The engine of the SystemC model equals the RTL in every clock, word and stall. More cases: make soak."""

from __future__ import annotations

import os

import pytest
from system_model import Case, Traced, check_case, random_case, trace_model
from verilated import CONFIGS, Config, Rtl

CASES = 3  # of each build


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
def test_model_equals_rtl_in_every_clock(config: Config) -> None:
    seeds = [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(CASES)
    with Rtl(config) as rtl:
        for seed in seeds:
            check_case(rtl, random_case(config, seed))


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
