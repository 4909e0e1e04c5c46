# SPDX-License-Identifier: Apache-2.0
"""The frames that a board holds: which, in what state, and which chunks of their pixels have come."""

from __future__ import annotations

import wire
from litex.gen import LiteXModule
from migen import Array, If, Memory, Signal

SLOTS = wire.CONSTANTS["SLOTS"]
STATES = wire.STATES
BITMAP_BITS = wire.BITMAP_WORDS.bit_length() - 1


class Change:
    """Puts a slot into a state at the end of the clock in which `enable` is up."""

    def __init__(self) -> None:
        self.enable, self.slot, self.state = Signal(), Signal(), Signal(3)


class Slots(LiteXModule):
    """frame, state, chunks: of each slot; began: the time of the pair of the cameras in it. The bitmaps lie
    in one memory, of which `row` is read a clock after `row_address`, {slot, word}, and `new_row` written
    while `write` is up."""

    def __init__(self) -> None:
        self.frame = Array(Signal(32, reset=s, name=f"frame_{s}") for s in range(SLOTS))
        self.state = Array(Signal(3, name=f"state_{s}") for s in range(SLOTS))
        self.chunks = Array(Signal(16, name=f"chunks_{s}") for s in range(SLOTS))
        self.began = Array(Signal(32, name=f"began_{s}") for s in range(SLOTS))

        self.by_runner, self.by_server = Change(), Change()
        for change in (self.by_runner, self.by_server):
            self.sync += If(change.enable, self.state[change.slot].eq(change.state))

        # Gives the runner's slot this frame.
        self.renumber, self.number, self.time = Signal(), Signal(32), Signal(32)
        self.sync += If(
            self.renumber,
            self.frame[self.by_runner.slot].eq(self.number),
            self.began[self.by_runner.slot].eq(self.time),
        )

        self.empty = Signal()  # puts all slots into the first state
        self.sync += If(self.empty, *(state.eq(STATES["filling"]) for state in self.state))

        self.row_address = Signal(BITMAP_BITS + 1)
        self.row = Signal(32)
        self.write = Signal()  # new_row at row_address
        self.new_row = Signal(32)
        memory = Memory(32, SLOTS << BITMAP_BITS)
        port = memory.get_port(write_capable=True)
        self.specials += memory, port
        self.comb += [
            port.adr.eq(self.row_address),
            self.row.eq(port.dat_r),
            port.we.eq(self.write),
            port.dat_w.eq(self.new_row),
        ]
