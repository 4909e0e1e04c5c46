# SPDX-License-Identifier: Apache-2.0
"""Whole packets from and to UDP: those that arrived, in memory; those that leave, word by word."""

from __future__ import annotations

import wire
from liteeth.common import eth_udp_user_description
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from migen import If, Memory, Signal

PACKETS = 8  # that the buffer holds, that under work included
PACKET_WORDS = wire.HEADER_WORDS + wire.CHUNK_WORDS
STRIDE_BITS = 9  # words from one packet to the next in memory

DESCRIPTOR = [("ip_address", 32), ("port", 16), ("words", STRIDE_BITS)]
LAST_BYTE = 0b1000  # of a word: all four count


class PacketBuffer(LiteXModule):
    """Keeps packets that arrived whole and without error, and drops all others, also when it is full.

    Whole are those of whole words, as many as the length in their UDP header says.

    source: the oldest packet's sender and length; taking it frees its memory. data: word `address` of that
    packet, one clock after the address."""

    def __init__(self) -> None:
        self.sink = sink = stream.Endpoint(eth_udp_user_description(32))
        self.address = Signal(STRIDE_BITS)
        self.data = Signal(32)

        self.fifo = fifo = stream.SyncFIFO(DESCRIPTOR, PACKETS)
        self.source = fifo.source
        memory = Memory(32, PACKETS << STRIDE_BITS)
        write, read = memory.get_port(write_capable=True), memory.get_port()
        self.specials += memory, write, read

        slot_bits = PACKETS.bit_length() - 1
        written, taken = Signal(slot_bits), Signal(slot_bits)
        offset = Signal(STRIDE_BITS)
        bad = Signal()  # this packet, so far
        whole, has_length = Signal(), Signal()
        self.comb += [
            has_length.eq(sink.length == (offset + 1) << 2),
            sink.ready.eq(1),
            write.adr.eq(offset | written << STRIDE_BITS),
            write.dat_w.eq(sink.data),
            write.we.eq(sink.valid & fifo.sink.ready),
            read.adr.eq(self.address | taken << STRIDE_BITS),
            self.data.eq(read.dat_r),
            whole.eq(~bad & ~(sink.error != 0) & fifo.sink.ready & (offset < PACKET_WORDS) & has_length),
            fifo.sink.valid.eq(sink.valid & sink.last & whole),
            fifo.sink.ip_address.eq(sink.ip_address),
            fifo.sink.port.eq(sink.src_port),
            fifo.sink.words.eq(offset + 1),
        ]
        self.sync += [
            If(
                sink.valid,
                If(
                    sink.last,
                    offset.eq(0),
                    bad.eq(0),
                    If(whole, written.eq(written + 1)),
                ).Else(
                    If(offset < PACKET_WORDS, offset.eq(offset + 1)),
                    If((sink.error != 0) | ~fifo.sink.ready, bad.eq(1)),
                ),
            ),
            If(fifo.source.valid & fifo.source.ready, taken.eq(taken + 1)),
        ]
