"""The engine in the system: words of the C model, pace and latency of the RTL."""

from __future__ import annotations

import re
import zlib
from pathlib import Path

import numpy as np
import pytest
from simulation import ROOT, delivered, simulate
from vista_model.c_engine import CEngine
from vista_model.engine import Parameters

pytestmark = pytest.mark.native


def pipeline_clocks() -> dict[int, int]:
    """Clocks by number of disparities, of the table in doc/rtl.md."""
    text = (ROOT / "doc" / "rtl.md").read_text()
    row = re.search(r"\*\*in all\*\*, D = ([\d, ]+) \| \*\*([\d, ]+)\*\*", text)
    assert row
    disparities, clocks = (map(int, numbers.split(",")) for numbers in row.groups())
    return dict(zip(disparities, clocks, strict=True))


PIPELINE = pipeline_clocks()


@pytest.mark.parametrize("disparities", PIPELINE)
def test_unstalled_pace_and_latency_are_those_of_the_rtl(disparities: int) -> None:
    output = simulate(disparities=disparities, block_px=11, engine_clock_hz=50e6)
    assert output["engine"]["clocks_per_frame"] == 128 * 32
    assert output["engine"]["pipeline_clocks"] == PIPELINE[disparities]
    for frame in delivered(output):
        first = frame["engine_first_word_clock"] - frame["engine_start_clock"]
        assert first == output["engine"]["first_word_clocks"]
        assert frame["engine_last_pixel_clock"] - frame["engine_start_clock"] == 128 * 32 - 1
        drain = 6 * 128 + 5 + PIPELINE[disparities]  # r + 1 rows and r columns of block 11
        assert frame["engine_last_word_clock"] - frame["engine_last_pixel_clock"] == drain
        assert frame["stalls_in"] == frame["stalls_out"] == frame["starved"] == 0


@pytest.mark.parametrize("result_bytes", [4, 2])
@pytest.mark.parametrize("lr_max_diff", [None, 1])
def test_words_at_the_host_are_those_of_the_c_model(
    tmp_path: Path, result_bytes: int, lr_max_diff: int | None
) -> None:
    rng = np.random.default_rng(3)
    left = rng.integers(0, 256, (3, 32, 128), np.uint8)
    right = np.roll(left, -4, 2)
    (tmp_path / "left").write_bytes(left.tobytes())
    (tmp_path / "right").write_bytes(right.tobytes())
    output = simulate(
        left_images=tmp_path / "left", right_images=tmp_path / "right", words_out=tmp_path / "words",
        result_bytes_px=result_bytes, frames=5, lr_max_diff_px="off" if lr_max_diff is None else lr_max_diff,
    )  # fmt: skip
    engine = CEngine(Parameters(16, 5, lr_max_diff=lr_max_diff))
    expected = []
    for n in range(5):
        disparity, smin = engine.compute(left[n % 3], right[n % 3])
        words = disparity.view(np.uint16) | np.minimum(smin, 0xFFFF) << 16
        expected.append((words.astype("<u4") if result_bytes == 4 else disparity.astype("<i2")).tobytes())
    assert (tmp_path / "words").read_bytes() == b"".join(expected)
    assert [f["words_crc32"] for f in output["frames"]] == [f"{zlib.crc32(words):08x}" for words in expected]


def test_starved_clocks_are_those_without_a_pixel() -> None:
    output = simulate(memory_bandwidth_bytes_s=60e6, engine_clock_hz=50e6)
    assert output["totals"]["starved"] > 0
    for frame in delivered(output):
        passed = frame["engine_last_pixel_clock"] - frame["engine_start_clock"] + 1
        assert passed == 4096 + frame["starved"] + frame["stalls_in"]


def test_a_frame_too_small_to_be_matched_passes() -> None:
    output = simulate(width_px=16, height_px=4, camera_rate_hz=1000)
    assert output["totals"]["delivered"] == 20 and output["engine"]["pipeline_clocks"] is None
