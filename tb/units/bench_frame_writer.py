"""W * H words a frame, results where they belong, frames in order, at any pace."""

import cocotb
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import parameter, seeded, start

D, B = parameter("NumDisparities"), parameter("BlockSize")
R = B // 2


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.4])
async def frames_are_laid_out(dut, offered, taken):
    random = seeded(dut)
    await start(dut, begin_valid_i=0, begin_narrow_i=0, result_valid_i=0, ready_i=0)
    sizes = [(64, 9), (4, 2), (D + 2 * R, B), (D + 2 * R - 1, 12), (40, B - 1), (33, 20)]
    expected, results = [], []
    for w, h in sizes:
        for y in range(h):
            for x in range(w):
                matched = D - 1 + R <= x <= w - 1 - R and R <= y <= h - 1 - R
                word = (random.randrange(-8, 1000), random.randrange(1 << 16)) if matched else (-16, 0xFFFF)
                results += [word] if matched else []
                narrow, end = w % 2 == 1, x == w - 1
                expected.append((*word, x == y == 0, end, narrow, not narrow or x % 2 == 1 or end))
    got, ends, begun, result, offering = [], 0, 0, 0, False
    went, since = (
        [False] * 3,
        4,
    )  # a frame is announced on what `go` was two clocks ago, four clocks after another
    for _ in range(12000):
        went, since = [*went[1:], bool(dut.go_o.value)], since + 1
        begin = begun < len(sizes) and went[0] and since > 4 and random.random() < 0.05
        since = 0 if begin else since
        dut.begin_valid_i.value = begin
        if begin:
            dut.begin_last_col_i.value, dut.begin_last_row_i.value = sizes[begun][0] - 1, sizes[begun][1] - 1
            dut.begin_narrow_i.value = sizes[begun][0] % 2
            begun += 1
        offering = offering or (result < len(results) and random.random() < offered)
        dut.result_valid_i.value = offering
        if offering:
            dut.result_disparity_i.value, dut.result_smin_i.value = results[result]
        dut.ready_i.value = random.random() < taken
        await ReadOnly()
        if offering and dut.result_ready_o.value:
            result, offering = result + 1, False
        if dut.valid_o.value and dut.ready_i.value:
            word = dut.disparity_o.value.to_signed(), int(dut.smin_o.value)
            flags = (dut.sof_o, dut.eol_o, dut.narrow_o, dut.complete_o)
            got.append((*word, *(bool(flag.value) for flag in flags)))
        ends += int(dut.frame_end_o.value)
        await FallingEdge(dut.clk_i)
    assert got == expected
    assert (result, ends) == (len(results), len(sizes))
