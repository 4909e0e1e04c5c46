"""The formula of the contract's step 7, as it is written there."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start

COST_W, INDEX_W = parameter("CostW"), parameter("IndexW")
LATENCY = 11


def contract(winner, smin, p, n):
    q = p + n - 2 * smin + abs(p - n)
    fraction = 0 if q == 0 else int(256 * abs(p - n) // q) * (1 if p >= n else -1)
    return (256 * winner + fraction + 15) >> 4


@cocotb.test()
async def fraction_is_the_contracts(dut):
    random = seeded(dut)
    await start(dut, winner_i=0, smin_i=0, previous_i=0, next_i=0)
    expected, top = [], (1 << COST_W) - 2
    for clock in range(4000):
        if clock >= LATENCY:
            assert dut.disparity_o.value.to_signed() == expected[clock - LATENCY]
        smin = random.choice([0, random.randrange(top), random.randrange(200)])
        spread = random.choice([0, 1, 3, 200, top])
        p, n = (min(top, smin + random.randrange(spread + 1)) for _ in range(2))
        winner = random.choice([0, (1 << INDEX_W) - 1, random.randrange(1 << INDEX_W)])
        dut.winner_i.value, dut.smin_i.value, dut.previous_i.value, dut.next_i.value = winner, smin, p, n
        expected.append(contract(winner, smin, p, n))
        await FallingEdge(dut.clk_i)
