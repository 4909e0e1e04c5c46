"""Random generators that can be replayed: VISTA_SEED chooses the seed, failing tests show the command."""

from __future__ import annotations

import os
import zlib

import numpy as np


def seed_of(test: str) -> int:
    """VISTA_SEED if it is set; otherwise derived from VISTA_RUN, which `make test` sets to the commit, so
    that the same commit repeats a run and every commit draws anew; otherwise fresh."""
    if seed := os.environ.get("VISTA_SEED"):
        return int(seed)
    if run := os.environ.get("VISTA_RUN"):
        return zlib.crc32(f"{run} {test}".encode())
    return int(np.random.SeedSequence().generate_state(1)[0])


def seeded(stream: int) -> np.random.Generator:
    """The generator of one test, see seed_of; `stream` keeps the generators of a test apart."""
    test = os.environ.get("PYTEST_CURRENT_TEST", "sw/tests").split(" ")[0]
    seed = seed_of(test)
    print(f"rerun: VISTA_SEED={seed} .venv/bin/python -m pytest '{test}'")
    return np.random.default_rng([stream, seed])
