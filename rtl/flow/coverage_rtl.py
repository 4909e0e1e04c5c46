# SPDX-License-Identifier: Apache-2.0
"""Coverage of the engine: line, toggle and the plan of doc/design/verification.md: make coverage-rtl.

Runs random frames, with random stalls and faults, until every bin of the plan was hit (or a limit is
reached), then reads Verilator's counts. Points waived in tb/coverage_waivers.txt are left out and counted.
"""

from __future__ import annotations

import itertools
import re
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / p) for p in ("tb/common", "model", "build/python")]
from broken_video import FAULTS, fault_size  # noqa: E402
from faults import expected_after, react  # noqa: E402
from frames import Frame, beats, random_frame, random_pair, set_up  # noqa: E402
from registers import CONTROL, ERRORS, registers  # noqa: E402
from tools import BUILD  # noqa: E402
from verilated import Config, Pace, Rtl  # noqa: E402

LIMITS = {"line": 95.0, "branch": 90.0, "toggle": 90.0}
PACES = {"always": Pace(), "often": Pace(300, 300), "bursts": Pace(40, 20)}
CONFIG = Config(16, 5, 128, confidence=True, coverage=True)
WIDTH, HEIGHT = fault_size(CONFIG.num_disparities, CONFIG.block_size)


def lr_bin(lr_max_diff: int | None) -> str:
    return "off" if lr_max_diff is None else "strict" if lr_max_diff == 0 else "tolerant"


def plan() -> set[tuple[str, ...]]:
    """The bins of the functional plan."""
    paces = list(itertools.product(PACES, PACES))
    parameters = set(
        itertools.product(
            ["parameters"], ["xsobel", "none"], ["unique", "any"], ["off", "strict", "tolerant"]
        )
    )
    sizes = set(itertools.product(["size"], ["even", "odd"], ["matched", "narrow", "low"]))
    stalls = {("stalls", a, b, e) for a, b in paces for e in ["good", "faulty"]}
    faults = {("fault", f.__name__) for f in FAULTS}
    formats = set(itertools.product(["format"], ["wide", "narrow", "confidence"], ["good", "faulty"]))
    return parameters | sizes | stalls | faults | formats


def run_frame(rtl: Rtl, seed: int, hit: set[tuple[str, ...]]) -> None:
    rng = np.random.default_rng(seed)
    names = [list(PACES)[i] for i in rng.integers(0, len(PACES), 2)]
    frame = random_frame(rng, CONFIG.num_disparities, CONFIG.block_size, CONFIG.max_width)
    p, (height, width) = frame.parameters, frame.shape
    fault = FAULTS[rng.integers(len(FAULTS))] if rng.random() < 0.5 else None
    if fault:
        frame = Frame(*random_pair(rng, "shifted", HEIGHT, WIDTH), p)
        height, width = HEIGHT, WIDTH
    words = str(rng.choice(["wide", "narrow", "confidence"], p=[0.4, 0.3, 0.3]))
    frame.narrow, frame.confidence = words == "narrow", words == "confidence"
    stream = beats(frame.left, frame.right)
    if fault:
        stream = np.concatenate(
            [
                fault(stream, WIDTH, int(rng.integers(1, WIDTH * HEIGHT - 1)), rng),
                beats(frame.left, frame.right),
            ]
        )
        hit.add(("fault", fault.__name__))
    set_up(rtl, frame)
    reaction = react(stream, width, height)
    formats = frame.narrow, frame.confidence
    expected = [expected_after(received, width, height, p, *formats) for received in reaction.frames]
    count = sum(map(len, expected))
    got = rtl.stream(stream, count, PACES[names[0]], PACES[names[1]], seed)
    assert (got.words == np.concatenate(expected)).all(), f"seed {seed}"
    rtl.write(ERRORS, 31)
    hit.add(("format", words, "faulty" if reaction.errors else "good"))
    hit.add(("stalls", *names, "faulty" if reaction.errors else "good"))
    hit.add(("parameters", p.prefilter, "unique" if p.uniqueness_ratio else "any", lr_bin(p.lr_max_diff)))
    narrow = width < CONFIG.num_disparities + CONFIG.block_size - 1
    hit.add(
        (
            "size",
            "odd" if height % 2 else "even",
            "narrow" if narrow else "low" if height < CONFIG.block_size else "matched",
        )
    )


def percentages(data: Path) -> dict[str, tuple[float, int, list[str]]]:
    """The coverage of each kind: percent, points waived, points left uncovered."""
    waivers = [
        re.compile(line.split(" :: ")[0])
        for line in (ROOT / "tb/coverage_waivers.txt").read_text().splitlines()
        if " :: " in line
    ]
    points: dict[tuple[str, str], int] = {}
    for line in data.read_text(errors="replace").splitlines():
        if not line.startswith("C '"):
            continue
        text, count = line[3:].rsplit("' ", 1)
        keys = dict(item.split("\x02", 1) for item in text.split("\x01") if "\x02" in item)
        if keys["f"].endswith(".svh"):  # the properties, which are no part of the engine
            continue
        kind = keys["page"].split("/")[0].removeprefix("v_")
        name = f"{Path(keys['f']).name}:{keys['l']}:{keys.get('o', '')}"
        points[kind, name] = points.get((kind, name), 0) + int(count)
    result = {}
    for kind in sorted({k for k, _ in points}):
        names = {n: c for (k, n), c in points.items() if k == kind}
        waived = {n for n, c in names.items() if c == 0 and any(w.search(n) for w in waivers)}
        counted = {n: c for n, c in names.items() if n not in waived}
        missing = sorted(n for n, c in counted.items() if c == 0)
        result[kind] = (100 * (1 - len(missing) / len(counted)), len(waived), missing)
    return result


def main() -> None:
    hit: set[tuple[str, ...]] = set()
    wanted = plan()
    BUILD.mkdir(parents=True, exist_ok=True)
    data = BUILD / "coverage.dat"
    rng = np.random.default_rng(1)
    with Rtl(CONFIG) as rtl:
        for address, _ in registers().values():
            for value in (0xFFFFFFFF, 0, *map(int, rng.integers(0, 1 << 32, 4))):
                rtl.write(address, value)
                rtl.read(address)
        rtl.write(CONTROL, 1)
        seed = 0
        while (wanted - hit or seed < 300) and seed < 2000:
            run_frame(rtl, seed, hit)
            seed += 1
        rtl.write_coverage(data)
    print(f"functional: {100 * len(wanted & hit) / len(wanted):.1f} % of {len(wanted)} bins, {seed} runs")
    for name in sorted(wanted - hit):
        print("  missed", *name)
    failed = bool(wanted - hit)
    for kind, (percent, waived, missing) in percentages(data).items():
        print(f"{kind}: {percent:.1f} % ({waived} points waived)")
        for point in missing[:40]:
            print("  uncovered", point)
        failed |= percent < LIMITS.get(kind, 0)
    sys.exit(failed)


if __name__ == "__main__":
    main()
