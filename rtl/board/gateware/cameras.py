# SPDX-License-Identifier: Apache-2.0
"""Two sensors with parallel ports at the board, whose pairs enter the engine as whole frames."""

from __future__ import annotations

from math import gcd
from typing import Any, NamedTuple

from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from migen import Cat, ClockSignal, If, Instance, ResetSignal, Signal

FIFO_PIXELS = 1024  # as many as one block RAM holds
MICROSECONDS = 1_000_000  # in a second
SKEW_BITS, MAX_SKEW_CLOCKS = 16, 256  # that a pixel waits for its partner; less than from line to line


class Sensor(NamedTuple):
    """Wires of a sensor: its pixel clock, which times the others; rst is of that clock."""

    clk: Any
    rst: Any
    vsync: Any
    href: Any
    data: Any


class Cameras(LiteXModule):
    """begins: a pair waits, and is dropped with `drop`. While `wanted`, `pixels` are those of the pair that
    waits, {right, left}, with the framing that `first` and `last` ask for. If the pair breaks off, has lines
    of another length, or nothing comes for so long that the caller says `silent`, `broken` is up until
    `clear`, and zeros come in its place: what has begun in the engine always ends. refused: how many frames
    of each camera found no partner since `restart`. now: microseconds since the reset; began: those at which
    the pair that waits, or the last one, began."""

    def __init__(self, sensors: list[Sensor], clk_freq: int) -> None:
        self.begins, self.drop, self.wanted = Signal(), Signal(), Signal()
        self.first, self.last, self.silent = Signal(), Signal(), Signal()
        self.broken, self.clear, self.restart = Signal(), Signal(), Signal()
        self.now, self.began = Signal(32), Signal(32)
        self.pixels = pixels = stream.Endpoint([("data", 16)])
        self.refused = [Signal(16, name=f"refused_{side}") for side in ("left", "right")]

        pair, ends, refuses, fits = stream.Endpoint([("data", 16)]), Signal(), Signal(2), Signal()
        self.specials += Instance(
            "vista_camera_pair",
            p_Depth=FIFO_PIXELS,
            p_SkewW=SKEW_BITS,
            i_pixel_clk_i=Cat(*(sensor.clk for sensor in sensors)),
            i_pixel_rst_ni=Cat(*(~sensor.rst for sensor in sensors)),
            i_vsync_i=Cat(*(sensor.vsync for sensor in sensors)),
            i_href_i=Cat(*(sensor.href for sensor in sensors)),
            i_data_i=Cat(*(sensor.data for sensor in sensors)),
            i_clk_i=ClockSignal(),
            i_rst_ni=~ResetSignal(),
            i_max_skew_i=MAX_SKEW_CLOCKS,
            o_m_axis_tvalid=pair.valid,
            i_m_axis_tready=pair.ready,
            o_m_axis_tdata=pair.data,
            o_m_axis_tuser=pair.first,
            o_m_axis_tlast=pair.last,
            o_pair_o=Signal(),
            o_broken_o=ends,
            o_refused_o=refuses,
            o_upset_o=Signal(),
        )
        taken = self.wanted & ~self.broken
        self.comb += [
            self.begins.eq(pair.valid & pair.first),
            fits.eq(pair.valid & (pair.first == self.first) & (pair.last == self.last)),
            pixels.valid.eq(self.wanted & (fits | self.broken)),
            If(~self.broken, pixels.data.eq(pair.data)),
            # What belongs to no frame goes; the first pixel of the next pair waits for its turn.
            If(taken, pair.ready.eq(fits & pixels.ready)).Else(pair.ready.eq(~pair.first | self.drop)),
        ]
        self.sync += [
            If(taken & ((pair.valid & ~fits) | ends | (self.silent & ~pair.valid)), self.broken.eq(1)),
            If(self.clear, self.broken.eq(0)),
            *(If(refuses[i], count.eq(count + 1)) for i, count in enumerate(self.refused)),
            If(self.restart, *(count.eq(0) for count in self.refused)),
            If(~self.begins, self.began.eq(self.now)),
        ]
        # `step` a clock, of `whole` that a microsecond has.
        step, whole = (number // gcd(MICROSECONDS, clk_freq) for number in (MICROSECONDS, clk_freq))
        part = Signal(max=whole)
        self.sync += If(part >= whole - step, part.eq(part - (whole - step)), self.now.eq(self.now + 1)).Else(
            part.eq(part + step)
        )
