"""The instructions of a decision on AArch64 and on x86, as an emulator counts them, and its share of a frame.

The detector and the planner of both vehicles go through random scenes, and through KITTI odometry 00 where
its data are there (sw/tests/decisions.c). Words are given, as by a board: what matches them is not counted.
`make count-aarch64` builds what runs.

    count_plan.py [--scenes 14] [--out build/bench/plan_instructions.json]
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "sw" / "tests"), str(REPOSITORY / "build" / "python")]

import decision_scenes  # noqa: E402
from shared_data import SHARED_DATA  # noqa: E402
from vista.cli import main as vista  # noqa: E402
from vista_eval.report.table import Table, write_measurement  # noqa: E402

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
TOOLS = REPOSITORY / "build" / "tools"
BEGINS, JUDGED, DECIDED = range(3)  # marks of decisions.c
VEHICLES, LANES = ("multirotor", "fixed wing"), 8  # in the order of decisions.c
PROCESSORS = ("aarch64", "x86_64")
Counts = dict[str, list[int]]


def command_of(processor: str, marks: Path, recording: Path) -> list[str]:
    qemu = str(TOOLS / "counting/root/usr/bin" / f"qemu-{processor}")
    plugin = f"{TOOLS / 'counting/libcount_instructions.so'},out={marks}"
    if processor == "x86_64":
        return [
            qemu,
            "-cpu",
            "max",
            "-plugin",
            plugin,
            str(REPOSITORY / "build/bin/decisions"),
            str(recording),
        ]
    root = shlex.split((TOOLS / "aarch64/run").read_text().splitlines()[1])[3]
    program = str(REPOSITORY / "build/aarch64/bin/decisions")
    return [qemu, "-L", root, "-plugin", plugin, program, str(recording)]


def count(processor: str, recording: Path, folder: Path, counts: Counts) -> None:
    """Adds the instructions of the detector's frames and of each vehicle's decisions."""
    marks = folder / "marks.txt"
    libraries = str(TOOLS / "counting/root/usr/lib/x86_64-linux-gnu")
    subprocess.run(
        command_of(processor, marks, recording),
        stdout=subprocess.DEVNULL,
        check=True,
        env=os.environ | {"LD_LIBRARY_PATH": libraries},
    )
    decisions = 0
    for mark, instructions in (map(int, line.split()) for line in marks.read_text().splitlines()):
        if mark == JUDGED:
            counts["frame"].append(instructions)
            decisions = 0
        elif mark == DECIDED:
            counts[VEHICLES[decisions // LANES]].append(instructions)
            decisions += 1


def recordings(folder: Path, scenes: int) -> dict[str, list[Path]]:
    rng, kinds = np.random.default_rng(1), list(decision_scenes.KINDS)
    found = {
        "random scenes, 320x240": [
            decision_scenes.record(folder / f"{k}.rec", kinds[k % len(kinds)], rng) for k in range(scenes)
        ]
    }
    if STREET.is_dir():
        street = folder / "street.rec"
        arguments = ["run", STREET, "--out", folder / "out", "--no-overlay", "--record", street]
        if vista([str(argument) for argument in arguments]) == 0:
            found["KITTI odometry 00, 1226x370"] = [street]
    else:
        print(f"{STREET} is not there: random scenes alone are counted")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenes", type=int, default=14)
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    rows, figures = [], {}
    with TemporaryDirectory() as name:
        for what, files in recordings(Path(name), arguments.scenes).items():
            for processor in PROCESSORS:
                counts: Counts = defaultdict(list)
                for recording in files:
                    count(processor, recording, Path(name), counts)
                frame = float(np.median(counts["frame"])) / 1e6
                for vehicle in VEHICLES:
                    million = np.array(counts[vehicle]) / 1e6
                    middle, high, most = np.median(million), np.percentile(million, 99.9), million.max()
                    share = middle / (middle + frame)
                    figures[f"{what}; {processor}; {vehicle}"] = {
                        "decisions": len(million),
                        "median_p999_most": [middle, high, most],
                        "detector_median": frame,
                        "share_of_frame": share,
                    }
                    rows.append(
                        (
                            what,
                            processor,
                            vehicle,
                            f"{len(million)}",
                            *(f"{number:.1f}" for number in (middle, high, most, frame)),
                            f"{100 * share:.1f} %",
                        )
                    )
    of = ("over", "processor", "vehicle", "decisions")
    heads = (*of, "median", "p99.9", "most", "detector, median", "share of a frame")
    legend = "Millions of instructions, counted by qemu. Words are given. Share: of the sum of both medians."
    table = Table("plan-instructions", heads, rows, legend)
    print(table.as_text())
    if arguments.out is not None:
        write_measurement(arguments.out, [table], figures)
    return 0


if __name__ == "__main__":
    sys.exit(main())
