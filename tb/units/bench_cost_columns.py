"""Column sums of every disparity and of the texture, over two frames with pauses between slots."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start, unpack
from slots import frame_slots

D, B = parameter("NumDisparities"), parameter("BlockSize")
COLUMN_W = (B * 255).bit_length()


@cocotb.test()
async def columns_hold_the_sums_of_the_last_rows(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    sides = ("left", "right", "texture")
    await start(
        dut, slot_i=0, slot_col_i=0, **{f"{s}_{e}_i": 0 for s in sides for e in ("entering", "leaving")}
    )
    got = []

    async def clock(bits, col, entering, leaving):
        dut.slot_i.value, dut.slot_col_i.value = bits, col
        for side in sides:
            getattr(dut, f"{side}_entering_i").value = entering[side]
            getattr(dut, f"{side}_leaving_i").value = leaving[side]
        await FallingEdge(dut.clk_i)
        if dut.slot_o.value[11]:
            got.append(unpack(dut.column_o.value, COLUMN_W, D + 1))

    def anything():
        return {side: random.randrange(64) for side in sides}

    for width, height in ((20, 9), (32, 13)):
        left, right = rng.choice([0, 255, 7, 200], (2, height, width))
        texture = rng.integers(0, 64, (height, width))
        planes = dict(zip(sides, (left, right, texture), strict=True))
        got.clear()
        for row, col, bits in [*frame_slots(width, height, D, B), *[(0, 0, 0)] * 8]:
            while bits and random.random() < 0.2:
                await clock(0, random.randrange(width), anything(), anything())
            entering = {side: int(plane[row, col]) for side, plane in planes.items()}
            leaving = {side: int(plane[row - B, col]) for side, plane in planes.items()}
            await clock(bits, col, entering, leaving if row >= B else anything())
        for i, sums in enumerate(got):
            y, x = divmod(i, width)
            rows = slice(max(0, y - B + 1), y + 1)
            for d in range(min(D, x + 1)):
                assert sums[d] == np.abs(left[rows, x] - right[rows, x - d]).sum(), f"x {x} y {y} d {d}"
            assert sums[D] == texture[rows, x].sum()
        assert len(got) == width * height
