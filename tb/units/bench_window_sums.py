"""Running sums of the last B columns, new in every frame."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start, unpack
from slots import frame_slots

N, B = parameter("NumChannels"), parameter("BlockSize")
COLUMN_W, COST_W = (B * 255).bit_length(), (B * B * 255).bit_length()


@cocotb.test()
async def sums_span_the_columns_of_a_block(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    await start(dut, slot_i=0, column_i=0)
    for width, height in ((30, 10), (41, 9)):
        columns = rng.integers(0, B * 255 + 1, (height, width, N))
        got = []
        for row, col, bits in [*frame_slots(width, height, 16, B), *[(0, 0, 0)] * 6]:
            while bits and rng.random() < 0.1:
                dut.slot_i.value = 0
                await FallingEdge(dut.clk_i)
                if dut.slot_o.value[11]:
                    got.append(unpack(dut.sum_o.value, COST_W, N))
            dut.slot_i.value, dut.column_i.value = bits, pack(columns[row, col], COLUMN_W)
            await FallingEdge(dut.clk_i)
            if dut.slot_o.value[11]:
                got.append(unpack(dut.sum_o.value, COST_W, N))
        assert len(got) == width * height
        for y in range(2, height):
            for x in range(B - 1, width):
                assert got[y * width + x] == columns[y, x - B + 1 : x + 1].sum(0).tolist(), f"x {x} y {y}"
