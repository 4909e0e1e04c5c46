"""The front end in hardware, and a board behind a link."""

from __future__ import annotations

import pytest
from simulation import delivered, simulate

pytestmark = [pytest.mark.native, pytest.mark.slow]

W, H = 160, 120
SIDE = {"width_px": W, "height_px": H, "max_width_px": 160, "camera_rate_hz": 0, "camera_pixel_clock_hz": 1e6,
        "camera_horizontal_blanking_px": 0, "camera_vertical_blanking_lines": 0,
        "compute_words": "off", "result_bytes_px": 2, "frames": 6}  # fmt: skip
FAST_MEMORY = {"memory_bandwidth_bytes_s": 1e12, "memory_latency_ns": 0}
CLOCK_HZ = 10e6


def clocks(**keys: object) -> list[float]:
    """Clocks from the first burst that is fetched to the last word in memory, of each frame."""
    output = simulate(**SIDE, engine_clock_hz=CLOCK_HZ, **keys)
    return [(f["result_end_ns"] - f["fetch_start_ns"]) * CLOCK_HZ / 1e9 for f in delivered(output)]


@pytest.mark.parametrize("rows", [16, 32, 64, 128])
def test_rectification_delays_a_frame_by_half_its_line_buffer(rows: int) -> None:
    """And by its own pixels and those of smoothing, which do not depend on it."""
    plain, delayed = clocks(**FAST_MEMORY)[1], clocks(**FAST_MEMORY, rectify_rows=rows)[1]
    more = delayed - plain - min(rows // 2, H) * W
    assert W < more < W + 60


def test_levels_take_their_pixels_more() -> None:
    one, two, three = (clocks(**FAST_MEMORY, rectify_rows=16, levels=n)[1] for n in (1, 2, 3))
    pixels = (W // 2) * (H // 2)
    # The last rows of a smaller level are shorter, and before it there are 16 clocks.
    assert abs(two - one - pixels) < 8 * W
    assert abs(three - two - pixels / 4) < 4 * W


def test_the_buffer_of_the_pyramid_is_stored_and_fetched_once() -> None:
    output = simulate(**SIDE, engine_clock_hz=CLOCK_HZ, rectify_rows=16, levels=3, **FAST_MEMORY)
    traffic = {master["name"]: master["bytes"] for master in output["memory"]["masters"]}
    levels = (W // 2) * (H // 2) + (W // 4) * (H // 4)
    assert traffic["store"] == traffic["levels"] == 4 * levels * len(delivered(output))
    assert traffic["result0"] == 2 * (W * H + levels) * len(delivered(output))


def test_slow_memory_slows_levels_and_not_the_single_level() -> None:
    """Just enough for pixels and words, which are 4 bytes a clock; the pyramid wants more."""
    memory = {"memory_bandwidth_bytes_s": 4.4 * CLOCK_HZ, "burst_bytes": 64, "dma_fifo_bytes": 256}
    free, tight = (clocks(rectify_rows=16, **m)[1] for m in (FAST_MEMORY, memory))
    assert tight < 1.02 * free
    free, tight = (clocks(rectify_rows=16, levels=3, **m)[1] for m in (FAST_MEMORY, memory))
    assert tight > 1.1 * free


BOARD = SIDE | {"engine_clock_hz": 60e6, "memory_clock_hz": 240e6, "camera_pixel_clock_hz": 20e6,
                "rectify_rows": 16, "frames": 200}  # fmt: skip
FEW = 40  # frames, where nearly all are delivered


def rate_hz(**keys: object) -> float:
    ends = [frame["host_end_ns"] for frame in delivered(simulate(**BOARD | keys))][2:-2]
    return 1e9 * (len(ends) - 1) / (ends[-1] - ends[0])


@pytest.mark.same_c
def test_a_slow_link_sets_the_rate() -> None:
    """A frame crosses it twice, 1024 bytes in a packet of 1110, and the client does one thing at a time."""
    link_bytes_s = 5e6
    packets = 2 * -(-2 * W * H // 1024)
    assert rate_hz(link_bytes_s=link_bytes_s) == pytest.approx(link_bytes_s / (packets * 1110), rel=0.05)
    assert rate_hz(link_bytes_s=1e9, frames=FEW) > 5 * link_bytes_s / (packets * 1110)


@pytest.mark.same_c
def test_a_slow_engine_sets_the_rate() -> None:
    """It works at one frame at a time: its latency counts."""
    frame = (H + 8 + 1) * W
    assert rate_hz(link_bytes_s=1e9, engine_clock_hz=3e6, frames=80) == pytest.approx(3e6 / frame, rel=0.05)


@pytest.mark.same_c
def test_credits_make_a_round_trip_cost() -> None:
    quick = {"link_bytes_s": 125e6, "frames": FEW}
    assert rate_hz(**quick, link_round_trip_ns=500e3) < 0.5 * rate_hz(**quick)


def test_every_frame_is_delivered_or_dropped_with_a_reason() -> None:
    output = simulate(**BOARD | {"link_bytes_s": 5e6})
    totals = output["totals"]
    assert totals["dropped"] == sum(totals["drops"].values()) > 0
    assert len(delivered(output)) == totals["delivered"] > 0


def test_every_word_goes_through_the_memory_of_a_board_as_often_as_it_must() -> None:
    """Two pixels to a word, and two narrow disparities; rows of an odd width end with a whole word. Seven
    pixels of a smaller level lie in four words."""
    odd = BOARD | {"width_px": 150, "levels": 2, "link_bytes_s": 125e6, "frames": 20}
    output = simulate(**odd)
    frames, pixels = len(delivered(output)), 150 * H
    traffic = {master["name"]: master["bytes"] / 4 for master in output["memory"]["masters"]}
    chunks = -(-pixels // 512)
    words = 75 * H + 38 * (H // 2)
    assert traffic["store"] == traffic["levels"] == frames * 4 * -(-75 // 7) * (H // 2)
    assert traffic["from_host"] == traffic["fetch0"] == frames * chunks * 256
    assert traffic["result0"] == frames * words
    assert traffic["to_host"] == frames * -(-words // 256) * 256


@pytest.mark.same_c
def test_a_slow_memory_slows_a_board() -> None:
    board = {"link_bytes_s": 1e9, "levels": 3, "engine_clock_hz": 45e6, "frames": FEW}
    assert rate_hz(**board, memory_clock_hz=30e6) < 0.9 * rate_hz(**board, memory_clock_hz=120e6)


@pytest.mark.parametrize("result_bytes", [2, 4])
def test_a_board_changes_no_word(result_bytes: int) -> None:
    """Compares a build without front end, the words of which are known."""
    plain = BOARD | {"rectify_rows": 0, "compute_words": "on", "result_bytes_px": result_bytes, "frames": 12}
    alone = plain | {"memory_clock_hz": 0, "camera_pixel_clock_hz": 1e6}
    crc = {f["frame"]: f["words_crc32"] for f in delivered(simulate(**alone))}
    found = delivered(simulate(**plain, link_bytes_s=125e6))
    assert len(found) > 2 and len(crc) == 12
    assert all(f["words_crc32"] == crc[f["frame"]] for f in found)
