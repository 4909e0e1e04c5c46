"""Coverage of the blocks before the core: line, toggle and the plan of doc/design/verification.md.

Runs the cocotb benches of smoothing and pyramid, each with further seeds until every bin of the plan was hit
(or a limit is reached), then reads Verilator's counts as scripts/coverage_rtl.py does.
"""

from __future__ import annotations

import itertools
import os
import sys

from coverage_rtl import LIMITS, ROOT, percentages

sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "tb/units", "model", "build/python")]
from cocotb_tools.runner import get_runner  # noqa: E402
from tools import BUILD, VERILATOR_FLAGS, sources, verilator_environment  # noqa: E402

MOST_SEEDS = 20
# Parameters, and how many settings there are: smoothing off and on; 0 to 5 levels.
BLOCKS = {
    "vista_smooth": ({"MaxWidth": 32, "SideWidth": 8}, 2),
    "vista_pyramid": ({"MaxWidth": 40, "SideWidth": 8}, 6),
}
ENDS = ["whole", "first", "top", "cut"]


def plan(options: int) -> set[str]:
    """The bins of a block."""
    paces = ["always", "pauses"]
    bins = itertools.chain(
        itertools.product(["size"], ["smallest", "widest", "even", "odd"], ["smallest", "even", "odd"]),
        itertools.product(["end"], ["whole", "cut"], map(str, range(options))),
        itertools.product(["pace"], paces, paces, ENDS),
    )
    return {" ".join(parts) for parts in bins}


def cover(top: str, parameters: dict[str, int], options: int) -> bool:
    """Whether a block falls short of a limit."""
    folder = BUILD / "coverage" / top
    folder.mkdir(parents=True, exist_ok=True)
    runner = get_runner("verilator")
    runner.build(
        sources=sources("vista_frontend.f"), hdl_toplevel=top, parameters=parameters, build_dir=folder,
        build_args=[*VERILATOR_FLAGS, "--coverage-line", "--coverage-toggle", "-CFLAGS", "-O1"],
        log_file=folder.with_suffix(".log"),
    )  # fmt: skip
    hits, data, wanted = folder / "bins.txt", folder / "all.dat", plan(options)
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
    os.environ.update(verilator_environment(), COCOTB_LOG_LEVEL="WARNING")
    sys.exit(any([cover(top, *settings) for top, settings in BLOCKS.items()]))


if __name__ == "__main__":
    main()
