"""Rows of any width in either format, at any pace."""

import cocotb
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import seeded, start


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.4])
async def pixels_are_packed(dut, offered, taken):
    random = seeded(dut)
    signals = ("valid", "ready", "sof", "eol", "narrow", "complete", "disparity", "smin")
    await start(dut, **{f"{name}_i": 0 for name in signals})
    pixels, expected = [], []
    for width, height, narrow in ((4, 2, 1), (5, 3, 1), (5, 2, 0), (1, 2, 1), (9, 4, 1), (8, 1, 0)):
        for y in range(height):
            row = [(random.randrange(-8, 4096), random.randrange(1 << 16)) for _ in range(width)]
            for x, (disparity, smin) in enumerate(row):
                eol = x == width - 1
                pixels.append((disparity, smin, x == y == 0, eol, narrow, not narrow or x % 2 or eol))
                if not narrow:
                    expected.append((smin << 16 | disparity & 0xFFFF, x == y == 0, eol))
            for x in range(0, width * narrow, 2):
                upper = row[x + 1][0] if x + 1 < width else -16
                word = (upper & 0xFFFF) << 16 | row[x][0] & 0xFFFF
                expected.append((word, x == y == 0, x + 2 >= width))
    got, at, offering = [], 0, False
    for _ in range(800):
        offering = offering or (at < len(pixels) and random.random() < offered)
        dut.valid_i.value = offering
        if offering:
            disparity, smin, sof, eol, narrow, complete = pixels[at]
            dut.disparity_i.value, dut.smin_i.value = disparity, smin
            dut.sof_i.value, dut.eol_i.value, dut.narrow_i.value = sof, eol, narrow
            dut.complete_i.value = complete
        dut.ready_i.value = random.random() < taken
        await ReadOnly()
        if offering and dut.ready_o.value:
            at, offering = at + 1, False
        if dut.valid_o.value and dut.ready_i.value:
            got.append((int(dut.word_o.value), bool(dut.sof_o.value), bool(dut.eol_o.value)))
        await FallingEdge(dut.clk_i)
    assert got == expected
