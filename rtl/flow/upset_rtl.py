# SPDX-License-Identifier: Apache-2.0
"""Turns random bits of the engine's registers and memories over while it runs: make upsets.

Of the core, and of the engine with its front end; of video without a pause, and with a reset before each
frame. What becomes of an upset is told in tb/common/upsets.py. Continues where it stopped.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "model", "build/python")]
from tools import BUILD, sources  # noqa: E402
from upsets import FRAME, LATER, MASKED, NEVER, NEXT, OUTCOMES, RESET, WRITTEN, Upset, upsets  # noqa: E402
from verilated import FRONT_END, Config, Rtl  # noqa: E402
from vista_eval.cache import digest_of  # noqa: E402
from vista_eval.jobs import Job, add_place, chosen_place, exit_on_failure, run  # noqa: E402
from vista_eval.report.table import Table, write_measurement  # noqa: E402

TOPS = {
    "core": replace(FRONT_END, rows=0, parity=True, upsets=True),
    "core and front end": replace(FRONT_END, parity=True, upsets=True),
}
WAYS = {"video": False, "reset before each frame": True}
PART = 50  # upsets in one scene, which are one job


def part(config: Config, seed: int, restarts: bool) -> list[dict[str, object]]:
    with Rtl(config) as rtl:
        return [asdict(found) for found in upsets(rtl, seed, PART, restarts)]


def table(found: Mapping[tuple[str, str], Sequence[Upset]]) -> Table:
    """What became of the upsets, by top, way, and registers or memories."""
    rows = []
    for (top, way), all_of_them in found.items():
        for memory, name in ((False, "registers"), (True, "memories")):
            chosen = [upset for upset in all_of_them if upset.memory == memory]
            count = Counter(upset.outcome for upset in chosen)
            lasting = [upset for upset in chosen if upset.outcome in (LATER, WRITTEN, RESET, NEVER)]
            unseen = sum(not upset.told for upset in lasting)
            numbers = (len(chosen), *(count[outcome] for outcome in OUTCOMES), unseen)
            rows.append((top, way, name, *(f"{number:,}" for number in numbers)))
    heads = ("top", "frames", "bit in", "upsets", *OUTCOMES, "lasting, not told")
    return Table("rtl-upsets", heads, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--upsets", type=int, default=10000, help="in all (default 10000)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=BUILD / "upsets" / "upsets.json")
    add_place(parser)
    arguments = parser.parse_args()
    pairs = [(top, way) for top in TOPS for way in WAYS]
    parts = -(-arguments.upsets // (PART * len(pairs)))
    drivers = sorted((ROOT / "tb" / "common").glob("*.*")) + sorted((ROOT / "rtl" / "sim").glob("*.*"))
    digest = digest_of(*sources("vista_stereo.f"), *drivers, Path(__file__))
    jobs = []
    for number in range(parts):
        for top, way in pairs:
            seed = arguments.seed * 1_000_000 + number
            name = f"{top}, {way}, seed {seed}"
            jobs.append(Job(name, partial(part, TOPS[top], seed, WAYS[way]), digest_of(f"{digest} {name}")))
    with exit_on_failure():
        results = run(jobs, chosen_place(arguments), "upsets", "part", arguments.out.parent / "kept")
    found: dict[tuple[str, str], list[Upset]] = {pair: [] for pair in pairs}
    for number, result in enumerate(results):
        found[pairs[number % len(pairs)]] += [Upset(**upset) for upset in result]
    shown = table(found)
    print(shown.as_text())
    long = [upset for of_pair in found.values() for upset in of_pair if upset.outcome not in (MASKED, FRAME)]
    for (outcome, cell), times in sorted(Counter((u.outcome, u.cell) for u in long).items()):
        print(f"{outcome:14} {times:3} {cell}")
    longer = sum(upset.outcome != NEXT for upset in long)
    figures = {"upsets": sum(map(len, found.values())), "more than a frame later": longer}
    write_measurement(arguments.out, [shown], figures, upsets=[asdict(upset) for upset in long])


if __name__ == "__main__":
    main()
