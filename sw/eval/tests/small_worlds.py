"""Families of sampled flights that take no time: a board in an image of 160x120, two frames."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from vista_eval.render.flight import Flight
from vista_eval.render.rig import Rig
from vista_eval.render.scene import Scene, board, thing
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.sampled.family import Family

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
