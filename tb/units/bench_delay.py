"""A word comes out the stated number of clocks later."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start

LATENCY = parameter("Latency")


@cocotb.test()
async def words_come_out_after_the_latency(dut):
    random = seeded(dut)
    await start(dut, data_i=0)
    sent = []
    for clock in range(200):
        if clock >= LATENCY:
            assert int(dut.data_o.value) == sent[clock - LATENCY]
        sent.append(random.randrange(256))
        dut.data_i.value = sent[-1]
        await FallingEdge(dut.clk_i)
