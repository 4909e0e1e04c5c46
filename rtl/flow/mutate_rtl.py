# SPDX-License-Identifier: Apache-2.0
"""Plants random mutants into the engine and counts how many of them the benches catch: make mutate.

Yosys picks mutations of a flattened module and puts all of them into one netlist, chosen by an input. One
Verilated build then serves every mutant. Caught means: a word, its framing or the pace differs, or nothing
comes. The core is driven from here, the blocks of the front end by their cocotb benches. Of a mutant that no
bench catches a proof is tried that nothing can tell it from the whole netlist (equivalent_mutant.py). The
share that is caught is one of those that are not proved.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from cocotb_tools.runner import get_runner

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "tb/units", "model", "build/python")]
from behind_writes import LAST, behind_the_first_pixel, right_behind  # noqa: E402
from broken_video import FAULTS, fault_size  # noqa: E402
from faults import expected_after, react  # noqa: E402
from frames import Frame, beats, expected_flags, random_frame, random_pair, set_up  # noqa: E402
from raw_frames import random_one  # noqa: E402
from registers import CONTROL, ERRORS, FRAMES_IN, FRAMES_OUT, INTERRUPT, STOPPED  # noqa: E402
from stops import stopped_inside  # noqa: E402
from tools import BUILD, sources, verilator_environment  # noqa: E402
from verilated import PACES, Config, Pace, Rtl, Stand  # noqa: E402
from vista_eval.cache import digest_of  # noqa: E402
from vista_eval.jobs import Job, add_place, chosen_place, exit_on_failure, run  # noqa: E402

MUTANTS = tuple(BUILD / "mutate" / "vista_stereo_core" / name for name in ("mutants.v", "core.sv"))


def with_mutants(_: Config) -> list[Path]:
    """The sources, with the mutants in place of the core."""
    return [f for f in sources("vista_stereo.f") if f.name != "vista_stereo_core.sv"] + list(MUTANTS)


CONFIG = Config(16, 5, 64, stand=Stand("mutants", MUTANTS, with_mutants, has_parameters=True))
WIDTH, HEIGHT = fault_size(CONFIG.num_disparities, CONFIG.block_size)
NARROWEST = CONFIG.num_disparities + CONFIG.block_size - 1  # of the frames that are matched


@dataclass(frozen=True)
class Target:
    """What mutants are planted into, as it is built."""

    top: str
    parameters: tuple[tuple[str, int], ...]
    file_list: str = "vista_frontend.f"

    @property
    def folder(self) -> Path:
        return BUILD / "mutate" / self.top

    @property
    def mutants(self) -> str:
        return f"{self.top}_mutants"

    @property
    def netlist(self) -> Path:
        """Returns the place of the netlist without a mutation, for the proofs."""
        return self.folder / "netlist.il"


CORE = Target(
    "vista_stereo_core",
    (
        ("NumDisparities", CONFIG.num_disparities),
        ("BlockSize", CONFIG.block_size),
        ("MaxWidth", CONFIG.max_width),
    ),
    "vista_stereo_core.f",
)
TARGETS = {
    "core": CORE,
    "confidence": Target("vista_confidence", (("NumDisparities", 16), ("CostW", 17)), "vista_stereo_core.f"),
    "smooth": Target("vista_smooth", (("MaxWidth", 32), ("SideWidth", 8))),
    "rectify": Target(
        "vista_rectify", (("MaxWidth", 40), ("NumRows", 16), ("MaxPoints", 16), ("SideWidth", 8))
    ),
    "pyramid": Target("vista_pyramid", (("MaxWidth", 40), ("SideWidth", 8))),
}
LIMIT = 0.9
SURVIVES, EQUIVALENT = "SURVIVES", "equivalent"
PROOF = Path(__file__).with_name("equivalent_mutant.py")
SELECT_BITS = 10  # of mutsel
FRAMES = 300  # for a mutant to survive,
TALL_EACH, TALLEST = 30, 4096  # one of so many, with fewer rows than that,
WRITES, STOPS = 30, 10  # frames right behind writes, and stops


def make_mutants(target: Target, count: int, seed: int) -> list[str]:
    """Writes mutants.v, the module with an input `mutsel`; n chooses the n-th mutation returned."""
    folder = target.folder
    folder.mkdir(parents=True, exist_ok=True)
    parameters = " ".join(f"-G {name}={value}" for name, value in target.parameters)
    files = " ".join(str(f) for f in sources(target.file_list))
    script = f"""
from pyosys import libyosys as ys
import pathlib
design = ys.Design()
def run(command): ys.run_pass(command, design)
run("read_slang --top {target.top} {parameters} {files}")
run("hierarchy -top {target.top}; proc; flatten; opt -full; memory_collect; opt_clean")
run("rename {target.top} {target.mutants}; write_rtlil {target.netlist.name}")
run("mutate -list {count} -seed {seed} -o mutations.txt -ctrl mutsel {SELECT_BITS} 1")
lines = [l for l in pathlib.Path("mutations.txt").read_text().splitlines() if l]
for n, line in enumerate(lines, 1):
    run(line)
run("bwmuxmap; opt_clean; write_verilog -noattr mutants.v")
"""
    (folder / "make.py").write_text(script)
    run_yosys(folder, "yosys.log", "make.py").check_returncode()
    run_yosys(folder, "whole.log", PROOF, target.netlist).check_returncode()
    return [line for line in (folder / "mutations.txt").read_text().splitlines() if line]


def run_yosys(folder: Path, log: str, *command: str | Path) -> subprocess.CompletedProcess[bytes]:
    """Runs a script of Yosys, which takes over the process that imports it."""
    with (folder / log).open("w") as out:
        python = ROOT / ".venv/bin/python"
        return subprocess.run([str(part) for part in (python, *command)], cwd=folder, stdout=out, stderr=out)


def proved_equivalent(target: Target, number: int) -> str | None:
    lines = (target.folder / "mutations.txt").read_text().split("\n")
    mutation = re.sub(r"-ctrl \S+ \d+ \d+ ", "", lines[number - 1])  # alone, and for ever
    proof = run_yosys(target.folder, f"proof_{number}.log", PROOF, target.netlist, mutation)
    return None if proof.returncode else EQUIVALENT


def write_core() -> None:
    """Writes what stands in for the core: its ports, and inside the netlist, whose mutant a bench chooses."""
    header = (ROOT / "rtl" / "src" / "vista_stereo_core.sv").read_text().partition("\n);\n")[0]
    body = f"""
);

  logic [{SELECT_BITS - 1}:0] mutsel /*verilator public_flat_rw*/;

  vista_stereo_core_mutants u_mutants (.*);

endmodule
"""
    MUTANTS[1].write_text(header + body)


def caught(rtl: Rtl) -> str | None:
    """What gave the mutant away."""
    return caught_by_frames(rtl) or caught_by_writes(rtl)


def caught_by_writes(rtl: Rtl) -> str | None:
    """Looks at frames right behind writes, and stops; rtl: took whole frames, and has none inside."""
    try:
        for seed in range(WRITES):
            rng = np.random.default_rng(seed)
            behind_the_first_pixel(rtl, rng, seed)
            right_behind(rtl, rng, LAST[seed % len(LAST)], seed)
        rtl.write(INTERRUPT, STOPPED)  # writes have stopped it as well
        for seed in range(STOPS):
            rng = np.random.default_rng(seed)
            stopped_inside(rtl, random_one(rng, CONFIG), rng, seed)
    except AssertionError:
        return "writes"
    return None


def caught_by_frames(rtl: Rtl) -> str | None:
    rtl.write(CONTROL, 1)
    lost = True
    for seed in range(FRAMES):
        rng = np.random.default_rng(seed)
        frame = random_frame(rng, CONFIG.num_disparities, CONFIG.block_size, CONFIG.max_width)
        stream = beats(frame.left, frame.right)
        paces = PACES[rng.integers(len(PACES))], PACES[rng.integers(len(PACES))]
        if seed % TALL_EACH == 0:
            height = int(2 ** rng.uniform(7, np.log2(TALLEST)))
            frame = Frame(*random_pair(rng, "shifted", height, NARROWEST), frame.parameters)
            stream = beats(frame.left, frame.right)
        elif seed % 3 == 2:
            frame = Frame(*random_pair(rng, "shifted", HEIGHT, WIDTH), frame.parameters)
            fault = FAULTS[rng.integers(len(FAULTS))]
            stream = beats(frame.left, frame.right)
            stream = np.concatenate(
                [fault(stream.copy(), WIDTH, int(rng.integers(1, WIDTH * HEIGHT - 1)), rng), stream]
            )
        elif seed % 3 == 1:
            paces = Pace(), Pace()
            stream = np.tile(stream, 3)
        else:
            frame.narrow = seed % 2 == 0
        height, width = frame.shape
        set_up(rtl, frame)
        reaction = react(stream, width, height, lost)
        lost = reaction.lost
        expected = [expected_after(r, width, height, frame.parameters, frame.narrow) for r in reaction.frames]
        count = sum(map(len, expected))
        got = rtl.stream(stream, count, *paces, seed, quiet=4000)
        if got.taken != len(stream) or len(got.words) != count:
            return "hangs"
        if (got.words != np.concatenate(expected)).any():
            return "words"
        if (got.flags != np.tile(expected_flags(height, width, frame.narrow), len(reaction.frames))).any():
            return "framing"
        if seed % 3 == 1 and (np.diff(got.in_clock) != 1).any():
            return "pace"
        if rtl.read(ERRORS) != reaction.errors:
            return "errors"
        rtl.write(ERRORS, 31)
    return "counters" if rtl.read(FRAMES_IN) != rtl.read(FRAMES_OUT) else None


def build_bench(target: Target) -> None:
    for name, value in verilator_environment().items():
        os.environ[name] = value
    get_runner("verilator").build(
        sources=[target.folder / "mutants.v"], hdl_toplevel=target.mutants, build_dir=target.folder / "bench",
        build_args=["-Wno-fatal", "-Wno-lint", "--x-initial", "unique", "-CFLAGS", "-O1"],
        log_file=target.folder / "bench.log",
    )  # fmt: skip


def failing_test(target: Target, number: int) -> str | None:
    """The first test of the module's bench that a mutant fails."""
    folder = target.folder / "runs" / str(number)
    extra = {f"VISTA_{name.upper()}": str(value) for name, value in target.parameters}
    os.environ["COCOTB_LOG_LEVEL"] = "WARNING"
    try:
        results = get_runner("verilator").test(
            hdl_toplevel=target.mutants, test_module=f"bench_{target.top.removeprefix('vista_')}",
            build_dir=target.folder / "bench", test_dir=folder, hdl_toplevel_lang="verilog",
            plusargs=["+verilator+rand+reset+2", "+verilator+seed+1"], log_file=folder / "run.log",
            extra_env=extra | {"VISTA_MUTANT": str(number), "COCOTB_MAX_FAILURES": "1"},
        )  # fmt: skip
        text = results.read_text()
    except (SystemExit, RuntimeError, FileNotFoundError):  # a test failed, or the simulator stopped
        text = "<failure"
    return "bench" if "<failure" in text or "<error" in text or "<testcase" not in text else None


def verdict_of(target: Target, number: int) -> str:
    """The verdict on one mutant; 0 is the netlist without a mutation."""
    return found_by_bench(target, number) or (number and proved_equivalent(target, number)) or SURVIVES


def found_by_bench(target: Target, number: int) -> str | None:
    if target != CORE:
        return failing_test(target, number)
    with Rtl(CONFIG) as rtl:
        rtl.select_mutant(number)
        return caught(rtl)


def jobs_of_mutants(target: Target, count: int) -> list[Job]:
    """A verdict holds as long as the mutants and what drives them are the same."""
    drivers = sorted([*(ROOT / "tb" / "common").glob("*.py"), *(ROOT / "tb" / "units").glob("*.py")])
    digest = digest_of(target.folder / "mutants.v", Path(__file__), PROOF, *drivers)
    numbers = range(1, count + 1)
    return [Job(f"mutant {n}", partial(verdict_of, target, n), digest_of(f"{digest} {n}")) for n in numbers]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--of", choices=TARGETS, default="core", help="what to plant them into")
    parser.add_argument("--mutants", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    add_place(parser)
    args = parser.parse_args()
    if not 0 < args.mutants < 1 << SELECT_BITS:
        parser.error(f"--mutants: {args.mutants} is outside 1 .. {(1 << SELECT_BITS) - 1}")
    target = TARGETS[args.of]
    mutations = make_mutants(target, args.mutants, args.seed)
    if target == CORE:
        write_core()
    else:
        build_bench(target)
    verdict = verdict_of(target, 0)
    assert verdict == SURVIVES, f"the netlist without a mutation fails: {verdict}"
    jobs = jobs_of_mutants(target, len(mutations))
    with exit_on_failure():
        verdicts = run(jobs, chosen_place(args), "mutants", "mutant", target.folder / "verdicts")
    for number, (mutation, verdict) in enumerate(zip(mutations, verdicts, strict=True), 1):
        print(f"{number:3} {verdict}" + f": {mutation}" * (verdict in (SURVIVES, EQUIVALENT)), flush=True)
    survive, equivalent = (verdicts.count(verdict) for verdict in (SURVIVES, EQUIVALENT))
    caught_count = len(verdicts) - survive - equivalent
    share = caught_count / (len(verdicts) - equivalent)
    print(
        f"{caught_count} of {len(verdicts)} mutants caught, {equivalent} proved to be equivalent, "
        f"{survive} survive: {100 * share:.1f} % of the others"
    )
    sys.exit(share < LIMIT)


if __name__ == "__main__":
    main()
