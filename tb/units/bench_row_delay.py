"""The word that leaves is the one that entered B rows before, whatever comes between slots."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start
from slots import frame_slots

B, WIDTH = parameter("BlockSize"), parameter("Width")


@cocotb.test()
async def words_leave_after_the_rows_of_a_block(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    await start(dut, slot_i=0, slot_col_i=0, entering_i=0)
    got = []

    async def clock(bits, col, word):
        dut.slot_i.value, dut.slot_col_i.value, dut.entering_i.value = bits, col, word
        await FallingEdge(dut.clk_i)
        if dut.slot_o.value[11]:
            got.append((int(dut.entering_o.value), int(dut.leaving_o.value)))

    for width in (4, 19, 32):
        words = rng.integers(0, 1 << WIDTH, (3 * B, width))
        got.clear()
        for row, col, bits in [*frame_slots(width, 3 * B, 16, B), *[(0, 0, 0)] * 4]:
            while bits and random.random() < 0.2:
                await clock(0, random.randrange(width), random.randrange(1 << WIDTH))
            await clock(bits, col, int(words[row, col]))
        assert [g[0] for g in got] == words.ravel().tolist()
        assert [g[1] for g in got[B * width :]] == words[:-B].ravel().tolist()
