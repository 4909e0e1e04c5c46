# SPDX-License-Identifier: Apache-2.0
"""Compares the RTL with the models on many random frames: make soak. Continues where it stopped.

Frame n of a configuration of the core is the one of seed n in tb/top/test_words.py, whose command reruns it.
Of the engine with its front end seed n is a case of ten frames, each with size, switches, levels, parameters
and a map of its own: those of seed n in tb/top/test_front_end.py, half of them one after the other, half
back to back.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "model", "build/python")]
from frames import run_seed  # noqa: E402
from raw_frames import back_to_back, one_after_the_other  # noqa: E402
from registers import ERRORS  # noqa: E402
from soak import soak  # noqa: E402
from tools import BUILD, sources  # noqa: E402
from verilated import CONFIGS, FRONT_ENDS, Rtl  # noqa: E402
from vista_eval.jobs import add_place, chosen_place, exit_on_failure  # noqa: E402

FRAMES_EACH_JOB = 100
FRAMES_EACH_CASE = 10  # of the front end


def check(rtl: Rtl, seed: int) -> None:
    run_seed(rtl, seed)  # fails with the command that reruns the frame
    assert rtl.read(ERRORS) == 0, f"seed {seed}"


def check_front_end(rtl: Rtl, seed: int) -> None:
    try:
        one_after_the_other(rtl, seed, FRAMES_EACH_CASE // 2)
        back_to_back(rtl, seed, FRAMES_EACH_CASE // 2)
        assert rtl.read(ERRORS) == 0
    except AssertionError as error:
        raise AssertionError(f"seed {seed}: {error}") from error


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--of", choices=["core", "front_end"], default="core")
    parser.add_argument("--frames", type=int, default=10000, help="in all, over the configurations")
    add_place(parser)
    args = parser.parse_args()
    if args.of == "core":
        file_list, checked, configs, each_case = "vista_stereo.f", check, CONFIGS, 1
    else:
        file_list, checked, configs = "vista_stereo.f", check_front_end, FRONT_ENDS
        each_case = FRAMES_EACH_CASE
    digest = hashlib.sha256(b"".join(f.read_bytes() for f in sources(file_list))).hexdigest()
    place, kept = chosen_place(args), BUILD / f"soak_{args.of}"
    with exit_on_failure():
        cases = soak(
            checked, configs, digest, args.frames // each_case, FRAMES_EACH_JOB // each_case, place, kept
        )
    print(f"{cases * each_case} frames of {args.of}, 0 differing words")


if __name__ == "__main__":
    main()
