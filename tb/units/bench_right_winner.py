"""dR along the diagonals, row after row, with pauses between pixels and the shortest gap between rows."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start

D, COST_W, RING_W = (parameter(name) for name in ("NumDisparities", "CostW", "RingW"))


@cocotb.test()
async def right_winners_are_those_of_the_diagonals(dut):
    random = seeded(dut)
    await start(dut, match_i=0, match_last_i=0, match_cut_i=0, cost_i=0)
    emitted = {}

    async def clock():
        await FallingEdge(dut.clk_i)
        if dut.slot_valid_o.value:
            emitted[len(emitted)] = (
                int(dut.winner_o.value),
                bool(dut.decided_o.value),
                int(dut.slot_index_o.value),
            )

    for width in (1, 2, D - 1, D, 3 * D, 50):
        emitted.clear()
        top = random.choice([3, 1 << COST_W - 1])
        costs = [[random.randrange(top) for _ in range(D)] for _ in range(width)]
        for x in range(width):
            while random.random() < 0.2:
                dut.match_i.value = 0
                await clock()
            dut.match_i.value, dut.match_last_i.value = 1, x == width - 1
            await clock()
            dut.cost_i.value = pack(costs[x], COST_W)
        dut.match_i.value = 0
        for _ in range(D + 3):
            await clock()
        assert len(emitted) == width + D - 1
        for slot, (winner, decided, index) in emitted.items():
            assert decided == (slot >= D - 1)
            assert index == (emitted[0][2] + slot) % (1 << RING_W)
            # Slot s completes the right pixel s - (D-1), counted from the first matched left pixel.
            diagonal = {d: costs[slot - (D - 1) + d][d] for d in range(D) if 0 <= slot - (D - 1) + d < width}
            assert winner == max(d for d, cost in diagonal.items() if cost == min(diagonal.values()))
