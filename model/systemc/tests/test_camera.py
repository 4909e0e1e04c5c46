"""Line timing: what the camera sends when, and that nobody makes it wait."""

from __future__ import annotations

import pytest
from simulation import SMALL, delivered, simulate

pytestmark = pytest.mark.native


def test_frames_come_at_the_rate() -> None:
    starts = [frame["capture_start_ns"] for frame in simulate()["frames"]]
    assert starts == [pytest.approx(n * 1e6, abs=1e-3) for n in range(20)]


@pytest.mark.parametrize(("horizontal", "vertical"), [(0, 0), (72, 8), (300, 1)])
def test_without_a_rate_frames_follow_at_once(horizontal: int, vertical: int) -> None:
    output = simulate(
        camera_rate_hz=0,
        camera_horizontal_blanking_px=horizontal,
        camera_vertical_blanking_lines=vertical,
        frames=4,
    )
    lines_ns = (128 + horizontal) * 100.0
    assert output["camera"]["line_ns"] == pytest.approx(lines_ns)
    assert output["camera"]["period_ns"] == pytest.approx(lines_ns * (32 + vertical))
    assert output["camera"]["readout_ns"] == pytest.approx(lines_ns * 31 + 128 * 100)
    starts = [frame["capture_start_ns"] for frame in output["frames"]]
    assert starts == [pytest.approx(n * lines_ns * (32 + vertical), abs=1e-3) for n in range(4)]


def test_capture_ends_with_the_last_burst_behind_the_last_pixel() -> None:
    output = simulate(memory_latency_ns=50, burst_bytes=64)
    last_pair_ns = 2 * 64 / SMALL["memory_bandwidth_bytes_s"] * 1e9 + 50
    for frame in delivered(output):
        took = frame["capture_end_ns"] - frame["capture_start_ns"]
        assert took >= output["camera"]["readout_ns"] + last_pair_ns - 1e-3
        assert took <= output["camera"]["readout_ns"] + 3 * last_pair_ns  # others' bursts are under way


def test_slow_memory_does_not_delay_the_camera() -> None:
    output = simulate(memory_bandwidth_bytes_s=4e6)
    assert [f["capture_start_ns"] for f in output["frames"]] == [
        pytest.approx(n * 1e6, abs=1e-3) for n in range(20)
    ]
    assert output["totals"]["drops"]["overflow"] > 0
