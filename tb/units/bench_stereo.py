"""The top by bus models of others (cocotbext-axi): frames and registers, against the C model."""

import logging

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge
from cocotb_helpers import parameter, seeded
from cocotbext.axi import (
    AxiLiteBus,
    AxiLiteMaster,
    AxiStreamBus,
    AxiStreamFrame,
    AxiStreamSink,
    AxiStreamSource,
)
from frames import expected_words, random_frame, register_values
from registers import CONTROL, ERRORS, FRAMES_OUT, ID, SIZE

D, B, MAX_WIDTH = (parameter(name) for name in ("NumDisparities", "BlockSize", "MaxWidth"))


async def start(dut) -> AxiLiteMaster:
    cocotb.start_soon(Clock(dut.clk_i, 10, "ns").start())
    registers = AxiLiteMaster(
        AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk_i, dut.rst_ni, reset_active_level=False
    )
    dut.rst_ni.value, dut.store_axis_tready.value, dut.fetch_axis_tvalid.value = 0, 0, 0
    await ClockCycles(dut.clk_i, 5)
    dut.rst_ni.value = 1
    await RisingEdge(dut.clk_i)
    return registers


@cocotb.test()
@cocotb.parametrize(pauses=[0.0, 0.4])
async def frames_through_the_buses(dut, pauses):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    logging.getLogger("cocotb.vista_stereo").setLevel(logging.ERROR)
    registers = await start(dut)
    source = AxiStreamSource(
        AxiStreamBus.from_prefix(dut, "s_axis"), dut.clk_i, dut.rst_ni, reset_active_level=False, byte_lanes=1
    )
    sink = AxiStreamSink(
        AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk_i, dut.rst_ni, reset_active_level=False, byte_lanes=1
    )
    if pauses:
        source.set_pause_generator(iter(lambda: rng.random() < pauses, None))
        sink.set_pause_generator(iter(lambda: rng.random() < pauses, None))
    assert await registers.read_dword(ID) == int.from_bytes(b"VSTE", "big")
    await registers.write_dword(CONTROL, 1)
    frames = [random_frame(rng, D, B, MAX_WIDTH) for _ in range(6)]
    for frame in frames:
        height, width = frame.shape
        for address, data in register_values(frame).items():
            await registers.write_dword(address, data)
        pair = frame.left.astype(int) | frame.right.astype(int) << 8
        for y in range(height):
            await source.send(
                AxiStreamFrame(pair[y].tolist(), tuser=[int(x == y == 0) for x in range(width)])
            )
        await source.wait()
        words = []
        for y in range(height):
            line = await sink.recv()
            assert len(line.tdata) == width
            tuser = line.tuser if isinstance(line.tuser, list) else [line.tuser] * width
            assert [int(u) for u in tuser] == [int(x == y == 0) for x in range(width)]
            words += line.tdata
        assert words == expected_words(frame).tolist()
    assert await registers.read_dword(ERRORS) == 0
    assert await registers.read_dword(FRAMES_OUT) == len(frames)


@cocotb.test()
@cocotb.parametrize(pauses=[0.0, 0.5])
async def bytes_of_a_register(dut, pauses):
    """Writes of one to four bytes leave the others as they are, whatever channel waits for another."""
    random = seeded(dut)
    registers = await start(dut)
    if pauses:
        write, read = registers.write_if, registers.read_if
        for channel in (write.aw_channel, write.w_channel, write.b_channel, read.ar_channel, read.r_channel):
            channel.set_pause_generator(iter(lambda: random.random() < pauses, None))
    wanted = bytearray(random.randbytes(4))
    await registers.write(SIZE, wanted)
    for _ in range(100):
        first = random.randrange(4)
        data = random.randbytes(random.randrange(1, 5 - first))
        await registers.write(SIZE + first, data)
        wanted[first : first + len(data)] = data
        assert bytes((await registers.read(SIZE, 4)).data) == bytes(wanted)
