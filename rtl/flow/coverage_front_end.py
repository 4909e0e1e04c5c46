# SPDX-License-Identifier: Apache-2.0
"""Coverage of the blocks before the core, and of them with the core: line, toggle and the plan of
doc/design/verification.md.

Runs the cocotb bench of each with further seeds until every bin of the plan was hit (or a limit is reached),
then reads Verilator's counts as rtl/flow/coverage_rtl.py does. `--of` runs one alone.
"""

from __future__ import annotations

import argparse
import itertools
import os
import sys
from collections.abc import Iterable
from dataclasses import dataclass

from coverage_rtl import LIMITS, ROOT, percentages

sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "tb/units", "model", "build/python")]
from cocotb_tools.runner import get_runner  # noqa: E402
from tools import BUILD, VERILATOR_FLAGS, sources, verilator_environment  # noqa: E402

MOST_SEEDS = 20
ENDS = ["whole", "first", "top", "cut"]


@dataclass(frozen=True)
class Block:
    """A module, how it is built, its settings, and bins that only it has."""

    top: str
    parameters: dict[str, int]
    settings: Iterable[str]
    further: frozenset[str] = frozenset()


def product(*parts: Iterable[str]) -> frozenset[str]:
    return frozenset(" ".join(names) for names in itertools.product(*parts))


MAPS = product(["map"], ["accepted", "rows", "size"], ["video", "quiet"]) | {"map unfit"}
LEVELS = product(["level"], "0123", ["whole", "cut"])
BLOCKS = [
    Block("vista_smooth", {"MaxWidth": 32, "SideWidth": 8}, "01"),
    Block("vista_pyramid", {"MaxWidth": 40, "SideWidth": 8}, "012345"),
    Block("vista_rectify", {"MaxWidth": 40, "NumRows": 16, "MaxPoints": 16, "SideWidth": 8}, "01", MAPS),
    Block(
        "front_end",
        {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 64, "NumRows": 16, "MaxPoints": 64},
        product(["rectify0", "rectify1"], ["pyramid0", "pyramid1"], ["smooth0", "smooth1"]),
        MAPS | LEVELS,
    ),
]


def plan(block: Block) -> frozenset[str]:
    """The bins of a block."""
    paces = ["always", "pauses"]
    return (
        product(["size"], ["smallest", "widest", "even", "odd"], ["smallest", "even", "odd"])
        | product(["end"], ["whole", "cut"], block.settings)
        | product(["pace"], paces, paces, ENDS)
        | block.further
    )


def cover(block: Block) -> bool:
    """Whether a block falls short of a limit."""
    top, parameters = block.top, block.parameters
    folder = BUILD / "coverage" / top
    folder.mkdir(parents=True, exist_ok=True)
    harness = (ROOT / "tb" / "common").glob(f"{top}.sv")  # what is of the benches
    runner = get_runner("verilator")
    runner.build(
        sources=[*sources("vista_frontend.f"), *harness], hdl_toplevel=top, parameters=parameters,
        build_dir=folder,
        build_args=[*VERILATOR_FLAGS, "--coverage-line", "--coverage-toggle", "-CFLAGS", "-O1"],
        log_file=folder.with_suffix(".log"),
    )  # fmt: skip
    hits, data, wanted = folder / "bins.txt", folder / "all.dat", plan(block)
    hits.write_text("")
    data.write_text("")
    seed, hit = 0, set[str]()
    while wanted - hit and seed < MOST_SEEDS:
        seed += 1
        extra = {f"VISTA_{name.upper()}": str(value) for name, value in parameters.items()}
        runner.test(
            hdl_toplevel=top, test_module=f"bench_{top.removeprefix('vista_')}", build_dir=folder,
            test_dir=folder, plusargs=["+verilator+rand+reset+2", f"+verilator+seed+{seed}"],
            extra_env=extra | {"VISTA_SEED": str(seed), "VISTA_BINS": str(hits)}, log_file=folder / "run.log",
        )  # fmt: skip
        with data.open("a") as out:
            out.write((folder / "coverage.dat").read_text(errors="replace"))
        hit = set(hits.read_text().splitlines())
    print(
        f"{top}: functional: {100 * len(wanted & hit) / len(wanted):.1f} % of {len(wanted)} bins, {seed} runs"
    )
    for name in sorted(wanted - hit):
        print("  missed", name)
    failed = bool(wanted - hit)
    for kind, (percent, waived, missing) in percentages(data).items():
        print(f"{top}: {kind}: {percent:.1f} % ({waived} points waived)")
        for point in missing[:40]:
            print("  uncovered", point)
        failed |= percent < LIMITS.get(kind, 0)
    return failed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--of", choices=[block.top for block in BLOCKS], help="default: all")
    args = parser.parse_args()
    os.environ.update(verilator_environment(), COCOTB_LOG_LEVEL="WARNING")
    sys.exit(any([cover(block) for block in BLOCKS if args.of in (None, block.top)]))


if __name__ == "__main__":
    main()
