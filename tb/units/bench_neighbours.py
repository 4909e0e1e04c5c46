"""The costs beside every winner, two clocks after the costs; at the ends of the range the inner one twice."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start

D, COST_W = parameter("NumDisparities"), parameter("CostW")
LATENCY = 2


@cocotb.test()
async def neighbours_of_the_winner(dut):
    random = seeded(dut)
    await start(dut, disparity_i=0, cost_i=0)
    winners = [*range(D), *(random.randrange(D) for _ in range(200))]
    costs = [[random.randrange(1 << COST_W) for _ in range(D)] for _ in winners]
    for clock in range(len(winners) + LATENCY + 1):
        if clock > LATENCY:
            winner, cost = winners[clock - LATENCY - 1], costs[clock - LATENCY - 1]
            expected = (cost[winner - 1 if winner else 1], cost[winner + 1 if winner < D - 1 else D - 2])
            assert (int(dut.previous_o.value), int(dut.next_o.value)) == expected, f"winner {winner}"
        # The winner comes a clock before its costs.
        dut.disparity_i.value = winners[min(clock, len(winners) - 1)]
        if clock:
            dut.cost_i.value = pack(costs[min(clock, len(winners)) - 1], COST_W)
        await FallingEdge(dut.clk_i)
