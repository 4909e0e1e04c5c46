"""A board in software on a UDP port of the loopback interface, whose link drops and doubles packets.

It speaks the protocol of rtl/board/wire.toml and takes the words from the C model.
"""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
import wire
from board_engine import EngineModel

CHUNK_BYTES, SLOTS = wire.CONSTANTS["CHUNK_BYTES"], wire.CONSTANTS["SLOTS"]


@dataclass
class Link:
    """What the cable does to packets, of both directions: each is dropped or comes twice by chance, the
    second time at once or after up to `delay` others."""

    rng: np.random.Generator
    drop: float = 0.0
    double: float = 0.0
    delay: int = 40
    pulled: bool = False
    pulled_after: int | None = None  # so many packets
    packets: int = 0
    _late: list[tuple[int, bytes]] = field(default_factory=list)

    def carry(self, packet: bytes) -> list[bytes]:
        self.packets += 1
        if self.pulled_after is not None and self.packets > self.pulled_after:
            self.pulled, self.pulled_after = True, None
        if self.pulled:
            self._late.clear()
            return []
        due = [late for when, late in self._late if when <= self.packets]
        self._late = [(when, late) for when, late in self._late if when > self.packets]
        if self.rng.random() < self.double:
            self._late.append((self.packets + int(self.rng.integers(0, self.delay + 1)), packet))
        return due + ([] if self.rng.random() < self.drop else [packet])


@dataclass
class Slot:
    frame: int
    state: int = wire.STATES["filling"]
    chunks: dict[int, bytes] = field(default_factory=dict)
    stream: bytes = b""
    done_at: float = 0.0


class BoardModel:
    """credits: packets on the way. matching_s: how long a frame is matched. `overruns` counts pixels beyond
    the credits, `foreign` pixels of frames that no slot waits for."""

    def __init__(self, engine: EngineModel, to_board: Link, to_host: Link, credits: int = 16) -> None:
        self.engine, self.to_board, self.to_host, self.credits = engine, to_board, to_host, credits
        self.matching_s = 0.0
        self.fails = False  # the engine gives no words
        self.version = wire.CONSTANTS["VERSION"]
        self.hold_s = wire.CONSTANTS["HOLD_MS"] / 1000
        self.mixed_up = 0  # chunks that are sent with the words of another
        self.overruns = self.foreign = 0
        self.cameras = 1
        # Pairs that its cameras show, one with each status; an empty one is a frame that found no partner.
        self.shown: list[bytes] = []
        self.refused = 0
        self.began_ns: dict[int, int] = {}  # when each was shown, on time.monotonic_ns()
        self.began_us: dict[int, int] = {}  # the same on the clock of the board
        self.reset_ns = time.monotonic_ns()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.02)
        self.port: int = self.socket.getsockname()[1]
        self.restart()

    def restart(self) -> None:
        self.holder: tuple[str, int] | None = None
        self.heard_at = 0.0
        self.session = self.last_write = 0
        self.status_token = 0
        self.opened = {"width": 0, "height": 0, "chunks_in": 0, "words_out": 0}
        self.slots = [Slot(i) for i in range(SLOTS)]
        self.streams, self.next_pair = False, 0

    def serve(self, stop: threading.Event) -> None:
        while not stop.is_set():
            try:
                data, self.client = self.socket.recvfrom(2048)
            except TimeoutError:
                continue
            for packet in self.to_board.carry(data):
                self._obey(packet)

    def _obey(self, data: bytes) -> None:
        if self.client == self.holder:
            self.heard_at = time.monotonic()
        header, body = wire.parse(data)
        assert header["magic"] == wire.CONSTANTS["MAGIC"]
        kind, token = header["kind"], header["token"]
        name = next(name for name, number in wire.REQUESTS.items() if number == kind)
        of_any_session = name in ("status", "open", "read")
        if not of_any_session and (header["session"] != self.session or self.holder is None):
            name = "status" if name != "pixels" or header["flags"] & 1 else "nothing"
        getattr(self, f"_{name}", lambda *_: None)(header, body)
        if name in ("status", "open", "write", "release", "close") or (
            name == "pixels" and header["flags"] & 1
        ):
            self._status({}, b"", token=token, frame=header["frame"])

    def _reply(self, name: str, body: bytes, **header: int) -> None:
        own = {"kind": wire.REPLIES[name], "session": self.session, "version": self.version}
        for packet in self.to_host.carry(wire.packet(own | header, body)):
            self.socket.sendto(packet, self.client)

    def _status(self, _header: dict[str, int], _body: bytes, token: int = -1, frame: int = 0) -> None:
        if token < 0:  # the request; answered by _obey
            return
        self._finish()
        self.status_token = max(self.status_token, token)
        if self.streams and self.shown:
            self._take_pair(self.shown.pop(0))
        values = {"credits": self.credits, "cameras": self.cameras, "last_write": self.last_write}
        values["refused_left"] = self.refused & 0xFFFF
        values["now"] = self._time_us(time.monotonic_ns())
        values["held"] = self._held()
        values["busy"] = any(slot.state == wire.STATES["running"] for slot in self.slots)
        for i, slot in enumerate(self.slots):
            values[f"slot_{i}_frame"] = slot.frame
            values[f"slot_{i}_state"] = slot.state
            values[f"slot_{i}_chunks"] = len(slot.chunks)
            values[f"slot_{i}_began"] = self.began_us.get(slot.frame, 0)
        bitmap = [0] * wire.BITMAP_WORDS
        for chunk in self.slots[frame % SLOTS].chunks:
            bitmap[chunk // 32] |= 1 << chunk % 32
        body = wire.to_bytes([*wire.payload("status", values), *bitmap])
        self._reply("status", body, token=token, frame=frame)

    def _time_us(self, now_ns: int) -> int:
        return (now_ns - self.reset_ns) // 1000 & 0xFFFFFFFF

    def _held(self) -> bool:
        """Whether another client than the one that speaks holds the board."""
        return self.holder not in (None, self.client) and time.monotonic() - self.heard_at < self.hold_s

    def _open(self, header: dict[str, int], body: bytes) -> None:
        wanted = wire.parse_payload("open", body)
        if header["session"] != self.session and wanted["previous"] == self.session and not self._held():
            self.restart()
            self.session, self.opened = header["session"], wanted
            self.holder, self.heard_at = self.client, time.monotonic()

    def _close(self, _header: dict[str, int], _body: bytes) -> None:
        self.holder = None

    def _write(self, header: dict[str, int], body: bytes) -> None:
        if header["frame"] != self.last_write + 1:
            return
        self.last_write += 1
        for value in np.frombuffer(body, "<u4", header["count"]):
            if header["index"] == wire.CONSTANTS["CAMERAS"]:
                self.streams = bool(value)
            else:
                self.engine.write(header["index"], int(value))

    def _read(self, header: dict[str, int], _body: bytes) -> None:
        addresses = range(header["index"], header["index"] + 4 * header["count"], 4)
        body = wire.to_bytes([self.engine.read(address) for address in addresses])
        place = {"index": header["index"], "count": header["count"]}
        self._reply("values", body, token=header["token"], **place)

    def _pixels(self, header: dict[str, int], body: bytes) -> None:
        assert len(body) == CHUNK_BYTES
        self.overruns += header["token"] - self.status_token > self.credits
        slot = self.slots[header["frame"] % SLOTS]
        self.foreign += slot.frame != header["frame"]
        if slot.frame != header["frame"] or slot.state != wire.STATES["filling"]:
            return
        slot.chunks.setdefault(header["index"], body)
        if len(slot.chunks) == self.opened["chunks_in"]:
            pixels = b"".join(slot.chunks[i] for i in range(self.opened["chunks_in"]))
            slot.stream = self.engine.stream(pixels)
            assert len(slot.stream) == 4 * self.opened["words_out"]
            slot.state, slot.done_at = wire.STATES["running"], time.monotonic() + self.matching_s

    def _take_pair(self, pixels: bytes) -> None:
        if not pixels:
            self.refused += 1
            return
        self.began_ns[self.next_pair] = now_ns = time.monotonic_ns()
        self.began_us[self.next_pair] = self._time_us(now_ns)
        slot = self.slots[self.next_pair % SLOTS]
        if slot.state == wire.STATES["filling"]:
            slot.frame, slot.stream = self.next_pair, self.engine.stream(pixels)
            slot.state, slot.done_at = wire.STATES["running"], time.monotonic() + self.matching_s
        self.next_pair += 1

    def _finish(self) -> None:
        for slot in self.slots:
            if slot.state == wire.STATES["running"] and time.monotonic() >= slot.done_at:
                slot.state = wire.STATES["failed" if self.fails else "done"]

    def _fetch(self, header: dict[str, int], _body: bytes) -> None:
        self._finish()
        slot = self.slots[header["frame"] % SLOTS]
        if slot.frame != header["frame"] or slot.state != wire.STATES["done"]:
            self._status({}, b"", token=header["token"], frame=header["frame"])
            return
        for chunk in range(header["index"], header["index"] + header["count"]):
            words = slot.stream[CHUNK_BYTES * chunk : CHUNK_BYTES * (chunk + 1)]
            check = wire.check_of(words, self.session, header["frame"], chunk)
            if self.mixed_up > 0:
                self.mixed_up -= 1
                words = words[4:] + words[:4]
            body = words.ljust(CHUNK_BYTES, b"\xa5") + wire.to_bytes([check])
            place = {"frame": header["frame"], "index": chunk, "count": wire.CHUNK_WORDS}
            self._reply("words", body, token=header["token"], **place)

    def _release(self, header: dict[str, int], _body: bytes) -> None:
        self._finish()
        index = header["frame"] % SLOTS
        held = [wire.STATES["full"], wire.STATES["running"]]
        if self.slots[index].frame == header["frame"] and self.slots[index].state not in held:
            self.slots[index] = Slot(header["frame"] + SLOTS)


@contextmanager
def running(board: BoardModel) -> Iterator[BoardModel]:
    """Serves until the end of the block; raises what went wrong in the board."""
    stop, errors = threading.Event(), []

    def serve() -> None:
        try:
            board.serve(stop)
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield board
    finally:
        stop.set()
        thread.join()
        board.socket.close()
    if errors:
        raise errors[0]
