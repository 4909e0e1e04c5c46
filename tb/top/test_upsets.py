"""Bits of the engine that turn over: with a reset before each frame nothing lasts beyond the next frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from upsets import FRAME, MASKED, NEXT, WRITTEN, Upset, fly, prepare, random_scene, upsets
from verilated import FRONT_END, Config, Rtl

pytestmark = pytest.mark.slow

CORE = replace(FRONT_END, rows=0, upsets=True)
WHOLE = replace(FRONT_END, upsets=True)
GONE = (MASKED, FRAME, NEXT)


def found(config: Config, seeds: range, restarts: bool) -> list[Upset]:
    with Rtl(config) as rtl:
        return [upset for seed in seeds for upset in upsets(rtl, seed, 50, restarts)]


@pytest.mark.parametrize("config", [CORE, WHOLE], ids=["core", "front end"])
def test_with_a_reset_before_each_frame_no_upset_outlasts_the_next(config: Config) -> None:
    all_of_them = found(config, range(3), restarts=True)
    assert any(upset.outcome != MASKED for upset in all_of_them)
    for upset in all_of_them:
        in_map = upset.outcome == WRITTEN and (
            "u_points" in upset.cell or "u_map" in upset.cell
        )  # loaded once
        assert upset.outcome in GONE or in_map, upset


def test_of_video_every_upset_goes_by_itself_or_by_what_the_host_can_do() -> None:
    all_of_them = found(CORE, range(4), restarts=False)
    assert any(upset.outcome not in GONE for upset in all_of_them)
    assert not [upset for upset in all_of_them if upset.outcome == "never"]


def test_a_bit_of_a_position_that_turns_over_loses_the_framing_until_a_reset() -> None:
    with Rtl(CORE) as rtl:
        row = next(cell for cell in rtl.cells() if cell.name == "u_core.u_framer.row_q")
        for restarts, right in (
            (False, [True, False, False, False, False]),
            (True, [True, False, True, True, True]),
        ):
            scene = random_scene(np.random.default_rng(1), CORE, restarts)
            prepare(rtl, scene.frames[0])
            clean = fly(rtl, scene)
            prepare(rtl, scene.frames[0])
            rtl.upset(row, 0, 0, clean.begun[1] + scene.frames[0].left.size // 2)
            flown = fly(rtl, scene)
            assert flown.right == right and flown.told
