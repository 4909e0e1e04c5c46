"""x-Sobel, plain values and texture against the numpy model, frame upon frame."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge
from cocotb_helpers import seeded, start
from frames import params_bits
from slots import frame_slots
from vista_model.engine import Parameters, xsobel


@cocotb.test()
async def rows_and_columns_of_every_border(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    await start(dut, slot_i=0, slot_col_i=0, params_i=0, store_valid_i=0, store_col_i=0, store_data_i=0)
    got = []

    async def clock():
        await FallingEdge(dut.clk_i)
        if dut.slot_o.value[11]:
            got.append(
                (
                    int(dut.left_o.value),
                    int(dut.right_o.value),
                    int(dut.texture_o.value),
                    int(dut.slot_col_o.value),
                )
            )

    for width, height in ((4, 2), (9, 3), (32, 4), (17, 5), (12, 2)):
        sobel, cap = rng.integers(2), int(rng.choice([1, 31, 63]))
        bits = params_bits(Parameters(prefilter="xsobel" if sobel else "none", prefilter_cap=cap))
        left, right = rng.integers(0, 256, (2, height, width), np.uint8)
        slots = {(row, col): bits for row, col, bits in frame_slots(width, height, 16, 5)}
        got.clear()
        for row in range(height + 1):  # the frame being stored is one row ahead
            for col in range(width):
                while rng.random() < 0.15:
                    dut.slot_i.value, dut.store_valid_i.value = 0, 0
                    await clock()
                dut.params_i.value = bits
                dut.slot_i.value = slots.get((row - 1, col), 0)
                dut.slot_col_i.value = dut.store_col_i.value = col
                dut.store_valid_i.value = row < height
                if row < height:
                    dut.store_data_i.value = int(left[row, col]) | int(right[row, col]) << 8
                await clock()
        dut.slot_i.value, dut.store_valid_i.value = 0, 0
        for _ in range(10):
            await clock()
        assert len(got) == width * height
        filtered = xsobel(left, cap), xsobel(right, cap)
        texture = np.abs(filtered[0].astype(int) - cap)
        expected = [filtered[0], filtered[1]] if sobel else [left, right]
        for i, plane in enumerate([*expected, texture, np.tile(np.arange(width), (height, 1))]):
            assert [g[i] for g in got] == plane.ravel().tolist(), f"plane {i} of {width}x{height}"
