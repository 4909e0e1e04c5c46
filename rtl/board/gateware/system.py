# SPDX-License-Identifier: Apache-2.0
"""What is on a board beside its pins: the engine, its memory, UDP on any Ethernet PHY of LiteEth, and, if it
has any, two cameras."""

from __future__ import annotations

from ipaddress import IPv4Address
from typing import Any

from liteeth.common import eth_udp_user_description
from liteeth.core import LiteEthUDPIPCore
from litex.gen import LiteXModule
from litex.soc.interconnect.packet import PacketFIFO
from wire import CONSTANTS

from gateware.cameras import Cameras, Sensor
from gateware.engine import Build, Engine
from gateware.memory import BoardMemory
from gateware.packets import PacketBuffer
from gateware.runner import Runner
from gateware.server import Server
from gateware.slots import Slots

# Replies that wait: two, of at most 262 words each. LiteX's PacketFIFO counts a packet more than once whose
# last word finds it full, so there is room for more than can come.
REPLIES, REPLY_WORDS = 2, 1024

# From one clock to the other: as many as one piece of distributed memory holds, for the sake of 125 MHz.
CROSSING_WORDS = 16


# Of the Ethernet address: locally administered, and the IPv4 address behind it.
MAC_BASE = 0x0256 << 32


def mac_address_of(ip_address: str) -> int:
    """Tells boards of one network apart, as their IPv4 addresses do."""
    return MAC_BASE | int(IPv4Address(ip_address))


class BoardSystem(LiteXModule):
    """One clock, `sys`, and those of the Ethernet PHY."""

    def __init__(
        self,
        build: Build,
        sdram_phy: Any,
        sdram_module: Any,
        ethernet_phy: Any,
        clk_freq: float,
        ip_address: str,
        sensors: list[Sensor] | None = None,  # the left and the right one
        quick_start: bool = False,
        patience_bits: int = 20,  # 23 ms at 45 MHz
        hold_bits: int = 27,  # HOLD_MS at 45 MHz
    ) -> None:
        self.memory = BoardMemory(sdram_phy, sdram_module, clk_freq, quick_start)
        self.network = LiteEthUDPIPCore(
            ethernet_phy,
            mac_address_of(ip_address),
            ip_address,
            int(clk_freq),
            dw=32,
            with_sys_datapath=True,
            tx_cdc_depth=CROSSING_WORDS,
            rx_cdc_depth=CROSSING_WORDS,
        )
        self.packets = PacketBuffer()
        self.slots = Slots()
        self.engine = Engine(self.memory, build)
        self.cameras = cameras = None if sensors is None else Cameras(sensors, int(clk_freq))
        self.runner = runner = Runner(self.memory, self.slots, self.engine, patience_bits, cameras)
        self.server = Server(self.packets, self.memory, self.slots, self.engine, runner, hold_bits, cameras)
        port = self.network.udp.crossbar.get_port(CONSTANTS["PORT"], dw=32)
        # A reply leaves once all of it is there: memory may be late, and an Ethernet frame cannot pause.
        self.replies = PacketFIFO(eth_udp_user_description(32), REPLY_WORDS, REPLIES - 1, buffered=True)
        self.comb += [
            port.source.connect(self.packets.sink),
            self.server.source.connect(self.replies.sink),
            self.replies.source.connect(port.sink),
        ]
