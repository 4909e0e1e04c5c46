"""Instructions of the engine on AArch64, NEON beside plain C: count_instructions.py, after make aarch64.

qemu carries out one instruction at a time and reports each; what a run without a pair takes is subtracted.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "model"), str(ROOT / "model/tests"), str(ROOT / "build/python")]
from aarch64_program import ISAS, PROGRAM, RUN, record  # noqa: E402
from vista_model import Parameters  # noqa: E402

WIDTH, HEIGHT = 320, 60


def instructions(asked: bytes) -> int:
    """qemu writes a line for each."""
    command = [str(RUN), "-singlestep", "-d", "exec,nochain", "-D", "/dev/stderr", str(PROGRAM)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as process:
        assert process.stdin is not None and process.stderr is not None
        process.stdin.write(asked)
        process.stdin.close()
        count = 0
        while block := process.stderr.read(1 << 20):
            count += block.count(b"\n")
    if process.returncode != 0:
        sys.exit(f"{PROGRAM}: exit status {process.returncode}")
    return count


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    rng = np.random.default_rng(1)
    left, right = rng.integers(0, 256, (2, HEIGHT, WIDTH), dtype=np.uint8)
    nothing = instructions(b"")
    print("| disparities | " + " | ".join(f"{isa}, per pixel" for isa in ISAS) + " | ratio |")
    print("|---|---|---|---|")
    for disparities in (16, 32, 64, 128):
        parameters = Parameters(num_disparities=disparities)
        counts = [instructions(record(left, right, parameters, isa)) - nothing for isa in ISAS]
        each = " | ".join(f"{count / (WIDTH * HEIGHT):.0f}" for count in counts)
        print(f"| {disparities} | {each} | {counts[1] / counts[0]:.1f} |", flush=True)


if __name__ == "__main__":
    main()
