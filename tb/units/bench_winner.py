"""Smallest cost, ties to the larger disparity."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start

D, COST_W = parameter("NumDisparities"), parameter("CostW")


@cocotb.test()
async def smallest_cost_wins_and_ties_go_up(dut):
    random = seeded(dut)
    await start(dut, cost_i=0)
    latency = (D - 1).bit_length()
    expected = []
    for clock in range(600):
        if clock >= latency:
            assert (int(dut.smin_o.value), int(dut.disparity_o.value)) == expected[clock - latency]
        limit = random.choice([1, 2, 4, (1 << COST_W) - 1])  # small ranges give ties
        costs = [random.randrange(limit) for _ in range(D)]
        dut.cost_i.value = pack(costs, COST_W)
        expected.append((min(costs), max(d for d in range(D) if costs[d] == min(costs))))
        await FallingEdge(dut.clk_i)
