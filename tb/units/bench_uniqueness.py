"""A rival is a cost at or below the bound, more than one candidate away from the winner."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start

D, COST_W = parameter("NumDisparities"), parameter("CostW")
LATENCY = 2


@cocotb.test()
async def rivals_are_found(dut):
    random = seeded(dut)
    await start(dut, cost_i=0, bound_i=0, disparity_i=0)
    winners = [random.randrange(D) for _ in range(801)]
    expected = []
    for clock in range(800):
        if clock > LATENCY:  # the first costs come without a winner before them
            assert bool(dut.rival_o.value) == expected[clock - LATENCY]
        if clock:
            assert int(dut.near_o.value) == sum(1 << d for d in range(D) if abs(d - winners[clock]) <= 1)
        winner = winners[clock]
        bound = random.randrange(1, (1 << COST_W) - 3)
        costs = [bound + 1 + random.randrange(3) for _ in range(D)]
        for _ in range(random.randrange(3)):
            costs[(winner + random.choice([-2, -1, 0, 1, 2, random.randrange(D)])) % D] = (
                bound - random.randrange(2)
            )
        dut.disparity_i.value = winners[clock + 1]  # the winner comes a clock before its costs
        dut.cost_i.value, dut.bound_i.value = pack(costs, COST_W), bound
        expected.append(any(abs(d - winner) > 1 and costs[d] <= bound for d in range(D)))
        await FallingEdge(dut.clk_i)
    assert set(expected) == {True, False}
