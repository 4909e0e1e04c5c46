# SPDX-License-Identifier: Apache-2.0
"""Server, runner, slots and packet buffer of the board as Verilog for a simulator, without what is slow.

Packets come as LiteEth hands them over. Memory answers after a few clocks, and in place of the engine there
is one that adds up: word n of a frame is the sum of its pixels up to the n-th, each with 1 added. So a pixel
or a word that is lost, doubled or left over makes words wrong.

python -m gateware.server_alone FOLDER
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

from litedram.common import LiteDRAMNativePort
from litex.gen import LiteXModule
from litex.gen.fhdl import verilog
from litex.soc.interconnect import stream
from migen import Array, ClockDomain, If, Memory, Signal

from gateware.packets import PacketBuffer
from gateware.runner import Runner
from gateware.server import Server
from gateware.slots import Slots

ADDRESS_BITS = 21
READ_CLOCKS = 4
REGISTERS = 32
PATIENCE_BITS, HOLD_BITS = 16, 40  # nobody else gets the board by waiting


class PlainMemory(LiteXModule):
    """get_port as of LiteDRAM's crossbar."""

    def __init__(self) -> None:
        self.ready = Signal(reset=1)
        self.memory = Memory(32, 1 << ADDRESS_BITS)
        self.specials += self.memory

    def get_port(self, mode: str) -> LiteDRAMNativePort:
        port = LiteDRAMNativePort(mode, ADDRESS_BITS, 32)
        own = self.memory.get_port(write_capable=mode == "write")
        self.specials += own
        if mode == "write":
            addresses = stream.SyncFIFO([("address", ADDRESS_BITS)], 4)
            self.submodules += addresses
            both = addresses.source.valid & port.wdata.valid
            self.comb += [
                addresses.sink.valid.eq(port.cmd.valid),
                addresses.sink.address.eq(port.cmd.addr),
                port.cmd.ready.eq(addresses.sink.ready),
                port.wdata.ready.eq(addresses.source.valid),
                addresses.source.ready.eq(port.wdata.valid),
                own.adr.eq(addresses.source.address),
                own.dat_w.eq(port.wdata.data),
                own.we.eq(both),
            ]
        else:
            valid = [Signal() for _ in range(READ_CLOCKS)]
            data = [Signal(32) for _ in range(READ_CLOCKS - 1)]
            self.comb += [
                port.cmd.ready.eq(1),
                own.adr.eq(port.cmd.addr),
                port.rdata.valid.eq(valid[-1]),
                port.rdata.data.eq(data[-1]),
            ]
            self.sync += [
                valid[0].eq(port.cmd.valid),
                *(later.eq(earlier) for earlier, later in pairwise(valid)),
                *(later.eq(earlier) for earlier, later in pairwise([own.dat_r, *data])),
            ]
        return port


class AddingEngine(LiteXModule):
    """The interface of gateware.engine.Engine."""

    def __init__(self) -> None:
        self.pixels = stream.Endpoint([("data", 16)])
        self.words = stream.Endpoint([("data", 32)])
        self.write, self.read, self.done = Signal(), Signal(), Signal()
        self.address, self.new_value, self.value = Signal(7), Signal(32), Signal(32)

        total, word = Signal(32), Signal(32)
        registers = Array(Signal(32, name=f"register_{i}") for i in range(REGISTERS))
        self.comb += [
            word.eq(total + self.pixels.data + 1),
            If(self.pixels.first, word.eq(self.pixels.data + 1)),
            self.words.valid.eq(self.pixels.valid),
            self.pixels.ready.eq(self.words.ready),
            self.words.data.eq(word),
            self.value.eq(registers[self.address[2:]]),
            self.done.eq(self.write | self.read),
        ]
        self.sync += [
            If(self.pixels.valid & self.pixels.ready, total.eq(word)),
            If(self.write, registers[self.address[2:]].eq(self.new_value)),
        ]


class ServerAlone(LiteXModule):
    def __init__(self) -> None:
        self.clk, self.rst = Signal(name="clk"), Signal(name="rst")
        self.cd_sys = ClockDomain("sys")
        self.comb += [self.cd_sys.clk.eq(self.clk), self.cd_sys.rst.eq(self.rst)]
        self.memory = memory = PlainMemory()
        self.packets = packets = PacketBuffer()
        self.slots, self.engine = Slots(), AddingEngine()
        self.runner = Runner(memory, self.slots, self.engine, PATIENCE_BITS)
        self.server = server = Server(packets, memory, self.slots, self.engine, self.runner, HOLD_BITS)
        self.pins: list[Signal] = [self.clk, self.rst]
        self._pin("in_valid", packets.sink.valid)
        self._pin("in_last", packets.sink.last)
        self._pin("in_data", packets.sink.data)
        self._pin("in_length", packets.sink.length)
        self._pin("in_address", packets.sink.ip_address)
        self._pin("in_port", packets.sink.src_port)
        room, idle = Signal(name="room"), Signal(name="idle")
        self.comb += [
            room.eq(packets.fifo.sink.ready),
            idle.eq(~packets.source.valid & server.fsm.ongoing("IDLE") & ~server.left_over),
            server.source.ready.eq(1),
        ]
        self.pins += [room, idle]
        for name, signal in (
            ("out_valid", server.source.valid),
            ("out_last", server.source.last),
            ("out_data", server.source.data),
            ("out_address", server.source.ip_address),
            ("out_port", server.source.dst_port),
            ("out_length", server.source.length),
        ):
            pin = Signal(len(signal), name=name)
            self.comb += pin.eq(signal)
            self.pins.append(pin)

    def _pin(self, name: str, signal: Signal) -> None:
        pin = Signal(len(signal), name=name)
        self.comb += signal.eq(pin)
        self.pins.append(pin)


def main(folder: Path) -> None:
    server = ServerAlone()
    verilog.convert(server, set(server.pins), name="server").write(str(folder / "server.v"))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
