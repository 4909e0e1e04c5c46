# SPDX-License-Identifier: Apache-2.0
"""Obeys the packets of a host one after the other, as wire.toml says."""

from __future__ import annotations

from typing import Any

import wire
from liteeth.common import eth_udp_user_description
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from migen import FSM, Array, C, Case, Cat, If, Mux, NextState, NextValue, Signal
from wire import BITMAP_WORDS, CHUNK_WORDS, CONSTANTS, HEADER, HEADER_WORDS, PAYLOAD, REPLIES, REQUESTS

from gateware.cameras import Cameras
from gateware.memory import CHECKS_BASE, CHECKS_BITS, PIXELS_BASE, PIXELS_BITS, WORDS_OUT_BITS, Reader, Writer
from gateware.packets import LAST_BYTE, PACKET_WORDS, PacketBuffer
from gateware.slots import BITMAP_BITS, SLOTS, STATES, Slots

CREDITS = 7  # pixels on the way; the buffer has room for one packet more
READ_AHEAD = 32  # words


def field(words: Any, layout: dict[str, wire.Field], name: str) -> Any:
    """A field of words that are signals."""
    f = layout[name]
    return words[f.word][f.low : f.low + f.bits]


class Server(LiteXModule):
    """packets: what arrived. source: replies, to UDP. It begins when the memory is ready. Who began a session
    holds the board until 2**hold_bits clocks without a packet of his have passed."""

    def __init__(
        self,
        packets: PacketBuffer,
        memory: Any,
        slots: Slots,
        engine: Any,
        runner: Any,
        hold_bits: int,
        cameras: Cameras | None = None,
    ) -> None:
        self.source = source = stream.Endpoint(eth_udp_user_description(32))

        self.reader = reader = Reader(memory, READ_AHEAD)
        self.writer = writer = Writer(memory)

        session, last_write = runner.session, Signal(32)
        open_now = Signal()  # the session is, and its client:
        holder_address, holder_port, silence, heard = Signal(32), Signal(16), Signal(hold_bits + 1), Signal()
        from_holder, held = Signal(), Signal()  # held: by another client than the packet's
        self.comb += [
            from_holder.eq(
                (packets.source.ip_address == holder_address) & (packets.source.port == holder_port)
            ),
            held.eq(open_now & ~silence[-1] & ~from_holder),
        ]
        self.sync += If(heard, silence.eq(0)).Elif(~silence[-1], silence.eq(silence + 1))
        chunks_out = Signal(16)  # of the words of a frame of this session
        header = Array(Signal(32, name=f"header_{i}") for i in range(HEADER_WORDS))
        opening = Array(Signal(32, name=f"opening_{i}") for i in range(wire.PAYLOAD_WORDS["open"]))
        kind, token, frame, index, count = (
            field(header, HEADER, name) for name in ("kind", "token", "frame", "index", "count")
        )
        asked_session = field(header, HEADER, "session")
        slot = frame[0]
        position = Signal(10)  # word of the packet, of the reply, or of the bitmap
        done_words = Signal(16)  # of a read or a write
        chunk = Signal(16)  # of words
        reply = Signal(8)

        is_kind = {name: Signal(name=f"is_{name}") for name in REQUESTS}
        self.comb += [is_kind[name].eq(kind == number) for name, number in REQUESTS.items()]
        sound, speaks, ours, holds, filling, finished, inside, opens = (
            Signal(name=name)
            for name in ("sound", "speaks", "ours", "holds", "filling", "finished", "inside", "opens")
        )
        fetch_end = Signal(17)
        has_cameras = int(cameras is not None)
        of_board = index[7]  # a register of the board itself: CAMERAS
        new_chunks_in = field(opening, PAYLOAD["open"], "chunks_in")
        new_words_out = field(opening, PAYLOAD["open"], "words_out")
        state = slots.state[slot]
        self.comb += [
            sound.eq(
                (field(header, HEADER, "magic") == CONSTANTS["MAGIC"])
                & (packets.source.words >= HEADER_WORDS)
            ),
            speaks.eq(field(header, HEADER, "version") == CONSTANTS["VERSION"]),
            ours.eq(speaks & (asked_session == session) & open_now),
            holds.eq(slots.frame[slot] == frame),
            filling.eq(holds & (state == STATES["filling"])),
            finished.eq(holds & (state == STATES["done"])),
            # All chunks that a fetch asks for belong to the frame. Within a comparison Verilog would cut
            # the sum to 16 bits.
            fetch_end.eq(index + count),
            inside.eq((count != 0) & (fetch_end <= chunks_out)),
            # What a session asks for has room.
            opens.eq(
                speaks
                & (has_cameras | (new_chunks_in != 0))
                & ~held
                & (opening[0] == session)
                & (asked_session != session)
                & (new_chunks_in <= CONSTANTS["MAX_CHUNKS_IN"])
                & (new_words_out <= CONSTANTS["MAX_CHUNKS_OUT"] * CHUNK_WORDS)
            ),
            slots.by_server.slot.eq(slot),
        ]

        # Chunks of words are asked for ahead of their packet's header. None of these words is left when a
        # packet has been obeyed: it would come before the words of the next.
        to_read, read_at, on_the_way = Signal(9), Signal(WORDS_OUT_BITS), Signal(10)
        asked_for, taken = Signal(), Signal()
        self.comb += [
            reader.sink.valid.eq((to_read != 0) & ~runner.presses),
            # The check comes last.
            reader.sink.address.eq(
                Mux(to_read == 1, CHECKS_BASE + Cat(chunk[:CHECKS_BITS], slot), Cat(read_at, slot))
            ),
            asked_for.eq(reader.sink.valid & reader.sink.ready),
            taken.eq(reader.source.valid & reader.source.ready),
        ]
        self.sync += [
            If(asked_for, to_read.eq(to_read - 1), read_at.eq(read_at + 1)),
            on_the_way.eq(on_the_way + asked_for - taken),
        ]
        self.left_over = left_over = Signal()
        self.comb += left_over.eq((to_read != 0) | (on_the_way != 0))

        own_header = {
            "kind": reply,
            "version": CONSTANTS["VERSION"],
            "magic": CONSTANTS["MAGIC"],
            "session": session,
            "token": token,
            "frame": frame,
            "index": Mux(reply == REPLIES["words"], chunk, index),
            "count": Mux(reply == REPLIES["words"], CHUNK_WORDS, count),
        }
        status = {
            "credits": CREDITS,
            "cameras": has_cameras,
            "busy": runner.busy,
            "held": held,
            "last_write": last_write,
        }
        for s in range(SLOTS):
            status[f"slot_{s}_frame"] = slots.frame[s]
            status[f"slot_{s}_state"] = slots.state[s]
            status[f"slot_{s}_chunks"] = slots.chunks[s]
        if cameras is not None:
            status |= dict(zip(("refused_left", "refused_right"), cameras.refused, strict=True))
            status |= {"now": cameras.now} | {f"slot_{s}_began": slots.began[s] for s in range(SLOTS)}
        header_word, status_word = Signal(32), Signal(32)
        self.comb += [
            _choose(header_word, position, HEADER, own_header),
            _choose(status_word, position, PAYLOAD["status"], status),
        ]

        descriptor = packets.source
        self.comb += [
            source.ip_address.eq(descriptor.ip_address),
            source.dst_port.eq(descriptor.port),
            source.src_port.eq(CONSTANTS["PORT"]),
            source.last_be.eq(Mux(source.last, LAST_BYTE, 0)),
            Case(
                reply,
                {
                    REPLIES["status"]: source.length.eq(
                        4 * (HEADER_WORDS + wire.PAYLOAD_WORDS["status"] + BITMAP_WORDS)
                    ),
                    REPLIES["words"]: source.length.eq(4 * (PACKET_WORDS + 1)),
                    "default": source.length.eq(Cat(C(0, 2), count + HEADER_WORDS)),
                },
            ),
        ]
        sent = Signal()
        self.comb += sent.eq(source.valid & source.ready)

        def answer(name: str) -> list[Any]:
            return [NextValue(reply, REPLIES[name]), NextValue(position, 0), NextState("HEADER")]

        def fetch(number: Any) -> list[Any]:
            return [
                NextValue(chunk, number),
                NextValue(to_read, CHUNK_WORDS + 1),
                NextValue(read_at, Cat(C(0, 8), number)),
                *answer("words"),
            ]

        self.fsm = fsm = FSM(reset_state="IDLE")
        fsm.act(
            "IDLE",
            NextValue(position, 0),
            packets.address.eq(0),
            If(descriptor.valid & memory.ready, NextState("LOAD")),
        )
        # The words of the header, and of the payload that opens a session.
        loaded = HEADER_WORDS + len(opening)
        fsm.act(
            "LOAD",
            packets.address.eq(position + 1),
            NextValue(position, position + 1),
            Case(
                position,
                {i: NextValue(header[i], packets.data) for i in range(HEADER_WORDS)}
                | {HEADER_WORDS + i: NextValue(opening[i], packets.data) for i in range(len(opening))},
            ),
            If(position == loaded - 1, NextState("DISPATCH")),
        )
        asks = field(header, HEADER, "flags")[0]
        # Nothing happens before the packet was found sound.
        obey = [
            *answer("status"),
            NextValue(done_words, 0),
            If(is_kind["pixels"] & ~asks, NextState("DROP")),
            If(is_kind["open"] & opens & (packets.source.words == loaded), NextState("OPEN")),
            If(is_kind["read"] & speaks & (count <= CHUNK_WORDS), *answer("values")),
            If(
                ours,
                If(
                    is_kind["write"] & (frame == last_write + 1)
                    & (packets.source.words == count + HEADER_WORDS),
                    NextState("WRITE"),
                ),
                If(
                    is_kind["pixels"] & filling & (index < runner.chunks_in)
                    & (packets.source.words == PACKET_WORDS),
                    NextState("LOOK"),
                ),
                If(is_kind["fetch"] & finished & inside, *fetch(index)),
                If(is_kind["close"], NextValue(open_now, 0)),
                If(
                    is_kind["release"] & holds & (state != STATES["full"]) & (state != STATES["running"]),
                    NextValue(position, 0),
                    NextState("RELEASE"),
                ),
            ),
        ]  # fmt: skip
        fsm.act("DISPATCH", heard.eq(sound & from_holder), If(sound, *obey).Else(NextState("DROP")))

        # A session: both slots are emptied, and the reader is.
        fsm.act(
            "OPEN",
            NextValue(session, asked_session),
            NextValue(open_now, 1),
            NextValue(holder_address, descriptor.ip_address),
            NextValue(holder_port, descriptor.port),
            heard.eq(1),
            NextValue(last_write, 0),
            NextValue(runner.width, field(opening, PAYLOAD["open"], "width")),
            NextValue(runner.height, field(opening, PAYLOAD["open"], "height")),
            NextValue(runner.chunks_in, new_chunks_in),
            NextValue(runner.words_out, new_words_out),
            NextValue(chunks_out, (new_words_out + CHUNK_WORDS - 1) >> (CHUNK_WORDS - 1).bit_length()),
            runner.restart.eq(1),
            slots.empty.eq(1),  # before the runner looks again
            NextValue(position, 0),
            NextState("EMPTY"),
        )
        fsm.act(
            "EMPTY",
            slots.row_address.eq(position),
            slots.write.eq(1),
            reader.source.ready.eq(1),
            If(position != SLOTS * BITMAP_WORDS - 1, NextValue(position, position + 1)),
            *(NextValue(slots.frame[s], s) for s in range(SLOTS)),
            *(NextValue(slots.chunks[s], 0) for s in range(SLOTS)),
            slots.empty.eq(1),
            If((position == SLOTS * BITMAP_WORDS - 1) & ~left_over, *answer("status")),
        )
        fsm.act(
            "RELEASE",
            slots.row_address.eq(Cat(position[:BITMAP_BITS], slot)),
            slots.write.eq(1),
            NextValue(position, position + 1),
            If(
                position == BITMAP_WORDS - 1,
                *(
                    If(slot == s, NextValue(slots.frame[s], frame + SLOTS), NextValue(slots.chunks[s], 0))
                    for s in range(SLOTS)
                ),
                slots.by_server.enable.eq(1),
                slots.by_server.state.eq(STATES["filling"]),
                *answer("status"),
            ),
        )

        # Registers.
        fsm.act(
            "WRITE",
            packets.address.eq(HEADER_WORDS + done_words),
            NextState("WRITE_VALUE"),
            If(done_words == count, NextValue(last_write, frame), *answer("status")),
        )
        self.comb += [
            # A write puts all values into one register, a read takes one register after the other.
            engine.address.eq(index[:7] + Mux(is_kind["read"], Cat(C(0, 2), done_words), 0)),
            engine.new_value.eq(packets.data),
        ]
        fsm.act(
            "WRITE_VALUE",
            packets.address.eq(HEADER_WORDS + done_words),
            engine.write.eq(~of_board),
            If(of_board, NextValue(runner.streams, packets.data[0])),
            If(engine.done | of_board, NextValue(done_words, done_words + 1), NextState("WRITE")),
        )

        # Pixels: what came before is not taken again.
        bit = Signal()
        self.comb += bit.eq(Array(slots.row[i] for i in range(32))[index[:5]])
        row_address = Cat(index[5 : 5 + BITMAP_BITS], slot)
        after_pixels = [NextState("DROP"), If(asks, *answer("status"))]
        fsm.act(
            "LOOK",
            slots.row_address.eq(row_address),
            packets.address.eq(HEADER_WORDS),
            NextValue(position, 0),
            NextState("STORE"),
        )
        next_position = Signal(10)
        fsm.act(
            "STORE",
            slots.row_address.eq(row_address),
            next_position.eq(position + writer.sink.ready),
            packets.address.eq(HEADER_WORDS + next_position),
            NextValue(position, next_position),
            writer.sink.valid.eq(~bit),
            writer.sink.address.eq(PIXELS_BASE + Cat(C(0, 8), index[: PIXELS_BITS - 8], slot) + position),
            writer.sink.data.eq(packets.data),
            If((position == CHUNK_WORDS - 1) & writer.sink.ready, NextState("STORED")),
            If(bit, *after_pixels),
        )
        # The last chunk makes the frame whole, and it is read at once.
        fsm.act("STORED", slots.row_address.eq(row_address), If(writer.idle, NextState("MARK")))
        now_full = Signal()
        self.comb += now_full.eq(slots.chunks[slot] + 1 == runner.chunks_in)
        fsm.act(
            "MARK",
            slots.row_address.eq(row_address),
            slots.write.eq(1),
            slots.new_row.eq(slots.row | (1 << index[:5])),
            *(If(slot == s, NextValue(slots.chunks[s], slots.chunks[s] + 1)) for s in range(SLOTS)),
            slots.by_server.enable.eq(now_full),
            slots.by_server.state.eq(STATES["full"]),
            *after_pixels,
        )

        # Replies.
        fsm.act(
            "HEADER",
            source.valid.eq(1),
            source.data.eq(header_word),
            source.last.eq((position == HEADER_WORDS - 1) & (reply == REPLIES["values"]) & (count == 0)),
            If(
                sent,
                NextValue(position, position + 1),
                If(
                    position == HEADER_WORDS - 1,
                    NextValue(position, 0),
                    Case(
                        reply,
                        {
                            REPLIES["status"]: NextState("STATUS"),
                            REPLIES["words"]: NextState("WORDS"),
                            "default": NextState("READ"),
                        },
                    ),
                    If(source.last, NextState("DROP")),
                ),
            ),
        )
        fsm.act(
            "STATUS",
            source.valid.eq(1),
            source.data.eq(status_word),
            slots.row_address.eq(Cat(C(0, BITMAP_BITS), slot)),
            If(
                sent,
                NextValue(position, position + 1),
                If(position == wire.PAYLOAD_WORDS["status"] - 1, NextValue(position, 0), NextState("BITMAP")),
            ),
        )
        next_row = Signal(BITMAP_BITS)
        fsm.act(
            "BITMAP",
            source.valid.eq(1),
            source.data.eq(slots.row),
            source.last.eq(position == BITMAP_WORDS - 1),
            next_row.eq(position + sent),
            slots.row_address.eq(Cat(next_row, slot)),
            If(sent, NextValue(position, position + 1), If(source.last, NextState("DROP"))),
        )
        fsm.act(
            "READ",
            engine.read.eq(1),
            If(engine.done, NextValue(opening[0], engine.value), NextState("VALUE")),
        )
        fsm.act(
            "VALUE",
            source.valid.eq(1),
            source.data.eq(opening[0]),
            source.last.eq(done_words == count - 1),
            If(
                sent,
                NextValue(done_words, done_words + 1),
                NextState("READ"),
                If(source.last, NextState("DROP")),
            ),
        )
        fsm.act(
            "WORDS",
            source.valid.eq(reader.source.valid),
            source.data.eq(reader.source.data),
            source.last.eq(position == CHUNK_WORDS),
            reader.source.ready.eq(source.ready),
            If(
                sent,
                NextValue(position, position + 1),
                If(
                    source.last,
                    If(chunk + 1 == index + count, NextState("DROP")).Else(*fetch(chunk + 1)),
                ),
            ),
        )
        fsm.act("DROP", descriptor.ready.eq(1), NextState("IDLE"))


def _choose(target: Any, position: Any, layout: dict[str, wire.Field], values: dict[str, Any]) -> Case:
    """Puts the words of these fields, one after the other, on a signal."""
    words: dict[Any, list[Any]] = {}
    for name, value in values.items():
        f = layout[name]
        words.setdefault(f.word, []).append(target[f.low : f.low + f.bits].eq(value))
    return Case(position, words)
