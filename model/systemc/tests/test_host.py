"""Host times are drawn from measured ones, by the seed alone."""

from __future__ import annotations

import pytest
from simulation import SMALL, delivered, run, simulate

pytestmark = pytest.mark.native

STAGES = {"first": [0.1, 0.2, 0.3, 0.4], "second": [0.01, 0.02, 0.03, 0.04]}


def test_times_come_from_the_samples_and_from_one_measured_frame() -> None:
    output = simulate(host_stage=STAGES, frames=200)
    for frame in delivered(output):
        times = frame["host_stages_ms"]
        assert list(times) == ["first", "second"]
        assert STAGES["first"].index(times["first"]) == STAGES["second"].index(times["second"])
        took_ms = (frame["host_end_ns"] - frame["host_start_ns"] - frame["host_read_ns"]) / 1e6
        assert took_ms == pytest.approx(times["first"] + times["second"], abs=1e-6)
    drawn = [frame["host_stages_ms"]["first"] for frame in delivered(output)]
    assert all(30 <= drawn.count(ms) <= 70 for ms in STAGES["first"])  # of 200, 50 expected


def test_a_run_is_determined_by_its_configuration() -> None:
    text = "\n".join(f"{key} = {value}" for key, value in SMALL.items())
    text += "\nhost_stage.all_ms = 0.1 0.9 2.5"
    first, again, other = (run(f"{text}\nseed = {seed}").stdout for seed in (7, 7, 8))
    assert first and first == again != other
