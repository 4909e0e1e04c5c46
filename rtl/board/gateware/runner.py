# SPDX-License-Identifier: Apache-2.0
"""Takes whole frames from memory, or from the cameras, through the engine, and their words to memory."""

from __future__ import annotations

from typing import Any

from litex.gen import LiteXModule
from migen import FSM, C, Cat, If, Mux, NextState, NextValue, Signal
from wire import CHUNK_WORDS

from gateware.cameras import Cameras
from gateware.memory import (
    CHECKS_BASE,
    CHECKS_BITS,
    PIXELS_BASE,
    PIXELS_BITS,
    WORDS_OUT_BITS,
    BurstWriter,
    Reader,
)
from gateware.slots import STATES, Slots

READ_AHEAD = 64  # words
CHUNK_BITS = (CHUNK_WORDS - 1).bit_length()


class Runner(LiteXModule):
    """One frame at a time; beside its words, the check of each chunk of them goes to memory. session, width,
    height, chunks_in, words_out: of the session. `restart`, for a clock, begins a session: the frame that is
    being matched is finished, and counts for nothing; `busy` tells that one is being matched.

    In a session without chunks of pixels, pair n of the cameras goes to slot n modulo SLOTS while `streams`,
    if that slot waits for one, and is lost otherwise. So is a pair that was not whole: its slot waits again.

    If the engine stops for 2**patience_bits clocks, the frame fails, and so do all others until `restart`:
    what is left in the engine would come before their words."""

    def __init__(
        self, memory: Any, slots: Slots, engine: Any, patience_bits: int, cameras: Cameras | None = None
    ) -> None:
        self.session, self.width, self.height = Signal(32), Signal(16), Signal(16)
        self.chunks_in, self.words_out = Signal(16), Signal(32)
        self.restart, self.busy, self.streams = Signal(), Signal(), Signal()
        self.presses = Signal()  # words have to go, or pixels of the cameras are lost
        # Those of the frame on its way, which may be one of the session before.
        session = {name: getattr(self, name) for name in ("width", "height", "chunks_in", "words_out")}
        own = {name: Signal.like(value, name=f"own_{name}") for name, value in session.items()}

        self.reader = reader = Reader(memory, READ_AHEAD, fifo_buffered=True)
        self.writer = writer = BurstWriter(memory)
        slot, next_slot, abandoned, stuck = Signal(), Signal(), Signal(), Signal()
        asked, came, wanted = (Signal(PIXELS_BITS + 1, name=name) for name in ("asked", "came", "wanted"))
        stored = Signal(WORDS_OUT_BITS + 1)
        column, row, half, drain = Signal(16), Signal(16), Signal(), Signal()
        patience = Signal(patience_bits)
        running = Signal()
        check, seed = Signal(32), Signal(32)
        chunk, check_waits = Signal(CHECKS_BITS), Signal()  # chunk: whose check it is

        live, of_cameras, broken = Signal(), Signal(), Signal()  # of_cameras: this frame is
        pair, has_room = Signal(32), Signal()  # the next pair of the cameras

        stores, chunk_ends = Signal(), Signal()
        pixel, last_column, last_row, all_sent = Signal(), Signal(), Signal(), Signal()
        self.comb += [
            wanted.eq(Cat(C(0, 8), own["chunks_in"])),
            last_column.eq(column == own["width"] - 1),
            last_row.eq(row == own["height"] - 1),
            all_sent.eq((row == own["height"]) | drain),
            # Two pixels to a word, until all are sent; the filling of the last chunk is dropped.
            engine.pixels.valid.eq(running & reader.source.valid & ~all_sent),
            If(half, engine.pixels.data.eq(reader.source.data[16:])).Else(
                engine.pixels.data.eq(reader.source.data[:16])
            ),
            engine.pixels.first.eq((row == 0) & (column == 0)),
            engine.pixels.last.eq(last_column),
            pixel.eq(engine.pixels.valid & engine.pixels.ready),
            reader.source.ready.eq(running & (all_sent | (pixel & (half | (last_row & last_column))))),
            reader.sink.valid.eq(running & (asked != wanted)),
            reader.sink.address.eq(PIXELS_BASE + (slot << PIXELS_BITS) + asked),
            # Words beyond those of a frame are dropped.
            stores.eq(running & engine.words.valid & (stored != own["words_out"]) & ~check_waits),
            writer.sink.valid.eq(stores | (running & check_waits)),
            If(
                check_waits,
                writer.sink.address.eq(CHECKS_BASE + Cat(chunk, slot)),
                writer.sink.data.eq(check),
            ).Else(
                writer.sink.address.eq((slot << WORDS_OUT_BITS) + stored),
                writer.sink.data.eq(engine.words.data),
            ),
            engine.words.ready.eq(
                (writer.sink.ready & ~check_waits) | ~running | (stored == own["words_out"])
            ),
            writer.flush.eq(~running | ((stored == own["words_out"]) & ~check_waits)),
            chunk_ends.eq((stored[:CHUNK_BITS] == 2**CHUNK_BITS - 1) | (stored + 1 == own["words_out"])),
        ]
        self.sync += [
            If(reader.sink.valid & reader.sink.ready, asked.eq(asked + 1)),
            If(reader.source.valid & reader.source.ready, came.eq(came + 1), half.eq(0)),
            If(
                pixel,
                If(~reader.source.ready, half.eq(1)),
                column.eq(column + 1),
                If(last_column, column.eq(0), row.eq(row + 1)),
            ),
            If(
                stores & writer.sink.ready,
                stored.eq(stored + 1),
                check.eq(Cat(check[31], check[:31]) + engine.words.data),
                check_waits.eq(chunk_ends),
            ).Elif(
                check_waits & writer.sink.ready,
                check_waits.eq(0),
                chunk.eq(chunk + 1),
                check.eq(seed ^ Cat(C(0, 16), (chunk + 1)[:CHECKS_BITS])),
            ),
            If(
                ~running | pixel | (engine.words.valid & engine.words.ready),
                patience.eq(0),
            ).Else(patience.eq(patience + 1)),
            If(self.restart, abandoned.eq(1), stuck.eq(0), pair.eq(0), self.streams.eq(0)),
        ]

        change = slots.by_runner
        self.comb += [
            change.slot.eq(Mux(self.busy, slot, Mux(live, pair[0], next_slot))),
            slots.number.eq(pair),
            has_room.eq(slots.state[pair[0]] == STATES["filling"]),
        ]
        if cameras is not None:
            self.comb += [
                live.eq(self.streams & (self.chunks_in == 0)),
                of_cameras.eq(own["chunks_in"] == 0),
                broken.eq(cameras.broken),
                self.presses.eq(writer.bursts & of_cameras),
                cameras.clear.eq(~self.busy),
                cameras.wanted.eq(running & of_cameras & ~all_sent),
                cameras.first.eq(engine.pixels.first),
                cameras.last.eq(engine.pixels.last),
                cameras.silent.eq(patience[-1]),
                cameras.restart.eq(self.restart),
                cameras.drop.eq(~live | (~self.busy & ~has_room)),
                cameras.pixels.ready.eq(engine.pixels.ready),
                slots.time.eq(cameras.began),
                If(
                    of_cameras,
                    engine.pixels.valid.eq(cameras.pixels.valid),
                    engine.pixels.data.eq(cameras.pixels.data),
                ),
            ]
        begin = [
            NextValue(pair, pair + 1),
            If(
                has_room,
                change.enable.eq(1),
                change.state.eq(STATES["running"]),
                slots.renumber.eq(1),
                NextValue(slot, pair[0]),
                NextValue(seed, self.session ^ pair),
                NextValue(check, self.session ^ pair),
                NextState("RUN"),
            ),
        ]
        self.fsm = fsm = FSM(reset_state="IDLE")
        fsm.act(
            "IDLE",
            NextValue(abandoned, 0),
            *(NextValue(own[name], value) for name, value in session.items()),
            NextValue(next_slot, ~next_slot),
            NextValue(slot, next_slot),
            *(
                NextValue(counter, 0)
                for counter in (asked, came, stored, chunk, check_waits, column, row, half, drain)
            ),
            NextValue(seed, self.session ^ slots.frame[next_slot]),
            NextValue(check, self.session ^ slots.frame[next_slot]),
            If(
                ~self.restart & (slots.state[next_slot] == STATES["full"]),
                change.enable.eq(1),
                change.state.eq(STATES["running"]),
                NextState("RUN"),
            ),
            *([] if cameras is None else [If(~self.restart & live & cameras.begins, *begin)]),
        )
        fsm.act(
            "RUN",
            running.eq(1),
            self.busy.eq(1),
            If(
                (stored == own["words_out"]) & ~check_waits & (came == wanted) & writer.idle,
                NextState("FINISH"),
            ),
            If(
                (patience == 2**patience_bits - 1) | stuck,
                NextValue(stuck, 1),
                NextValue(drain, 1),
                NextState("DRAIN"),
            ),
        )
        fsm.act("DRAIN", running.eq(1), self.busy.eq(1), If(came == wanted, NextState("FINISH")))
        fsm.act(
            "FINISH",
            self.busy.eq(1),
            If(
                ~abandoned & ~self.restart,
                change.enable.eq(1),
                change.state.eq(STATES["done"]),
                If(broken, change.state.eq(STATES["filling"])),
                If(drain, change.state.eq(STATES["failed"])),
            ),
            # The client of a new session waits for this end, and then resets the engine.
            If(abandoned, NextValue(stuck, 0)),
            NextState("IDLE"),
        )
