"""The one port: what it serves, who waits, and that waiting changes times but no word."""

from __future__ import annotations

from typing import Any

import pytest
from simulation import SMALL, delivered, simulate

pytestmark = pytest.mark.native

PIXELS = SMALL["width_px"] * SMALL["height_px"]


def masters(output: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {master["name"]: master for master in output["memory"]["masters"]}


@pytest.mark.parametrize("bandwidth", [20e6, 40e6, 400e6])
@pytest.mark.parametrize("arbitration", ["round_robin", "priority"])
def test_no_more_is_served_than_the_bandwidth(bandwidth: float, arbitration: str) -> None:
    output = simulate(
        memory_bandwidth_bytes_s=bandwidth,
        memory_arbitration=arbitration,
        memory_burst_overhead_ns=20,
        background_bytes_s=30e6,
        capture_fifo_bytes=1 << 20,
    )
    memory, time_ns = output["memory"], output["totals"]["simulated_ns"]
    served = sum(m["bytes"] for m in memory["masters"])
    bursts = sum(m["bursts"] for m in memory["masters"])
    assert memory["bytes"] == served <= bandwidth * time_ns / 1e9
    assert memory["busy_ns"] == pytest.approx(served * 1e9 / bandwidth + 20 * bursts, abs=1e-3 * bursts)
    assert memory["busy_ns"] <= time_ns + 256 / bandwidth * 1e9 + 20  # the last burst may end behind the end
    assert memory["utilisation"] == pytest.approx(memory["busy_ns"] / time_ns)


@pytest.mark.parametrize("result_bytes", [2, 4])
def test_every_master_moves_its_frames(result_bytes: int) -> None:
    found = masters(simulate(result_bytes_px=result_bytes, rectify_ms="0.1"))
    expected = {
        "capture": 2, "rectify": 4, "fetch0": 2, "result0": result_bytes, "host": result_bytes
    }  # fmt: skip
    assert {name: master["bytes"] for name, master in found.items()} == {
        name: 20 * PIXELS * per_pixel for name, per_pixel in expected.items()
    }


def test_contention_takes_time_but_changes_no_word() -> None:
    alone = simulate()
    crowded = simulate(engine_clock_hz=50e6, memory_bandwidth_bytes_s=90e6, buffer_policy="queue")
    assert alone["totals"]["starved"] == alone["totals"]["stalls_out"] == 0
    assert crowded["totals"]["starved"] > 0 and crowded["totals"]["stalls_out"] > 0
    crc = {f["frame"]: f["words_crc32"] for f in alone["frames"]}
    assert len(set(crc.values())) == 20
    assert delivered(crowded) and all(f["words_crc32"] == crc[f["frame"]] for f in delivered(crowded))


def test_priority_keeps_the_capture_from_waiting() -> None:
    keys = {"memory_bandwidth_bytes_s": 60e6, "background_bytes_s": 60e6, "capture_fifo_bytes": 1 << 20}
    waited = {
        arbitration: masters(simulate(memory_arbitration=arbitration, **keys))["capture"]
        for arbitration in ("round_robin", "priority")
    }
    each = {name: master["waited_ns"] / master["bursts"] for name, master in waited.items()}
    assert each["priority"] < each["round_robin"]
    assert each["priority"] <= 2 * 256 / 60e6 * 1e9  # the burst under way, and one of its own


def test_background_alone_takes_what_it_asks_for() -> None:
    output = simulate(background_bytes_s=50e6)
    asked = 50e6 * output["totals"]["simulated_ns"] / 1e9
    assert masters(output)["background"]["bytes"] == pytest.approx(asked, abs=2 * 256)


def test_memory_too_slow_for_the_camera_drops_whole_frames() -> None:
    output = simulate(memory_bandwidth_bytes_s=8e6, capture_fifo_bytes=1024)
    lost = [f for f in output["frames"] if f["dropped"] == "overflow"]
    assert lost and all(f["capture_end_ns"] is None and f["engine_start_ns"] is None for f in lost)
