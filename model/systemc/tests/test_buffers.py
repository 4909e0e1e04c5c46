"""Double and triple buffering, what is dropped when a stage falls behind, and lanes."""

from __future__ import annotations

from typing import Any

import pytest
from simulation import delivered, simulate

pytestmark = pytest.mark.native


def rate_hz(output: dict[str, Any]) -> float:
    """The rate of the frames delivered, start-up left out."""
    ends = [f["host_end_ns"] for f in delivered(output)][2:]
    return 1e9 * (len(ends) - 1) / (ends[-1] - ends[0])


def test_a_chain_that_keeps_up_drops_nothing() -> None:
    output = simulate(host_stage={"all": [0.5]})
    assert output["totals"]["delivered"] == 20 and output["totals"]["dropped"] == 0
    assert rate_hz(output) == pytest.approx(1000, rel=1e-3)


@pytest.mark.parametrize("buffers", [2, 3])
@pytest.mark.parametrize(("policy", "reason"), [("latest", "result_replaced"), ("queue", "no_buffer")])
def test_a_slow_host_drops_frames(buffers: int, policy: str, reason: str) -> None:
    output = simulate(host_stage={"all": [2.5]}, buffers=buffers, buffer_policy=policy, frames=60)
    totals = output["totals"]
    assert totals["delivered"] + totals["dropped"] == 60
    assert totals["drops"][reason] == totals["dropped"] > 25
    assert totals["dropped"] == sum(f["dropped"] is not None for f in output["frames"])
    assert rate_hz(output) <= 1000 / 2.5
    order = [f["frame"] for f in sorted(delivered(output), key=lambda f: f["host_start_ns"])]
    assert order == sorted(order)


def test_the_latest_frame_is_fresher_than_a_queued_one() -> None:
    ages = {}
    for policy in ("latest", "queue"):
        output = simulate(host_stage={"all": [2.5]}, buffer_policy=policy, frames=60)
        late = delivered(output)[5:]
        ages[policy] = sum(f["host_end_ns"] - f["capture_start_ns"] for f in late) / len(late)
    assert ages["latest"] < ages["queue"]


def test_triple_buffering_keeps_a_slow_engine_busy_and_double_does_not() -> None:
    """The engine takes 1.5 camera periods: with two buffers it then waits for the frame being captured."""
    keys = {"engine_clock_hz": 4096 / 1.5e-3, "frames": 60, "camera_pixel_clock_hz": 8.2e6,
            "dma_fifo_bytes": 512}  # fmt: skip
    double, triple = simulate(buffers=2, **keys), simulate(buffers=3, **keys)
    assert rate_hz(triple) == pytest.approx(1000 / 1.5, rel=0.02)
    assert rate_hz(double) == pytest.approx(500, rel=0.02)
    assert double["buffers"]["captured"] == {"count": 2, "high_water": 2}
    assert triple["buffers"]["captured"]["count"] == 3


@pytest.mark.parametrize("lanes", [1, 2, 3])
def test_lanes_multiply_the_rate_but_not_the_speed_of_a_frame(lanes: int) -> None:
    output = simulate(lanes=lanes, engine_clock_hz=4096 / 3.3e-3, frames=60)
    assert rate_hz(output) == pytest.approx(min(1000, lanes * 1000 / 3.3), rel=0.04)
    clocks = [f["engine_last_pixel_clock"] - f["engine_start_clock"] + 1 for f in delivered(output)]
    assert set(clocks) == {4096}
    taken = [f for f in output["frames"] if f["lane"] is not None]
    assert sum(lane["frames"] for lane in output["lanes"]) == len(taken)
    assert all(lane["frames"] > 0 for lane in output["lanes"])


def test_rectifying_shares_the_core_or_has_its_own() -> None:
    keys = {"rectify_ms": 0.7, "host_stage": {"all": [0.8]}, "frames": 60}
    shared, own = simulate(host_cores=1, **keys), simulate(host_cores=2, **keys)
    assert rate_hz(own) == pytest.approx(1000, rel=0.01)
    assert rate_hz(shared) < 1000 / 1.5 * 1.03
    for f in delivered(shared):
        assert f["capture_end_ns"] <= f["rectify_start_ns"] < f["rectify_end_ns"] <= f["fetch_start_ns"]


def test_times_of_a_frame_are_in_order() -> None:
    steps = [
        "capture_start_ns", "capture_end_ns", "fetch_start_ns", "engine_start_ns", "engine_first_word_ns",
        "engine_last_word_ns", "result_end_ns", "host_start_ns", "host_end_ns",
    ]  # fmt: skip
    for frame in delivered(simulate(host_stage={"all": [0.3]})):
        times = [frame[step] for step in steps]
        assert times == sorted(times)
