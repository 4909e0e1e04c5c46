# SPDX-License-Identifier: Apache-2.0
"""The board with models in place of its chips, as Verilog for a simulator.

python -m gateware.simulated FOLDER DISPARITIES BLOCK WIDTH ROWS POINTS
"""

from __future__ import annotations

import sys
from pathlib import Path

from litedram.modules import M12L64322A
from litedram.phy.model import SDRAMPHYModel
from liteeth.common import eth_phy_description
from litex.gen import LiteXModule
from litex.gen.fhdl import verilog
from litex.soc.interconnect import stream
from migen import ClockDomain, ResetSignal, Signal

from gateware.cameras import Sensor
from gateware.engine import Build
from gateware.system import BoardSystem

CLK_FREQ = 45e6
IP_ADDRESS = "192.168.1.50"


class SimulatedPhy(LiteXModule):
    """Bytes of Ethernet frames from preamble to check sum, a clock `eth_clk` each; one without `valid` ends a
    frame."""

    dw = 8

    def __init__(self, eth_clk: Signal) -> None:
        self.rx_valid, self.rx_data = Signal(), Signal(8)
        self.tx_valid, self.tx_data = Signal(), Signal(8)
        self.sink = sink = stream.Endpoint(eth_phy_description(8))
        self.source = source = stream.Endpoint(eth_phy_description(8))
        self.cd_eth_rx, self.cd_eth_tx = ClockDomain("eth_rx"), ClockDomain("eth_tx")
        for domain in (self.cd_eth_rx, self.cd_eth_tx):
            self.comb += [domain.clk.eq(eth_clk), domain.rst.eq(ResetSignal("sys"))]
        last_valid, last_data = Signal(), Signal(8)
        self.sync.eth_rx += [last_valid.eq(self.rx_valid), last_data.eq(self.rx_data)]
        self.comb += [
            source.valid.eq(last_valid),
            source.data.eq(last_data),
            source.last.eq(last_valid & ~self.rx_valid),
            source.last_be.eq(source.last),
            sink.ready.eq(1),
            self.tx_valid.eq(sink.valid),
            self.tx_data.eq(sink.data),
        ]


class Simulated(LiteXModule):
    def __init__(self, build: Build) -> None:
        self.clk, self.rst, self.eth_clk = Signal(name="clk"), Signal(name="rst"), Signal(name="eth_clk")
        self.cd_sys = ClockDomain("sys")
        self.comb += [self.cd_sys.clk.eq(self.clk), self.cd_sys.rst.eq(self.rst)]
        self.phy = phy = SimulatedPhy(self.eth_clk)
        self.sensors = [Sensor(*(Signal(n) for n in (1, 1, 1, 1, 8))) for _ in range(2)]
        module = M12L64322A(CLK_FREQ, "1:1")
        self.sdram = SDRAMPHYModel(module, data_width=32, clk_freq=CLK_FREQ)
        self.board = BoardSystem(
            build,
            self.sdram,
            module,
            phy,
            CLK_FREQ,
            IP_ADDRESS,
            sensors=list(self.sensors),
            quick_start=True,
            patience_bits=16,
            hold_bits=20,
        )
        self.pins = {}
        for name in ("rx_valid", "rx_data", "tx_valid", "tx_data"):
            inside = getattr(phy, name)
            pin = self.pins[name] = Signal(len(inside), name=name)
            self.comb += inside.eq(pin) if name.startswith("rx") else pin.eq(inside)
        for side, sensor in zip(("left", "right"), self.sensors, strict=True):
            self.comb += sensor.rst.eq(self.rst)
            for name in ("clk", "vsync", "href", "data"):
                inside = getattr(sensor, name)
                pin = self.pins[f"{side}_{name}"] = Signal(len(inside), name=f"{side}_{name}")
                self.comb += inside.eq(pin)
        busy = self.pins["busy"] = Signal(name="busy")  # a frame is being matched
        self.comb += busy.eq(self.board.runner.busy)


def main(folder: Path, numbers: list[int]) -> None:
    board = Simulated(Build(*numbers))
    ios = {board.clk, board.rst, board.eth_clk, *board.pins.values()}
    verilog.convert(board, ios, name="board").write(str(folder / "board.v"))


if __name__ == "__main__":
    main(Path(sys.argv[1]), [int(number) for number in sys.argv[2:]])
