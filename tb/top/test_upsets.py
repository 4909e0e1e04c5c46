"""Bits of the engine that turn over while it runs are gone with the frame after the one that they disturb, in
video without a pause as well; what outlives frames, registers and the map, is told of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from upsets import FRAME, MASKED, NEXT, Upset, fly, prepare, random_scene, upsets
from verilated import FRONT_END, Config, Rtl

pytestmark = pytest.mark.slow

CORE = replace(FRONT_END, rows=0, parity=True, upsets=True)
WHOLE = replace(FRONT_END, parity=True, upsets=True)
NAMES = {CORE: "core", WHOLE: "front end"}
GONE = (MASKED, FRAME, NEXT)
KEPT = ("u_registers.", "u_map.", "u_points.")  # what is written once and outlives frames

# What made video wrong until a reset when nothing was set anew with a frame: counters, places, sizes.
LASTED = [
    "u_core.u_framer.row_q", "u_core.u_framer.last_col_q", "u_core.u_framer.drain_q",
    "u_core.u_frame_writer.u_positions.y_q", "u_core.u_frame_writer.u_positions.last_x_q",
    "u_core.u_frame_writer.u_positions.last_y_q", "u_core.u_frame_writer.u_positions.match_last_x_q",
    "u_core.u_result_fifo.read_ptr_q", "u_core.u_result_fifo.write_ptr_q", "u_core.u_result_fifo.out_ptr_q",
]  # fmt: skip
FRONT = "gen_front_end.u_front_end."
LASTED_FRONT = [
    FRONT + name
    for name in (
        "u_pyramid.u_levels.row_q", "u_pyramid.u_levels.first_q", "u_rectify.u_rows.base_q",
        "u_rectify.u_rows.last_row_q", "u_rectify.u_rows.y_q", "u_rectify.u_rows.ahead_q",
        "u_rectify.u_writer.read_ptr_q", "u_rectify.u_writer.write_ptr_q", "u_rectify.x_q",
        "u_rectify.loaded_q", "u_rectify.u_frames.valid_q",
    )
]  # fmt: skip


def lasting(found: list[Upset]) -> list[Upset]:
    return [upset for upset in found if upset.outcome not in GONE]


@pytest.mark.parametrize("restarts", [False, True], ids=["video", "reset before each frame"])
@pytest.mark.parametrize("config", [CORE, WHOLE], ids=NAMES.get)
def test_an_upset_is_gone_with_the_next_frame_or_told_of(config: Config, restarts: bool) -> None:
    with Rtl(config) as rtl:
        found = upsets(rtl, 7, 24, restarts)  # some of them show; `make upsets` draws thousands
    assert any(upset.outcome != MASKED for upset in found)
    for upset in lasting(found):
        assert upset.told and any(name in upset.cell for name in KEPT), upset


@pytest.mark.parametrize(
    ("config", "names"), [(CORE, LASTED), (WHOLE, LASTED_FRONT)], ids=["core", "front end"]
)
def test_counters_places_and_sizes_are_set_anew_with_a_frame(config: Config, names: list[str]) -> None:
    with Rtl(config) as rtl:
        cells = [cell for cell in rtl.cells() if cell.name in names]
        assert len(cells) == len(names)
        found = upsets(rtl, 0, 2 * len(cells), False, cells)
    assert any(upset.outcome != MASKED for upset in found)
    assert not lasting(found)


@pytest.mark.parametrize("restarts", [False, True], ids=["video", "reset before each frame"])
def test_a_bit_of_a_position_that_turns_over_loses_its_frame_alone(restarts: bool) -> None:
    with Rtl(CORE) as rtl:
        row = next(cell for cell in rtl.cells() if cell.name == "u_core.u_framer.row_q")
        scene = random_scene(np.random.default_rng(1), CORE, restarts)
        prepare(rtl, scene.frames[0])
        clean = fly(rtl, scene)
        prepare(rtl, scene.frames[0])
        rtl.upset(row, 0, 0, clean.begun[1] + scene.frames[0].left.size // 2)
        flown = fly(rtl, scene)
    assert flown.right == [True, False, True, True, True] and flown.told
