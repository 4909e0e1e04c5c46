"""Running sums of the last B columns, new in every row."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start, unpack
from slots import frame_slots

N, B, D = parameter("NumChannels"), parameter("BlockSize"), 16
COLUMN_W, COST_W = (B * 255).bit_length(), (B * B * 255).bit_length()
FIRST = D - 1 + B - 1  # the first column that is matched


async def sums_of(dut, columns, pause, upset=None):
    """The sums of all slots of a frame; upset: row and column whose turn it is when a sum loses its way."""
    height, width, _ = columns.shape
    got = []

    async def clock():
        await FallingEdge(dut.clk_i)
        if dut.slot_o.value[11]:
            got.append(unpack(dut.sum_o.value, COST_W, N))

    for row, col, bits in [*frame_slots(width, height, D, B), *[(0, 0, 0)] * 6]:
        while bits and pause():
            dut.slot_i.value = 0
            await clock()
        dut.slot_i.value, dut.column_i.value = bits, pack(columns[row, col], COLUMN_W)
        await clock()
        if bits and (row, col) == upset:
            for channel in dut.gen_channel:
                channel.delta_q.value = ~int(channel.delta_q.value) & (2 << COLUMN_W) - 1
    assert len(got) == width * height
    return np.array(got).reshape(columns.shape)


def expected(columns):
    """Sums of the columns from FIRST on."""
    blocks = np.lib.stride_tricks.sliding_window_view(columns, B, 1).sum(-1)
    return blocks[:, FIRST - (B - 1) :]


@cocotb.test()
async def sums_span_the_columns_of_a_block(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    await start(dut, slot_i=0, column_i=0)
    for width, height in ((30, 10), (41, 9), (FIRST, 4), (FIRST + 1, 4)):
        columns = rng.integers(0, B * 255 + 1, (height, width, N))
        got = await sums_of(dut, columns, lambda: rng.random() < 0.1)
        assert (got[:, FIRST:] == expected(columns)[:, : max(width - FIRST, 0)]).all()


@cocotb.test()
async def an_upset_is_gone_with_its_row(dut):
    """What is added to the sums in one clock has all of its bits turned over, as by radiation."""
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    await start(dut, slot_i=0, column_i=0)
    columns = rng.integers(0, B * 255 + 1, (8, 40, N))
    for row in range(7):
        upset = (row, int(rng.integers(FIRST + 4, 40)))  # four columns behind that of the sum
        right = await sums_of(dut, columns, lambda: False, upset) == np.pad(
            expected(columns), ((0, 0), (FIRST, 0), (0, 0))
        )
        assert not right[row, FIRST:].all()
        assert right[np.arange(8) != row, FIRST:].all()
