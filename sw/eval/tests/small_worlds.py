"""Worlds that take no time: flights at a board, two frames of 160x120; places without fine textures."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from vista_eval.closed_loop.places import parts
from vista_eval.render.flight import Flight
from vista_eval.render.rig import Rig
from vista_eval.render.scene import Scene, board, thing
from vista_eval.worlds import walls
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.sampled.family import Family

GREY = np.full((2, 2), 0.4, np.float32)
SMALL_RIG = Rig(width_px=160, height_px=120, focal_px=250.0, baseline_m=0.4572)


def one_board(altitude_m: float, seed: int) -> Scene:
    albedo = np.random.default_rng(seed).uniform(0.1, 0.7, (40, 40)).astype(np.float32)
    front = board("board", (0.0, 0.0, altitude_m), 6.0, 6.0, albedo)
    return Scene((thing("board", "sign", [front], target=True),), to_sun=(-0.6, 0.3, 0.7))


class SmallFamily(Family):
    def flight(self, number: int, seed: int) -> Flight:
        whole = super().flight(number, seed)
        return replace(whole, rig=SMALL_RIG, approach=replace(whole.approach, frames=2))


def small_families(**splits: Literal["dev", "test"]) -> dict[str, Family]:
    return {name: SmallFamily(name, name, split, one_board, Courses()) for name, split in splits.items()}


def coarse_textures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Distances ask for no pictures on walls, nor for fine ones on the ground."""
    monkeypatch.setattr(walls, "TEXTURED", [lambda *_: GREY])
    for texel in ("FINE_M", "COARSE_M"):
        monkeypatch.setattr(parts, texel, 2.0)
