"""Slots, stored pixels and errors of good and bad video at any pace, against common/faults.py."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import parameter, seeded, start
from faults import EARLY_EOL, EARLY_SOF, LATE_EOL, LATE_SOF, SIZE
from frames import PARAMS_BITS, beats
from slots import frame_slots, slot_bits
from verilated import LAST, USER
from video import ERRORS, MIN_HEIGHT, MIN_WIDTH, Segment, broken, illegal_size

D, B, MAX_WIDTH = (parameter(name) for name in ("NumDisparities", "BlockSize", "MaxWidth"))
R = B // 2
CUT = slot_bits(cut=True)


def random_segment(rng, kind):
    """What goes along with a frame are its parameters."""
    width = int(rng.choice([4, D - 1 + 2 * R, D + 2 * R, MAX_WIDTH, rng.integers(4, MAX_WIDTH + 1)]))
    height = int(rng.choice([2, R, R + 1, B, rng.integers(2, 2 * B)]))
    frames = [beats(*rng.integers(0, 256, (2, height, width), np.uint8)) for _ in range(rng.integers(1, 6))]
    if kind == "legal":
        frames = [broken(frame, width, rng) for frame in frames[:-1]] + frames[-1:]
    if kind == "illegal":
        width, height = illegal_size(rng, width, height, MAX_WIDTH)
    params = int(rng.integers(1 << PARAMS_BITS))
    return Segment(width, height, np.concatenate(frames), kind != "disabled", side=params)


def expected_of(segment, frames):
    """Slots (column, bits, begin) and stored pixels (column, params, data, None for filler) of the frames."""
    width, height = segment.width, segment.height
    slots, stores = [], []
    for frame in frames:
        came = len(frame.pixels)
        for row, col, bits in frame_slots(width, height, D, B):
            # A slot goes with the pixel below it; those of the last row with the end of the frame.
            cut = not frame.whole and (row == height - 1 or (row + 1) * width + col >= came)
            begin = (width - 1, height - 1) if (row, col) == (min(R, height - 1), 0) else None
            slots.append((col, bits | CUT if cut else bits, begin))
        data = [*frame.pixels, *[None] * (width * height - came)]
        stores += [(i % width, segment.side, pixel) for i, pixel in enumerate(data)]
    return slots, stores


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], going=[1.0, 0.5])
async def any_video_gives_whole_frames(dut, offered, going):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    kinds = [*["legal"] * 32, *["illegal"] * 4, *["disabled"] * 4]
    random.shuffle(kinds)
    segments = [random_segment(rng, kind) for kind in kinds]
    await start(dut, valid_i=0, go_i=0)
    stream = np.concatenate([s.stream for s in segments]).tolist()
    ends = np.cumsum([len(s.stream) for s in segments])
    slots, stores, errors, starts = [], [], [0] * len(segments), [0] * len(segments)
    position, offering, taken, go, idle = 0, False, None, False, 0
    while idle < 2 * MAX_WIDTH / going:
        current = int(np.searchsorted(ends, position, "right"))
        setting = segments[min(current, len(segments) - 1)]
        legal = MIN_WIDTH <= setting.width <= MAX_WIDTH and setting.height >= MIN_HEIGHT
        dut.enable_i.value, dut.admit_i.value = setting.enable, setting.enable and legal
        dut.last_col_i.value = setting.width - 1 & (1 << len(dut.last_col_i)) - 1
        dut.last_row_i.value = setting.height - 1 & (1 << len(dut.last_row_i)) - 1
        dut.params_i.value = setting.side
        offering = position < len(stream) and (offering or random.random() < offered)
        go = random.random() < going
        beat = stream[position] if offering else random.randrange(1 << 16) | USER | LAST
        dut.valid_i.value, dut.go_i.value, dut.data_i.value = offering, go, beat & 0xFFFF
        dut.sof_i.value, dut.eol_i.value = bool(beat & USER), bool(beat & LAST)
        await ReadOnly()
        taken = beat & 0xFFFF if offering and dut.ready_o.value else None
        await FallingEdge(dut.clk_i)
        if taken is not None:
            position, offering = position + 1, False
        slot = int(dut.slot_o.value)
        slot_valid, store_valid = slot >> 11, int(dut.store_valid_o.value)
        assert go or not (slot_valid or store_valid)
        begin = (int(dut.begin_last_col_o.value), int(dut.begin_last_row_o.value))
        begin = begin if dut.begin_valid_o.value else None
        if slot_valid:
            slots.append((int(dut.slot_col_o.value), slot, begin))
        else:
            assert begin is None
        if store_valid:
            stores.append(
                (int(dut.store_col_o.value), int(dut.params_o.value), taken, int(dut.store_data_o.value))
            )
        segment = min(current, len(segments) - 1)
        for name, bit in ERRORS.items():
            errors[segment] |= bit if getattr(dut, name).value else 0
        starts[segment] += int(dut.frame_start_o.value)
        idle = 0 if position < len(stream) or slot_valid or store_valid else idle + 1

    assert position == len(stream), "the input hung"
    lost, expected_slots, expected_stores, reached = True, [], [], 0
    for i, segment in enumerate(segments):
        outcome = segment.reaction(MAX_WIDTH, lost)
        lost, reached = outcome.lost, reached | outcome.errors
        assert (errors[i], starts[i]) == (outcome.errors, len(outcome.frames)), f"segment {i}"
        more_slots, more_stores = expected_of(segment, outcome.frames)
        expected_slots += more_slots
        expected_stores += more_stores
    assert slots == expected_slots
    assert [s[:2] for s in stores] == [s[:2] for s in expected_stores]
    for (*_, beat, data), (*_, pixel) in zip(stores, expected_stores, strict=True):
        assert pixel is None or beat == data == pixel
    assert reached == EARLY_EOL | LATE_EOL | EARLY_SOF | LATE_SOF | SIZE
