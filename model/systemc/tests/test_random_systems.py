"""Random systems, many of them overloaded: what must hold whatever happens."""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from simulation import simulate
from vista_model.c_engine import CEngine
from vista_model.engine import Parameters

pytestmark = pytest.mark.native

FRAMES, IMAGES = 12, 5
STEPS = [
    "capture_start_ns", "capture_end_ns", "rectify_start_ns", "rectify_end_ns", "fetch_start_ns",
    "engine_start_ns", "engine_first_word_ns", "engine_last_word_ns", "result_end_ns", "host_start_ns",
    "host_end_ns",
]  # fmt: skip


def random_system(rng: np.random.Generator) -> dict[str, Any]:
    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    burst = int(2 ** rng.integers(4, 10))
    system: dict[str, Any] = {
        "width_px": int(rng.integers(20, 150)), "height_px": int(rng.integers(3, 40)),
        "disparities": int(16 * rng.integers(1, 4)), "block_px": int(2 * rng.integers(2, 7) + 1),
        "engine_clock_hz": between(1e6, 200e6), "lanes": int(rng.integers(1, 4)),
        "camera_rate_hz": 0, "camera_pixel_clock_hz": between(1e6, 50e6),
        "camera_horizontal_blanking_px": int(rng.integers(0, 100)),
        "memory_bandwidth_bytes_s": between(5e6, 1e9), "memory_latency_ns": between(1, 3000),
        "memory_burst_overhead_ns": int(rng.integers(2)) * between(1, 200),
        "memory_arbitration": rng.choice(["round_robin", "priority"]), "burst_bytes": burst,
        "dma_fifo_bytes": int(burst * rng.integers(2, 9)),
        "capture_fifo_bytes": int(burst * rng.integers(2, 99)),
        "background_bytes_s": int(rng.integers(2)) * between(1e5, 1e8),
        "result_bytes_px": int(rng.choice([2, 4])), "buffers": int(rng.integers(2, 4)),
        "buffer_policy": rng.choice(["latest", "queue"]), "host_cores": int(rng.integers(1, 3)),
        "host_stage": {"all": [between(0.01, 5) for _ in range(5)]},
        "frames": FRAMES, "seed": int(rng.integers(1000)),
    }  # fmt: skip
    if rng.integers(2):
        system["rectify_ms"] = between(0.01, 5)
    return system


def expected_crcs(system: dict[str, Any], left: np.ndarray, right: np.ndarray) -> list[str]:
    engine = CEngine(Parameters(system["disparities"], system["block_px"]))
    crcs = []
    for n in range(FRAMES):
        disparity, smin = engine.compute(left[n % IMAGES], right[n % IMAGES])
        words = (disparity.view(np.uint16) | np.minimum(smin, 0xFFFF) << 16).astype("<u4")
        bytes_sent = words if system["result_bytes_px"] == 4 else disparity
        crcs.append(f"{zlib.crc32(bytes_sent.tobytes()):08x}")
    return crcs


@pytest.mark.parametrize("seed", [int(os.environ["VISTA_SEED"])] if "VISTA_SEED" in os.environ else range(25))
def test_whatever_happens(seed: int, tmp_path: Path) -> None:
    print(f"rerun: VISTA_SEED={seed} .venv/bin/python -m pytest model/systemc/tests/test_random_systems.py")
    rng = np.random.default_rng(seed)
    system = random_system(rng)
    left, right = rng.integers(0, 256, (2, IMAGES, system["height_px"], system["width_px"]), np.uint8)
    (tmp_path / "left").write_bytes(left.tobytes())
    (tmp_path / "right").write_bytes(right.tobytes())
    output = simulate(**system, left_images=tmp_path / "left", right_images=tmp_path / "right")

    totals, memory = output["totals"], output["memory"]
    assert totals["delivered"] + totals["dropped"] == FRAMES
    assert totals["dropped"] == sum(totals["drops"].values())
    at_most = system["memory_bandwidth_bytes_s"] * totals["simulated_ns"] / 1e9
    assert memory["bytes"] <= at_most + system["burst_bytes"]  # the last burst may be under way
    for kind in ("captured", "rectified", "result"):
        pool = output["buffers"][kind]
        assert pool is None or pool["high_water"] <= pool["count"] == system["buffers"] + system["lanes"] - 1
    crcs = expected_crcs(system, left, right)
    pixels = left[0].size
    for frame in output["frames"]:
        times = [frame[step] for step in STEPS if frame[step] is not None]
        assert times == sorted(times)
        if frame["dropped"] is None:
            assert frame["words_crc32"] == crcs[frame["frame"]]
            passed = frame["engine_last_pixel_clock"] - frame["engine_start_clock"] + 1
            assert passed == pixels + frame["stalls_in"] + frame["starved"]
