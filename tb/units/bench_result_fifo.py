"""A writer that only looks at `go` from as far away as it may loses nothing."""

import cocotb
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import parameter, seeded, start

IN_FLIGHT = parameter("InFlight")
CLOCKS, DRAIN = 3000, 10 * IN_FLIGHT  # the memory holds less than four times IN_FLIGHT


@cocotb.test()
@cocotb.parametrize(taken=[1.0, 0.5, 0.02])
async def nothing_is_lost(dut, taken):
    random = seeded(dut)
    await start(dut, write_i=0, ready_i=0, data_i=0)
    pipeline = [False] * (IN_FLIGHT - 3)  # three clocks pass until `go` has fallen
    sent, got = [], []
    for clock in range(CLOCKS + DRAIN):
        draining = clock >= CLOCKS
        issue = bool(dut.go_o.value) and random.random() < 0.95 and not draining
        pipeline = [issue, *pipeline[:-1]]
        dut.write_i.value = pipeline[-1]
        if pipeline[-1]:
            sent.append(random.randrange(1 << 16))
            dut.data_i.value = sent[-1]
        # Long pauses, so that the memory fills to the brim.
        dut.ready_i.value = draining or (random.random() < taken and clock % 700 > 200)
        await ReadOnly()
        if dut.valid_o.value and dut.ready_i.value:
            got.append(int(dut.data_o.value))
        await FallingEdge(dut.clk_i)
    assert got == sent
    assert len(got) > 20
