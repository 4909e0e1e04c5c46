"""Compares the RTL with the C model on many random frames: make soak. Continues where it stopped.

Frame n of a configuration is the one of seed n in tb/top/test_words.py, whose command reruns it.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "tb/top", "model", "build/python")]
from registers import ERRORS  # noqa: E402
from soak import soak  # noqa: E402
from test_words import run_seed  # noqa: E402
from tools import BUILD, sources  # noqa: E402
from verilated import Rtl  # noqa: E402
from vista_eval.jobs import add_place, chosen_place, exit_on_failure  # noqa: E402

FRAMES_EACH_JOB = 100


def check(rtl: Rtl, seed: int) -> None:
    run_seed(rtl, seed)  # fails with the command that reruns the frame
    assert rtl.read(ERRORS) == 0, f"seed {seed}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=10000, help="in all, over the configurations")
    add_place(parser)
    args = parser.parse_args()
    digest = hashlib.sha256(b"".join(f.read_bytes() for f in sources("vista_stereo.f"))).hexdigest()
    with exit_on_failure():
        frames = soak(check, digest, args.frames, FRAMES_EACH_JOB, chosen_place(args), BUILD / "soak")
    print(f"{frames} frames, 0 differing words")


if __name__ == "__main__":
    main()
