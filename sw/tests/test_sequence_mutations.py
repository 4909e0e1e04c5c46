"""Sequences damaged at random: the readers succeed or raise InputError in one line, never anything else."""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest
import sequence_cases as cases
from vista.errors import InputError
from vista.rectify import Rectifier
from vista.sequence import open_sequence

SEED = int(os.environ.get("VISTA_TEST_SEED", "20260509"))
ROUNDS = 150
RERUN = "VISTA_TEST_SEED={} pytest sw/tests/test_sequence_mutations.py -k {}"
WORDS = [
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"1e999",
    b"",
    b"\n",
    b",",
    b" ",
    b"\x00",
    b"\xff",
    b"9" * 40,
    b"[",
    b"#",
    b"x",
]


def mutate(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) + 1)
    length = rng.choice([0, 1, 2, 8, len(data)])
    return data[:at] + rng.choice(WORDS) + data[at + length :]


def exercise(folder: Path) -> None:
    sequence = open_sequence(folder)
    rectifier = Rectifier(sequence.calibration)
    for files in sequence.frames:
        rectifier.rectify(sequence.read(files))


@pytest.mark.slow
@pytest.mark.parametrize("make", [cases.make_asl, cases.make_kitti, cases.make_pairs, cases.make_flown_pairs])
def test_random_damage(tmp_path: Path, make) -> None:
    print(RERUN.format(SEED, make.__name__))
    rng = random.Random(SEED)
    folder = make(tmp_path / "flight", 2)
    files = sorted(path for path in (tmp_path / "flight").rglob("*") if path.is_file())
    texts = [path for path in files if path.suffix != ".png"]
    refused = 0
    for _ in range(ROUNDS):
        path = rng.choice(texts if rng.random() < 0.7 else files)
        whole = path.read_bytes()
        path.write_bytes(mutate(whole, rng))
        try:
            exercise(folder)
        except InputError as error:
            refused += 1
            assert "\n" not in str(error)
        path.write_bytes(whole)
    exercise(folder)
    assert refused > ROUNDS // 4
