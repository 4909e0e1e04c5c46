"""Random generators that can be replayed: VISTA_SEED chooses the seed, failing tests show the command."""

from __future__ import annotations

import os

import numpy as np


def seeded(stream: int) -> np.random.Generator:
    """The generator of one test, fresh unless VISTA_SEED is set; `stream` keeps the tests of a file apart."""
    seed = int(os.environ.get("VISTA_SEED") or np.random.SeedSequence().entropy % 2**32)
    test = os.environ.get("PYTEST_CURRENT_TEST", "sw/tests").split(" ")[0]
    print(f"rerun: VISTA_SEED={seed} .venv/bin/python -m pytest '{test}'")
    return np.random.default_rng([stream, seed])
