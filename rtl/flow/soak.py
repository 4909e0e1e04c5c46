# SPDX-License-Identifier: Apache-2.0
"""Random cases by their seeds, over all builds, going on where an earlier run stopped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from registers import CONTROL
from verilated import Config, Rtl
from vista_eval.cache import digest_of
from vista_eval.jobs import Job, Place, run

Check = Callable[[Rtl, int], None]


def soak(
    check: Check, configs: Sequence[Config], sources: str, total: int, each_job: int, place: Place, kept: Path
) -> int:
    """Runs check(engine, seed) until each build has its share of `total` cases; returns how many that are.

    check raises for a case that fails: then the others go on, and at the end JobsError is raised. each_job:
    cases in a row, on one engine that is not reset between them. `kept` holds what has passed, of the sources
    of this digest."""
    each = -(-total // len(configs))
    jobs = []
    for config in configs:
        for first in range(0, each, each_job):
            seeds = range(first, min(first + each_job, each))
            name = f"{config.name}, cases {seeds[0]} to {seeds[-1]}"
            jobs.append(Job(name, partial(passed, check, config, seeds), digest_of(f"{sources} {name}")))
    return sum(run(jobs, place, "soak", kept=kept))


def passed(check: Check, config: Config, seeds: range) -> int:
    with Rtl(config) as rtl:
        rtl.write(CONTROL, 1)
        for seed in seeds:
            check(rtl, seed)
    return len(seeds)
