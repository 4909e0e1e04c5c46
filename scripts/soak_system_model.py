"""The SystemC engine against the Verilated RTL, clock by clock, in numbers: part of make soak.

Goes on where it stopped (build/rtl/soak_system_model.json). Case n of a build is the one of seed n in
tb/top/test_system_model.py, whose command reruns it.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "model", "build/python")]
from system_model import check_case, random_case  # noqa: E402
from tools import BUILD, sources  # noqa: E402
from verilated import CONFIGS, Rtl  # noqa: E402

KEEP_EVERY = 5


def digest() -> str:
    """Of both sides; cases of other sources do not count."""
    model = [f for side in ("systemc", "c") for f in sorted((ROOT / "model" / side).rglob("*.[ch]*"))]
    files = [*sources("vista_stereo.f"), *model]
    return hashlib.sha256(b"".join(f.read_bytes() for f in files)).hexdigest()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=200, help="in all, over the builds")
    args = parser.parse_args()
    kept = BUILD / "soak_system_model.json"
    done = json.loads(kept.read_text()) if kept.is_file() else {}
    if done.get("digest") != digest():
        done = {"digest": digest()}
    each = -(-args.cases // len(CONFIGS))
    for config in CONFIGS:
        started, first = time.monotonic(), done.get(config.name, 0)
        with Rtl(config) as rtl:
            for seed in range(first, each):
                check_case(rtl, random_case(config, seed))  # fails with the command that reruns the case
                if seed % KEEP_EVERY == KEEP_EVERY - 1 or seed == each - 1:
                    done[config.name] = seed + 1
                    kept.write_text(json.dumps(done))
        print(
            f"{config.name}: {max(0, each - first)} cases more, {max(each, first)} in all, no clock, word or "
            f"stall differs ({time.monotonic() - started:.0f} s)",
            flush=True,
        )
    print(f"{each * len(CONFIGS)} cases, 0 differences between the SystemC engine and the RTL")


if __name__ == "__main__":
    main()
