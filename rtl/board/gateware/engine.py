# SPDX-License-Identifier: Apache-2.0
"""vista_stereo with its front end in LiteX: streams, registers, and the pyramid's buffer in memory."""

from __future__ import annotations

from typing import Any, NamedTuple

from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from migen import ClockSignal, If, Instance, ResetInserter, ResetSignal, Signal

from gateware.levels import LevelBuffer


class Build(NamedTuple):
    num_disparities: int
    block_size: int
    max_width: int
    num_rows: int
    max_points: int


class Engine(LiteXModule):
    """pixels: {right, left}, `first` on the first of a frame and `last` on the last of each row. words: as
    they leave. Registers: hold `write` or `read` with address and data until `done`."""

    def __init__(self, memory: Any, build: Build) -> None:
        self.pixels = stream.Endpoint([("data", 16)])
        self.words = stream.Endpoint([("data", 32)])
        self.write, self.read, self.done = Signal(), Signal(), Signal()
        self.address, self.new_value, self.value = Signal(7), Signal(32), Signal(32)

        self.buffer = buffer = ResetInserter()(LevelBuffer(memory))
        store, fetch, keep = buffer.sink, buffer.source, Signal()
        self.comb += buffer.reset.eq(~keep)

        # One access at a time; address and data of a write go together.
        address_sent, data_sent = Signal(), Signal()
        awready, wready, bvalid, arready, rvalid = (Signal() for _ in range(5))
        self.sync += [
            If((self.write & awready) | (self.read & arready), address_sent.eq(1)),
            If(self.write & wready, data_sent.eq(1)),
            If(self.done, address_sent.eq(0), data_sent.eq(0)),
        ]
        self.comb += self.done.eq((self.write & bvalid) | (self.read & rvalid))

        self.specials += Instance(
            "vista_stereo",
            p_NumDisparities=build.num_disparities,
            p_BlockSize=build.block_size,
            p_MaxWidth=build.max_width,
            p_FrontEnd=1,
            p_NumRows=build.num_rows,
            p_MaxPoints=build.max_points,
            i_clk_i=ClockSignal(),
            i_rst_ni=~ResetSignal(),
            i_s_axis_tvalid=self.pixels.valid,
            o_s_axis_tready=self.pixels.ready,
            i_s_axis_tdata=self.pixels.data,
            i_s_axis_tuser=self.pixels.first,
            i_s_axis_tlast=self.pixels.last,
            o_m_axis_tvalid=self.words.valid,
            i_m_axis_tready=self.words.ready,
            o_m_axis_tdata=self.words.data,
            o_m_axis_tuser=self.words.first,
            o_m_axis_tlast=self.words.last,
            o_store_axis_tvalid=store.valid,
            i_store_axis_tready=store.ready,
            o_store_axis_tdata=store.data,
            o_store_axis_tuser=store.user,
            o_store_axis_tlast=store.end,
            i_fetch_axis_tvalid=fetch.valid,
            o_fetch_axis_tready=fetch.ready,
            i_fetch_axis_tdata=fetch.data,
            i_fetch_axis_tuser=fetch.user,
            i_fetch_axis_tlast=fetch.end,
            o_store_rst_no=keep,
            i_s_axil_awvalid=self.write & ~address_sent,
            o_s_axil_awready=awready,
            i_s_axil_awaddr=self.address,
            i_s_axil_awprot=0,
            i_s_axil_wvalid=self.write & ~data_sent,
            o_s_axil_wready=wready,
            i_s_axil_wdata=self.new_value,
            i_s_axil_wstrb=0xF,
            o_s_axil_bvalid=bvalid,
            i_s_axil_bready=self.write,
            o_s_axil_bresp=Signal(2),
            i_s_axil_arvalid=self.read & ~address_sent,
            o_s_axil_arready=arready,
            i_s_axil_araddr=self.address,
            i_s_axil_arprot=0,
            o_s_axil_rvalid=rvalid,
            i_s_axil_rready=self.read,
            o_s_axil_rdata=self.value,
            o_s_axil_rresp=Signal(2),
            o_irq_o=Signal(),
        )
