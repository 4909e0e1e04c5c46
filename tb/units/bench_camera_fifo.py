"""Pixels cross from any clock to any other in order; those that are lost are told of, and none else is."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer
from cocotb_helpers import parameter, seeded

WIDTH, DEPTH = parameter("Width"), parameter("Depth")
WRITE_PS = 10_000
LATENCY = 4  # clocks of the reader, at most
RATIOS = [0.13, 0.31, 0.77, 0.999, 1.0, 1.001, 1.37, 3.3, 7.1]  # of the periods, reader to writer


async def start(dut, read_ps, phase_ps):
    dut.valid_i.value, dut.ready_i.value, dut.data_i.value = 0, 0, 0
    dut.pixel_rst_ni.value = dut.rst_ni.value = 0
    await Timer(1, "ns")
    cocotb.start_soon(Clock(dut.pixel_clk_i, WRITE_PS, "ps").start())
    await Timer(phase_ps + 1, "ps")
    cocotb.start_soon(Clock(dut.clk_i, read_ps, "ps").start())
    for _ in range(4):
        await FallingEdge(dut.pixel_clk_i)
        await FallingEdge(dut.clk_i)
    await FallingEdge(dut.pixel_clk_i)
    dut.pixel_rst_ni.value = 1
    await FallingEdge(dut.clk_i)
    dut.rst_ni.value = 1
    for _ in range(LATENCY):
        await FallingEdge(dut.clk_i)


async def write(dut, random, count, offered, sent, lost):
    """Each pixel once, whether there is room or not; `lost_o` tells of it a clock later."""
    before = None
    for _ in range(count):
        await FallingEdge(dut.pixel_clk_i)
        if before is not None:
            (lost if dut.lost_o.value else sent).append(before)
        else:
            assert not dut.lost_o.value
        before = random.randrange(1 << WIDTH) if random.random() < offered else None
        dut.valid_i.value, dut.data_i.value = before is not None, before or 0
    await FallingEdge(dut.pixel_clk_i)
    if before is not None:
        (lost if dut.lost_o.value else sent).append(before)
    dut.valid_i.value = 0


async def read(dut, random, taken, got):
    waiting = None
    while True:
        await FallingEdge(dut.clk_i)
        dut.ready_i.value = ready = random.random() < taken
        assert waiting is None or (dut.valid_o.value and int(dut.data_o.value) == waiting)
        waiting = int(dut.data_o.value) if dut.valid_o.value else None
        if waiting is not None and ready:
            got.append(waiting)
            waiting = None


@cocotb.test()
@cocotb.parametrize(ratio=RATIOS, offered=[1.0, 0.4], taken=[1.0, 0.5])
async def pixels_cross_in_order(dut, ratio, offered, taken):
    random = seeded(dut)
    read_ps = 2 * round(WRITE_PS * ratio / 2)
    await start(dut, read_ps, random.randrange(read_ps))
    sent, lost, got = [], [], []
    reader = cocotb.start_soon(read(dut, random, taken, got))
    await write(dut, random, 600, offered, sent, lost)
    for _ in range(int((DEPTH + LATENCY) * 20 / taken)):
        await RisingEdge(dut.clk_i)
    reader.cancel()
    assert got == sent
    if taken / ratio > 1.001 * offered and taken == 1.0:
        assert not lost, "a reader that is faster loses nothing"
    if 0.8 * offered > taken / ratio:
        assert lost, "there is no room for so many"
    assert len(sent) >= min(DEPTH, len(sent) + len(lost))
