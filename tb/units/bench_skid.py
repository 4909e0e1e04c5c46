"""Words pass in order, one a clock when nobody stalls, and hold still while they wait."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import seeded, start


@cocotb.test()
@cocotb.parametrize(offered=[1.0, 0.5, 0.1], taken=[1.0, 0.5, 0.1])
async def words_pass_in_order(dut, offered, taken):
    random = seeded(dut)
    await start(dut, valid_i=0, ready_i=0, data_i=0)
    sent, got, pending, waiting = [], [], False, None
    for _ in range(600):
        if not pending and random.random() < offered:
            dut.data_i.value = random.randrange(256)
            pending = True
        dut.valid_i.value = pending
        ready = random.random() < taken
        dut.ready_i.value = ready
        await cocotb.triggers.ReadOnly()
        if dut.valid_o.value:
            data = int(dut.data_o.value)
            assert waiting in (None, data), "a waiting word changed"
            waiting = None if ready else data
            if ready:
                got.append(data)
        else:
            assert waiting is None, "a waiting word vanished"
        if pending and dut.ready_o.value:
            sent.append(int(dut.data_i.value))
            pending = False
        await FallingEdge(dut.clk_i)
    assert got == sent[: len(got)] and len(sent) - len(got) <= 2
    if offered == taken == 1.0:
        assert len(got) >= 598
