"""A rival is a cost at or below the bound, more than one candidate away from the winner."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start

D, COST_W = parameter("NumDisparities"), parameter("CostW")


@cocotb.test()
async def rivals_are_found(dut):
    random = seeded(dut)
    await start(dut, cost_i=0, bound_i=0, disparity_i=0)
    winners = [random.randrange(D) for _ in range(801)]
    expected, seen = [], set()
    for clock in range(800):
        if clock >= 2:
            assert bool(dut.rival_o.value) == expected[clock - 2]
        winner = winners[clock]
        bound = random.randrange(1, (1 << COST_W) - 2)
        costs = [bound + 1 + random.randrange(3) for _ in range(D)]
        for _ in range(random.randrange(3)):
            costs[(winner + random.choice([-2, -1, 0, 1, 2, random.randrange(D)])) % D] = (
                bound - random.randrange(2)
            )
        dut.disparity_i.value = winners[clock + 1]
        dut.cost_i.value, dut.bound_i.value = pack(costs, COST_W), bound
        expected.append(clock > 0 and any(abs(d - winner) > 1 and costs[d] <= bound for d in range(D)))
        seen.add(expected[-1])
        if clock == 0:
            expected[-1] = None
        await FallingEdge(dut.clk_i)
        if expected[0] is None and clock == 1:
            expected[0] = bool(dut.rival_o.value)
    assert seen == {True, False}
