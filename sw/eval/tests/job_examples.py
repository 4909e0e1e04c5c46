"""Work for the tests of jobs, in a module that worker processes can load."""

from __future__ import annotations

import os
import signal
import time
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_info
from vista.errors import InputError
from vista_eval.cache import digest_of
from vista_eval.jobs import Job


def rows_of(seed: int) -> dict[str, Any]:
    """Something that takes a moment to compute and must not depend on where it is."""
    values = np.random.default_rng(seed).normal(size=1000)
    return {
        "seed": seed,
        "mean": float(values.mean()),
        "sorted": np.sort(values)[:3],
        "name": (f"{seed}", None),
    }


def blas_threads(_seed: int) -> list[int]:
    """How many threads each BLAS of this process has."""
    return [int(pool["num_threads"]) for pool in threadpool_info() if pool["user_api"] == "blas"]


def small_row(seed: int) -> dict[str, Any]:
    """A row as large as that of a recording."""
    return {f"figure {k}": float(seed + k) for k in range(16)} | {"name": f"recording {seed}"}


def noted(folder: Path, seed: int) -> dict[str, Any]:
    """Leaves a file for each attempt, named by job and process."""
    (folder / f"{seed}_{os.getpid()}_{time.monotonic_ns()}").touch()
    return rows_of(seed)


def held(folder: Path, hold_s: float, victims: tuple[int, ...], seed: int) -> dict[str, Any]:
    """The first attempt of a victim takes that much longer, so that something can happen meanwhile."""
    first = not any(folder.glob(f"{seed}_*"))
    found = noted(folder, seed)
    if first and seed in victims:
        time.sleep(hold_s)
    return found


def kills_itself(seed: int) -> int:
    if seed == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return seed


def leaves(seed: int) -> int:
    if seed == 2:
        os._exit(7)
    return seed


def fails(seed: int) -> int:
    if seed == 1:
        raise InputError("image.png", "truncated image")
    if seed == 3:
        raise ValueError("three\nis too many")
    return seed


def not_to_be_sent(seed: int) -> Any:
    return (lambda: seed) if seed == 1 else seed


SEEDS = range(12)


def kept_jobs(work, seeds=SEEDS) -> list[Job]:
    return [Job(f"seed {seed}", partial(work, seed), digest_of(f"{seed}")) for seed in seeds]


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def attempts_in(folder: Path) -> Counter[int]:
    return Counter(int(path.name.split("_")[0]) for path in folder.iterdir())


def wait_for_attempt(folder: Path, seed: int) -> int:
    """Waits until the job has begun; gives the process that it runs in."""
    until_s = time.monotonic() + 60.0
    while time.monotonic() < until_s:
        for path in folder.glob(f"{seed}_*"):
            return int(path.name.split("_")[1])
        time.sleep(0.01)
    raise AssertionError(f"job {seed} never began")
