# SPDX-License-Identifier: Apache-2.0
"""The memory of a board: LiteDRAM without a processor, which is why the chip is initialised here."""

from __future__ import annotations

from typing import Any

from litedram.core import LiteDRAMCore
from litedram.frontend.dma import LiteDRAMDMAReader, LiteDRAMDMAWriter
from litedram.init import get_sdram_phy_init_sequence
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from migen import FSM, Array, If, NextState, NextValue, Signal

# Where things lie, in words of 32 bits, and how many bits of address they take.
WORDS_OUT_BITS = 19  # the words of a frame: slot 0, slot 1
PIXELS_BASE, PIXELS_BITS = 2 << WORDS_OUT_BITS, 18  # the pixels of a frame: slot 0, slot 1
CHECKS_BASE, CHECKS_BITS = 7 << 18, 11  # the check of each chunk of words: slot 0, slot 1
PYRAMID_BASE_BYTES, PYRAMID_BYTES = 6 << 20, 1 << 20  # the buffer of the pyramid

BURST, BURST_ROOM = 32, 64  # words of the engine that are written together, and that wait

COMMAND_GAP = 16  # clocks between two commands of the initialisation, more than any chip asks for


class BoardMemory(LiteXModule):
    """get_port as of LiteDRAM's crossbar; `ready` once the chip may be used."""

    def __init__(self, phy: Any, module: Any, clk_freq: float, quick_start: bool = False) -> None:
        self.core = core = LiteDRAMCore(phy, module.geom_settings, module.timing_settings, clk_freq)
        self.get_port = core.crossbar.get_port
        self.ready = Signal()

        sequence, _ = get_sdram_phy_init_sequence(phy.settings, module.timing_settings)
        waits = [COMMAND_GAP + (0 if quick_start else delay) for *_, delay in sequence]
        step, wait = Signal(max=len(sequence) + 1), Signal(max=max(waits) + 1)
        first = core.dfii.ext_dfi.phases[0]
        pins = [("CS", first.cs_n), ("RAS", first.ras_n), ("CAS", first.cas_n), ("WE", first.we_n)]
        self.comb += [core.dfii.ext_dfi_sel.eq(~self.ready), first.cke.eq(1), first.reset_n.eq(1)]
        self.comb += [pin.eq(1) for _, pin in pins]
        self.comb += [
            first.address.eq(Array([address for _, address, *_ in sequence])[step]),
            first.bank.eq(Array([bank for _, _, bank, *_ in sequence])[step]),
        ]
        self.fsm = fsm = FSM(reset_state="COMMAND")
        fsm.act(
            "COMMAND",
            *(pin.eq(Array([_without(name, entry[3]) for entry in sequence])[step]) for name, pin in pins),
            NextValue(wait, Array(waits)[step]),
            NextState("WAIT"),
        )
        fsm.act(
            "WAIT",
            NextValue(wait, wait - 1),
            If(
                wait == 0,
                NextValue(step, step + 1),
                If(step == len(sequence) - 1, NextState("READY")).Else(NextState("COMMAND")),
            ),
        )
        fsm.act("READY", self.ready.eq(1))


class Reader(LiteXModule):
    """LiteDRAM's reader behind registers: the way through the crossbar and back takes most of a clock."""

    def __init__(self, memory: Any, read_ahead: int, fifo_buffered: bool = False) -> None:
        self.dma = dma = LiteDRAMDMAReader(memory.get_port("read"), read_ahead, fifo_buffered)
        self.registers = registers = _registers_before(dma.sink)
        self.comb += registers.source.connect(dma.sink)
        self.sink, self.source = registers.sink, dma.source


class Writer(LiteXModule):
    """The same of its writer. idle: all that was taken has entered the crossbar, so that whatever is read
    from now on comes after it."""

    def __init__(self, memory: Any) -> None:
        self.dma = dma = LiteDRAMDMAWriter(memory.get_port("write"))
        self.registers = registers = _registers_before(dma.sink)
        self.sink, self.idle = registers.sink, Signal()
        inside = Signal(2)
        taken, gone = self.sink.valid & self.sink.ready, dma.sink.valid & dma.sink.ready
        self.comb += [registers.source.connect(dma.sink), self.idle.eq(inside == 0)]
        self.sync += inside.eq(inside + taken - gone)


class BurstWriter(LiteXModule):
    """A Writer that waits until BURST words are there, and then writes all, or as long as `flush` is up: a
    bank of the chip changes hands less often. bursts: it is at that."""

    def __init__(self, memory: Any) -> None:
        self.writer = writer = Writer(memory)
        self.fifo = fifo = stream.SyncFIFO(writer.sink.description, BURST_ROOM)
        self.sink, self.flush, self.bursts, self.idle = fifo.sink, Signal(), Signal(), Signal()
        goes = Signal()
        self.comb += [
            goes.eq(fifo.source.valid & (self.bursts | self.flush | (fifo.level >= BURST))),
            writer.sink.valid.eq(goes),
            writer.sink.address.eq(fifo.source.address),
            writer.sink.data.eq(fifo.source.data),
            fifo.source.ready.eq(goes & writer.sink.ready),
            self.idle.eq(writer.idle & ~fifo.source.valid),
        ]
        self.sync += self.bursts.eq(goes)


def _registers_before(sink: Any) -> stream.Buffer:
    return stream.Buffer(sink.description, pipe_valid=True, pipe_ready=True)


def _without(name: str, command: str) -> int:
    """1 unless the command, which is text for C, pulls this pin."""
    return int(f"DFII_COMMAND_{name}" not in command.split("|"))
