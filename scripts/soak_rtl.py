"""Random frames against the C model, in numbers: make soak. Goes on where it stopped (build/rtl/soak.json).

Frame n of a configuration is the one of seed n in tb/top/test_words.py, whose command reruns it.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "tb/top", "model", "build/python")]
from registers import CONTROL, ERRORS  # noqa: E402
from test_words import run_seed  # noqa: E402
from tools import BUILD, sources  # noqa: E402
from verilated import CONFIGS, Rtl  # noqa: E402


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=10000, help="in all, over the configurations")
    args = parser.parse_args()
    kept = BUILD / "soak.json"
    digest = hashlib.sha256(b"".join(f.read_bytes() for f in sources("vista_stereo.f"))).hexdigest()
    done = json.loads(kept.read_text()) if kept.is_file() else {}
    if done.get("digest") != digest:  # frames of other sources do not count
        done = {"digest": digest}
    each = -(-args.frames // len(CONFIGS))
    for config in CONFIGS:
        started, first = time.monotonic(), done.get(config.name, 0)
        with Rtl(config) as rtl:
            rtl.write(CONTROL, 1)
            for seed in range(first, each):
                run_seed(rtl, seed)  # fails with the command that reruns the frame
                if seed % 100 == 99 or seed == each - 1:
                    done[config.name] = seed + 1
                    kept.write_text(json.dumps(done))
            assert rtl.read(ERRORS) == 0
        print(
            f"{config.name}: {each - first} frames more, {each} in all, no word differs "
            f"({time.monotonic() - started:.0f} s)",
            flush=True,
        )
    print(f"{each * len(CONFIGS)} frames, 0 differing words")


if __name__ == "__main__":
    main()
