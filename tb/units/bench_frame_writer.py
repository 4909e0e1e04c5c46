"""W * H words a frame, results where they belong, frames in order, at any pace, and what comes of results
that are lost or too many."""

import cocotb
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import parameter, seeded, start

D, B = parameter("NumDisparities"), parameter("BlockSize")
R = B // 2
INVALID = (-16, 0xFFFF)
SIZES = [(64, 9), (4, 2), (D + 2 * R, B), (D + 2 * R - 1, 12), (40, B - 1), (33, 20)]
CLOCKS = 8000


def frame(random, w, h):
    """Its results, and its words with their flags."""
    results, words = [], []
    for y in range(h):
        for x in range(w):
            matched = D - 1 + R <= x <= w - 1 - R and R <= y <= h - 1 - R
            word = (random.randrange(-8, 1000), random.randrange(1 << 16)) if matched else INVALID
            results += [word] if matched else []
            narrow, end = w % 2 == 1, x == w - 1
            words.append((*word, x == y == 0, end, narrow, not narrow or x % 2 == 1 or end))
    return results, words


async def words_of(dut, random, queue, offered=1.0, taken=1.0):
    """What comes of a queue of beginnings, (width, height), and of results: words, ends of frames, how often
    the writer told that these do not fit."""
    await start(dut, queued_valid_i=0, queued_begin_i=0, ready_i=0)
    got, ends, told, place, offering = [], 0, 0, 0, False
    for _ in range(CLOCKS):
        offering = offering or (place < len(queue) and random.random() < offered)
        dut.queued_valid_i.value = offering
        if offering:
            begin, first, second = queue[place]
            dut.queued_begin_i.value = begin
            if begin:
                dut.begin_last_col_i.value, dut.begin_last_row_i.value = first - 1, second - 1
                dut.begin_narrow_i.value = first % 2
            else:
                dut.result_disparity_i.value, dut.result_smin_i.value = first, second
        dut.ready_i.value = random.random() < taken
        await ReadOnly()
        if offering and dut.queued_ready_o.value:
            place, offering = place + 1, False
        if dut.valid_o.value and dut.ready_i.value:
            word = dut.disparity_o.value.to_signed(), int(dut.smin_o.value)
            flags = (dut.sof_o, dut.eol_o, dut.narrow_o, dut.complete_o)
            got.append((*word, *(bool(flag.value) for flag in flags)))
        ends += int(dut.frame_end_o.value)
        told += int(dut.upset_o.value)
        await FallingEdge(dut.clk_i)
    assert place == len(queue)
    return got, ends, told


def queued(size, results):
    return [(True, *size), *((False, *result) for result in results)]


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.4], taken=[1.0, 0.4])
async def frames_are_laid_out(dut, offered, taken):
    random = seeded(dut)
    frames = [frame(random, *size) for size in SIZES]
    queue = [one for size, (results, _) in zip(SIZES, frames, strict=True) for one in queued(size, results)]
    got, ends, told = await words_of(dut, random, queue, offered, taken)
    assert got == [word for _, words in frames for word in words]
    assert (ends, told) == (len(SIZES), 0)


@cocotb.test()
@cocotb.parametrize(change=[-2, -1, 1, 3])
async def results_that_are_lost_or_too_many_end_with_their_frame(dut, change):
    random = seeded(dut)
    size = (40, 12)
    frames = [frame(random, *size) for _ in range(3)]
    broken = frames[1][0]
    broken = broken[:change] if change < 0 else broken + [(1, 1)] * change
    queue = [one for results in (frames[0][0], broken, frames[2][0]) for one in queued(size, results)]
    got, ends, told = await words_of(dut, random, queue, taken=0.7)
    expected = [word for _, words in frames for word in words]
    for word in range(size[0] * size[1], 2 * size[0] * size[1])[::-1]:
        if change < 0 and expected[word][:2] != INVALID:
            expected[word] = (*INVALID, *expected[word][2:])
            change += 1
    assert got == expected
    assert ends == 3 and told > 0
