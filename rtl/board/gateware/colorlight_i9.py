# SPDX-License-Identifier: Apache-2.0
"""The board on a Colorlight i9, version 7.2: an ECP5 of 45,000 LUT4, 8 MB of SDRAM, gigabit Ethernet.

python -m gateware.colorlight_i9 FOLDER DISPARITIES BLOCK WIDTH ROWS POINTS MHZ IP_ADDRESS [cameras]
writes board.v and board.lpf.
"""

from __future__ import annotations

import sys
from typing import Any

from litedram.modules import M12L64322A
from litedram.phy import GENSDRPHY
from liteeth.phy.ecp5rgmii import LiteEthPHYRGMII
from litex.build.generic_platform import IOStandard, Pins, Subsignal
from litex.build.io import DDROutput
from litex.gen import LiteXModule
from litex.soc.cores.clock import ECP5PLL
from litex_boards.platforms.colorlight_i5 import Platform
from migen import ClockDomain, ClockSignal, If, ResetSignal, Signal
from migen.genlib.resetsync import AsyncResetSynchronizer

from gateware.cameras import Sensor
from gateware.engine import Build
from gateware.system import BoardSystem

OSCILLATOR_HZ = 25e6
BLINK_BITS = 26  # a blink takes about a second
PIXEL_HZ = 54e6  # of a sensor's clock, at most
# Sockets of a sensor: its data, then its pixel clock, VSYNC and HREF on the first pins of the other. Of the
# platform's sockets pmodc has the pins of the LED and of the reset.
SENSOR_SOCKETS = (("pmode", "pmodf"), ("pmodk", "pmodl"))
FLASH_BITS = 22  # the least time that the LED shows a frame, 0.09 s at 45 MHz


class Clocks(LiteXModule):
    """`sys` of all but the Ethernet PHY; the chip of memory takes its clock half a period later."""

    def __init__(self, platform: Any, clk_freq: float) -> None:
        self.cd_sys, self.cd_sys_ps = ClockDomain("sys"), ClockDomain("sys_ps")
        self.pll = pll = ECP5PLL()
        self.comb += pll.reset.eq(~platform.request("cpu_reset_n"))
        pll.register_clkin(platform.request("clk25"), OSCILLATOR_HZ)
        pll.create_clkout(self.cd_sys, clk_freq, margin=0)
        pll.create_clkout(self.cd_sys_ps, clk_freq, phase=180, margin=0)
        self.specials += DDROutput(1, 0, platform.request("sdram_clock"), ClockSignal("sys_ps"))


def sensor_pins(data: str, control: str, number: int) -> tuple[Any, ...]:
    pins = [
        Subsignal("data", Pins(" ".join(f"{data}:{i}" for i in range(8)))),
        *(Subsignal(name, Pins(f"{control}:{i}")) for i, name in enumerate(("clk", "vsync", "href"))),
    ]
    return ("sensor", number, *pins, IOStandard("LVCMOS33"))


class ColorlightI9(LiteXModule):
    def __init__(self, platform: Any, build: Build, clk_freq: float, ip_address: str, cameras: bool) -> None:
        self.clocks = Clocks(platform, clk_freq)
        self.sdram = GENSDRPHY(platform.request("sdram"), clk_freq)
        self.ethernet = LiteEthPHYRGMII(
            platform.request("eth_clocks", 0), platform.request("eth", 0), tx_delay=0
        )
        module = M12L64322A(clk_freq, "1:1")
        sensors = [self._sensor(platform, i) for i in range(2)] if cameras else None
        self.board = board = BoardSystem(
            build, self.sdram, module, self.ethernet, clk_freq, ip_address, sensors
        )

        # The LED is off until memory is ready, blinks while nothing is matched, and is lit while frames are.
        blink, lit = Signal(BLINK_BITS), Signal(FLASH_BITS)
        self.sync += [
            blink.eq(blink + 1),
            If(board.runner.busy, lit.eq(2**FLASH_BITS - 1)).Elif(lit != 0, lit.eq(lit - 1)),
        ]
        self.comb += platform.request("user_led_n").eq(~(board.memory.ready & (blink[-1] | (lit != 0))))

    def _sensor(self, platform: Any, number: int) -> Sensor:
        platform.add_extension([sensor_pins(*SENSOR_SOCKETS[number], number)])
        pads = platform.request("sensor", number)
        domain = ClockDomain(f"sensor_{number}")
        setattr(self, f"cd_sensor_{number}", domain)
        self.comb += domain.clk.eq(pads.clk)
        self.specials += AsyncResetSynchronizer(domain, ResetSignal("sys"))
        platform.add_period_constraint(pads.clk, 1e9 / PIXEL_HZ)
        return Sensor(domain.clk, domain.rst, pads.vsync, pads.href, pads.data)


def main(folder: str, numbers: list[int], mhz: float, ip_address: str, cameras: bool) -> None:
    platform = Platform(board="i9", revision="7.2", toolchain="trellis")
    top = ColorlightI9(platform, Build(*numbers), mhz * 1e6, ip_address, cameras)
    platform.build(top, build_dir=folder, build_name="board", run=False)


if __name__ == "__main__":
    main(
        sys.argv[1],
        [int(number) for number in sys.argv[2:7]],
        float(sys.argv[7]),
        sys.argv[8],
        "cameras" in sys.argv[9:],
    )
