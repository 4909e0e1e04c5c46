"""T = Smin + floor(Smin * u / 100), saturated."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start

COST_W = parameter("CostW")
TOP = (1 << COST_W) - 1
LATENCY, RATIO_LEAD = 4, 17


@cocotb.test()
async def bound_is_exact(dut):
    random = seeded(dut)
    await start(dut, ratio_i=0, smin_i=0)
    for ratio in range(101):
        dut.ratio_i.value = ratio
        for _ in range(RATIO_LEAD):
            await FallingEdge(dut.clk_i)
        expected = []
        for clock in range(60):
            if clock >= LATENCY:
                assert int(dut.bound_o.value) == expected[clock - LATENCY], f"u {ratio}"
            smin = random.choice(
                [
                    0,
                    TOP - 1,
                    100 * random.randrange(1300),
                    random.randrange(TOP),
                    max(0, 100 * random.randrange(1300) - 1),
                ]
            )
            dut.smin_i.value = smin
            expected.append(min(smin + smin * ratio // 100, TOP))
            await FallingEdge(dut.clk_i)
