"""The engine with parity: a bit that is upset in any of its memories is told of, and nothing else is."""

import logging

import cocotb
import numpy as np
from bench_stereo import start
from cocotb.handle import HierarchyArrayObject, HierarchyObject
from cocotb.triggers import ClockCycles, FallingEdge, with_timeout
from cocotb_helpers import seeded
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource
from frames import random_pair, random_parameters
from raw_frames import RawFrame, random_raw_frame
from registers import BUILD, CONTROL, ENABLE, ERROR, ERRORS, INTERRUPT, PARITY, SOFT_RESET, UPSET
from verilated import Config

CONFIG = Config(16, 5, 64, rows=16, points=64)
NUM_MEMORIES = 24
MOMENTS = 40


class Bench:
    """The engine with its buses, and the buffer of its pyramid."""

    async def start(self, dut):
        logging.getLogger("cocotb.vista_stereo").setLevel(logging.ERROR)
        self.dut = dut
        self.registers = await start(dut)

        def stream(kind, name, reset=dut.rst_ni):
            bus = AxiStreamBus.from_prefix(dut, name)
            return kind(bus, dut.clk_i, reset, reset_active_level=False, byte_lanes=1)

        self.source, self.sink = stream(AxiStreamSource, "s_axis"), stream(AxiStreamSink, "m_axis")
        self.store = stream(AxiStreamSink, "store_axis", dut.store_rst_no)
        self.fetch = stream(AxiStreamSource, "fetch_axis", dut.store_rst_no)
        cocotb.start_soon(self.buffer())
        cocotb.start_soon(self.buffer_resets())
        await self.registers.write_dword(CONTROL, ENABLE)

    async def buffer(self):
        while True:
            line = await self.store.recv()
            await self.fetch.send(AxiStreamFrame(list(line.tdata), tuser=line.tuser))

    async def buffer_resets(self):
        while True:
            await FallingEdge(self.dut.store_rst_no)
            self.store.clear()
            self.fetch.clear()

    async def send(self, frame: RawFrame):
        for address, data in frame.writes():
            await self.registers.write_dword(address, data)
        height, width = frame.shape
        pair = frame.left.astype(int) | frame.right.astype(int) << 8
        for y in range(height):
            await self.source.send(
                AxiStreamFrame(pair[y].tolist(), tuser=[int(x == y == 0) for x in range(width)])
            )
        await self.source.wait()

    async def words(self, count: int):
        words = []
        while len(words) < count:
            words += (await with_timeout(self.sink.recv(), 1, "ms")).tdata
        return words

    async def emptied(self):
        """What is inside is dropped, and every memory holds words of zeros again."""
        await self.registers.write_dword(CONTROL, ENABLE | SOFT_RESET)
        await ClockCycles(self.dut.clk_i, 20)
        for bus in (self.sink, self.store, self.source, self.fetch):
            bus.clear()
        for memory in memories(self.dut):
            for word in memory:
                word.value = 0
        await ClockCycles(self.dut.clk_i, 5)
        await self.registers.write_dword(ERRORS, 0xFFFFFFFF)
        await self.registers.write_dword(INTERRUPT, 0xFFFFFFFF)


def memories(handle):
    """The words of each memory below a handle."""
    found = []
    for child in handle:
        if child._name == "mem":
            found.append(child)
        elif isinstance(child, HierarchyObject | HierarchyArrayObject):
            found += memories(child)
    return found


async def right(bench: Bench, frame: RawFrame):
    await bench.send(frame)
    expected = frame.words()
    assert await bench.words(len(expected)) == expected.tolist()
    assert await bench.registers.read_dword(ERRORS) == 0


@cocotb.test()
async def upsets_in_every_memory(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    bench = Bench()
    await bench.start(dut)
    assert await bench.registers.read_dword(BUILD) & PARITY
    for _ in range(4):
        await right(bench, random_raw_frame(rng, most_rows=20, config=CONFIG))

    frame = RawFrame(*random_pair(rng, "noise", 24, 32), random_parameters(rng, 16, 5), smooth=True, levels=2)
    found = memories(dut)
    assert len(found) == NUM_MEMORIES
    for memory in found:
        sender = cocotb.start_soon(bench.send(frame))
        for _ in range(MOMENTS):  # a word in a FIFO does not stay long
            await ClockCycles(dut.clk_i, random.randrange(5, 60))
            for word in memory:
                word.value = int(word.value) ^ 1 << random.randrange(len(word))
        await sender
        await ClockCycles(dut.clk_i, 1000)
        assert await bench.registers.read_dword(ERRORS) & UPSET, memory._path
        assert await bench.registers.read_dword(INTERRUPT) & ERROR
        await bench.emptied()
    await right(bench, frame)
