# SPDX-License-Identifier: Apache-2.0
"""Compares the SystemC engine with the Verilated RTL, clock by clock, on many cases: part of make soak.

Goes on where it stopped. Case n of a build is the one of seed n in
tb/top/test_system_model.py, whose command reruns it.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "model", "build/python")]
from soak import soak  # noqa: E402
from system_model import check_case, random_case  # noqa: E402
from tools import BUILD, sources  # noqa: E402
from verilated import CONFIGS, Rtl  # noqa: E402
from vista_eval.jobs import add_place, chosen_place, exit_on_failure  # noqa: E402

CASES_EACH_JOB = 10


def digest() -> str:
    """The digest of both sides."""
    model = [f for side in ("systemc", "c") for f in sorted((ROOT / "model" / side).rglob("*.[ch]*"))]
    files = [*sources("vista_stereo.f"), *model]
    return hashlib.sha256(b"".join(f.read_bytes() for f in files)).hexdigest()


def check(rtl: Rtl, seed: int) -> None:
    check_case(rtl, random_case(rtl.config, seed))  # fails with the command that reruns the case


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=200, help="in all, over the builds")
    add_place(parser)
    args = parser.parse_args()
    place, kept = chosen_place(args), BUILD / "soak_system_model"
    with exit_on_failure():
        cases = soak(check, CONFIGS, digest(), args.cases, CASES_EACH_JOB, place, kept)
    print(f"{cases} cases, 0 differences between the SystemC engine and the RTL")


if __name__ == "__main__":
    main()
