"""The engine for AArch64 as a program that reads pairs, and the emulator that it runs in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from vista_model import Parameters
from vista_model.c_engine import c_params

ROOT = Path(__file__).parents[2]
RUN, PROGRAM = ROOT / "build/tools/aarch64/run", ROOT / "build/aarch64/bin/words"
ISAS = ("neon", "portable")


def record(left: np.ndarray, right: np.ndarray, parameters: Parameters, isa: str) -> bytes:
    """What words.c reads for a pair."""
    p = c_params(parameters, isa)
    height, width = left.shape
    head = [width, height, p.num_disparities, p.block_size, p.prefilter, p.prefilter_cap, p.texture_threshold]
    head += [p.uniqueness_ratio, p.lr_max_diff, p.isa]
    return np.array(head, "<i4").tobytes() + left.tobytes() + right.tobytes()
