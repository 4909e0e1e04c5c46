"""Generators of random numbers, one a purpose: what one part draws does not shift what another does."""

from __future__ import annotations

from zlib import crc32

import numpy as np


def draws(seed: int, purpose: str) -> np.random.Generator:
    return np.random.default_rng((seed, crc32(purpose.encode())))


def seed_of(*parts: str | int) -> int:
    """31 bits that follow from all the parts."""
    return crc32(" ".join(map(str, parts)).encode()) >> 1


def some_seed(rng: np.random.Generator) -> int:
    return int(rng.integers(1 << 30))


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
