"""The engine compiled for AArch64, under qemu: the words of this machine. `make test-aarch64` builds it."""

from __future__ import annotations

import os
import subprocess

import numpy as np
import pytest
from aarch64_program import ISAS, PROGRAM, RUN, record
from vista_model.c_engine import CEngine

WORDS = int(os.environ.get("VISTA_AARCH64_WORDS", "500000"))  # to compare at least with each instruction set

pytestmark = pytest.mark.skipif(not PROGRAM.exists(), reason="not built for AArch64: make test-aarch64")


def test_random_words(rng, random_pair, random_parameters) -> None:
    pairs, count = [], 0
    while count < WORDS:
        parameters = random_parameters()
        height = int(rng.integers(1, 100))
        width = parameters.num_disparities + int(rng.integers(0, 300))
        pairs.append((*random_pair(height, width), parameters))
        count += height * width
    asked = b"".join(record(*pair, isa) for pair in pairs for isa in ISAS)
    answer = subprocess.run([RUN, PROGRAM], input=asked, capture_output=True, check=True).stdout
    at = 0
    for left, right, parameters in pairs:
        outputs = CEngine(parameters).compute_all(left, right)
        for isa in ISAS:
            for wanted in (kind.astype(kind.dtype.newbyteorder("<")) for kind in outputs):
                got = np.frombuffer(answer, wanted.dtype, wanted.size, at).reshape(wanted.shape)
                np.testing.assert_array_equal(got, wanted, f"{isa} {parameters} {left.shape}")
                at += wanted.nbytes
    assert at == len(answer)
    print(f"{count} words with each of {ISAS}, 0 differ")
