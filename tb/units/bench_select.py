"""Every word can be picked, two clocks later."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start

NUM_WORDS, WIDTH = parameter("NumWords"), parameter("Width")


@cocotb.test()
async def picks_the_word_of_the_index(dut):
    random = seeded(dut)
    await start(dut, index_i=0, word_i=0)
    expected = []
    for clock in range(300):
        if clock >= 2:
            assert int(dut.word_o.value) == expected[clock - 2]
        words = [random.randrange(1 << WIDTH) for _ in range(NUM_WORDS)]
        index = clock % NUM_WORDS
        dut.word_i.value, dut.index_i.value = pack(words, WIDTH), index
        expected.append(words[index])
        await FallingEdge(dut.clk_i)
