# SPDX-License-Identifier: Apache-2.0
"""The buffer of the pyramid in the memory of a board: pixels of the smaller levels out and back, in order."""

from __future__ import annotations

from typing import Any

from litedram.frontend.fifo import LiteDRAMFIFO
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from migen import Cat, If, Signal

from gateware.memory import PYRAMID_BASE_BYTES, PYRAMID_BYTES

BEAT = [("data", 16), ("user", 1), ("end", 1)]
BEAT_BITS, GROUP_BEATS = 18, 7  # a group of pixels fills four words, but for two bits
GROUP_BITS, WORD_BITS, GROUP_WORDS = BEAT_BITS * GROUP_BEATS, 32, 4


class LevelBuffer(LiteXModule):
    """sink, source: beats with start of frame and end of line. Groups do not cross an end of line, so that
    nothing that came stays behind; what fills up a group is dropped."""

    def __init__(self, memory: Any) -> None:
        self.sink, self.source = sink, source = stream.Endpoint(BEAT), stream.Endpoint(BEAT)
        self.fifo = fifo = LiteDRAMFIFO(
            WORD_BITS, PYRAMID_BASE_BYTES, PYRAMID_BYTES, memory.get_port("write"), memory.get_port("read")
        )
        # A group waits in registers while the next one is put together.
        self.gather = gather = stream.Converter(BEAT_BITS, GROUP_BITS)
        self.gathered = gathered = stream.Buffer([("data", GROUP_BITS)])
        self.split = split = stream.Converter(GROUP_WORDS * WORD_BITS, WORD_BITS)
        self.join = join = stream.Converter(WORD_BITS, GROUP_WORDS * WORD_BITS)
        self.joined = joined = stream.Buffer([("data", GROUP_BITS)])
        self.spread = spread = stream.Converter(GROUP_BITS, BEAT_BITS)
        filling = Signal()
        self.comb += [
            gather.sink.valid.eq(sink.valid),
            gather.sink.data.eq(Cat(sink.data, sink.user, sink.end)),
            gather.sink.last.eq(sink.end),
            sink.ready.eq(gather.sink.ready),
            *_passes(gather.source, gathered.sink),
            *_passes(gathered.source, split.sink),
            *_passes(split.source, fifo.sink),
            *_passes(fifo.source, join.sink),
            *_passes(join.source, joined.sink),
            *_passes(joined.source, spread.sink),
            spread.sink.last.eq(1),  # of the beats of a group
            source.valid.eq(spread.source.valid & ~filling),
            Cat(source.data, source.user, source.end).eq(spread.source.data),
            spread.source.ready.eq(source.ready | filling),
        ]
        self.sync += If(
            spread.source.valid & spread.source.ready,
            filling.eq(~spread.source.last & (filling | source.end)),
        )


def _passes(source: Any, sink: Any) -> list[Any]:
    """Data from one stream to another, but for the marks of packets."""
    return [sink.valid.eq(source.valid), sink.data.eq(source.data), source.ready.eq(sink.ready)]
