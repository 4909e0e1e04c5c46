"""Random cases by their seeds, over all builds, going on where an earlier run stopped."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

from registers import CONTROL
from verilated import CONFIGS, Rtl

KEEP_EVERY = 5


def soak(kept: Path, digest: str, total: int, check: Callable[[Rtl, int], None]) -> int:
    """Runs check(engine, seed) until each build has its share of `total` cases; returns how many that are.

    check raises for a case that fails. `kept` holds how many each build has passed, of the sources of
    `digest`: those of others do not count."""
    done = json.loads(kept.read_text()) if kept.is_file() else {}
    if done.get("digest") != digest:
        done = {"digest": digest}
    each = -(-total // len(CONFIGS))
    for config in CONFIGS:
        started, first = time.monotonic(), done.get(config.name, 0)
        with Rtl(config) as rtl:
            rtl.write(CONTROL, 1)
            for seed in range(first, each):
                check(rtl, seed)
                if seed % KEEP_EVERY == KEEP_EVERY - 1 or seed == each - 1:
                    done[config.name] = seed + 1
                    kept.write_text(json.dumps(done))
        print(
            f"{config.name}: {max(0, each - first)} cases more, {max(each, first)} in all, nothing differs "
            f"({time.monotonic() - started:.0f} s)",
            flush=True,
        )
    return each * len(CONFIGS)
