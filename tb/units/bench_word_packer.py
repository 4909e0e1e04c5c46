"""Rows of any width in either format, at any pace."""

import cocotb
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import seeded, start


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.4])
async def pixels_are_packed(dut, offered, taken):
    random = seeded(dut)
    await start(dut, valid_i=0, ready_i=0, sof_i=0, eol_i=0, narrow_i=0, disparity_i=0, smin_i=0)
    pixels, expected = [], []
    for width, height, narrow in ((4, 2, 1), (5, 3, 1), (5, 2, 0), (1, 2, 1), (9, 4, 1), (8, 1, 0)):
        for y in range(height):
            row = [(random.randrange(-8, 4096), random.randrange(1 << 16)) for _ in range(width)]
            for x, (disparity, smin) in enumerate(row):
                pixels.append((disparity, smin, x == y == 0, x == width - 1, narrow))
                if not narrow:
                    expected.append((smin << 16 | disparity & 0xFFFF, x == y == 0, x == width - 1))
            for x in range(0, width * narrow, 2):
                upper = row[x + 1][0] if x + 1 < width else -16
                word = (upper & 0xFFFF) << 16 | row[x][0] & 0xFFFF
                expected.append((word, x == y == 0, x + 2 >= width))
    got, at, offering = [], 0, False
    for _ in range(800):
        offering = offering or (at < len(pixels) and random.random() < offered)
        dut.valid_i.value = offering
        if offering:
            disparity, smin, sof, eol, narrow = pixels[at]
            dut.disparity_i.value, dut.smin_i.value = disparity, smin
            dut.sof_i.value, dut.eol_i.value, dut.narrow_i.value = sof, eol, narrow
        dut.ready_i.value = random.random() < taken
        await ReadOnly()
        if offering and dut.ready_o.value:
            at, offering = at + 1, False
        if dut.valid_o.value and dut.ready_i.value:
            got.append((int(dut.word_o.value), bool(dut.sof_o.value), bool(dut.eol_o.value)))
        await FallingEdge(dut.clk_i)
    assert got == expected
