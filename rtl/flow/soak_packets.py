# SPDX-License-Identifier: Apache-2.0
"""Sends packets that a board must not obey to its Verilated server, with frames between: make soak-packets.

Server, runner, slots and buffer of packets are those of the board; memory and engine are plain ones
(rtl/board/gateware/server_alone.py), whose words follow from the pixels. Bursts come before, between and
after the packets of each frame, in part from the client's own address. Afterwards every answer, word and
check has to be right, and a register has what the client wrote.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random

import numpy as np
import numpy.typing as npt

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "rtl" / "board"), str(ROOT / "scripts"), str(ROOT / "tb" / "common")]
import wire  # noqa: E402
from hostile_packets import Known, hostile_packets  # noqa: E402
from make_tables import as_text  # noqa: E402
from tools import digest_of  # noqa: E402

LIBRARY = ROOT / "build" / "board" / "server" / "libserver.so"
CHUNK_PIXELS = 2 * wire.CHUNK_WORDS
CLIENT = (0xC0A80102, 50000)  # address and port
BURST = 45  # packets at most
CLIENT_SHARE = 0.3  # of the packets, from the address of the client
FRAMES_EACH_SESSION = 8
REGISTER = 16  # that the client writes and reads
WAIT_CLOCKS, MOST_WAITS = 500, 100  # for a frame
LARGEST_REPLY = 2048


class WrongAnswerError(Exception):
    """The server hangs, or says what it must not."""


@dataclass
class Totals:
    packets: int = 0  # that must not be obeyed
    frames: int = 0
    words: int = 0  # compared
    clocks: int = 0
    seconds: float = 0.0


class Server:
    """The Verilated server, with packets from anybody."""

    def __init__(self, library: Path) -> None:
        self.lib = ctypes.CDLL(str(library))
        self.lib.server_create.restype = ctypes.c_void_p
        self.lib.server_clocks.restype = self.lib.server_ask.restype = ctypes.c_int64
        self.handle = ctypes.c_void_p(self.lib.server_create())

    def close(self) -> None:
        self.lib.server_destroy(self.handle)

    def clocks(self) -> int:
        return int(self.lib.server_clocks(self.handle))

    def wait(self, clocks: int) -> None:
        self.lib.server_wait(self.handle, ctypes.c_int64(clocks))

    def send(self, packets: list[bytes], senders: list[tuple[int, int]]) -> None:
        sizes = np.array([len(packet) for packet in packets], np.uint32)
        addresses = np.array([address for address, _ in senders], np.uint32)
        ports = np.array([port for _, port in senders], np.uint16)
        pointers = (ctypes.c_void_p(array.ctypes.data) for array in (sizes, addresses, ports))
        if not self.lib.server_send(self.handle, b"".join(packets), *pointers, ctypes.c_int64(len(packets))):
            raise WrongAnswerError("the server hangs")

    def ask(self, packet: bytes) -> bytes:
        reply = ctypes.create_string_buffer(LARGEST_REPLY)
        address, port = CLIENT
        size = self.lib.server_ask(
            self.handle, packet, ctypes.c_uint32(len(packet)), ctypes.c_uint32(address),
            ctypes.c_uint16(port), reply,
        )  # fmt: skip
        if size < 0:
            raise WrongAnswerError("the server hangs")
        return reply.raw[:size]


class Client:
    """One session after the other, with packets that must not be obeyed between its own."""

    def __init__(self, server: Server, seed: int, totals: Totals) -> None:
        self.server, self.totals = server, totals
        self.random, self.rng = Random(seed), np.random.default_rng(seed)
        self.session = self.token = 0
        self.known = Known(0, 0, 0, 1, 1)

    def ask(self, kind: str, answer: str, body: bytes = b"", **header: int) -> tuple[dict[str, int], bytes]:
        self.token += 1
        own = {"kind": wire.REQUESTS[kind], "session": self.session, "token": self.token} | header
        reply = self.server.ask(wire.packet(own, body))
        if not reply:
            raise WrongAnswerError(f"no answer to a {kind}")
        found, content = wire.parse(reply)
        if (found["kind"], found["session"], found["token"]) != (
            wire.REPLIES[answer], self.session, self.token,
        ):  # fmt: skip
            raise WrongAnswerError(f"a {kind} is answered with {found}")
        return found, content

    def status(self, kind: str, body: bytes = b"", **header: int) -> dict[str, int]:
        return wire.parse_payload("status", self.ask(kind, "status", body, **header)[1])

    def disturb(self) -> None:
        packets = hostile_packets(self.random, self.known)
        burst = [next(packets) for _ in range(self.random.randrange(BURST))]
        others = (self.random.getrandbits(32), self.random.getrandbits(16))
        self.server.send(burst, [CLIENT if self.random.random() < CLIENT_SHARE else others for _ in burst])
        self.totals.packets += len(burst)

    def run_session(self) -> None:
        width, height = (self.random.randrange(4, 41) for _ in range(2))
        chunks_in, chunks_out = -(-width * height // CHUNK_PIXELS), -(-width * height // wire.CHUNK_WORDS)
        opening = {"previous": self.session, "width": width, "height": height}
        opening |= {"chunks_in": chunks_in, "words_out": width * height}
        self.session = self.session ^ self.random.randrange(1, 1 << 32) or 1
        status = self.status("open", wire.to_bytes(wire.payload("open", opening)))
        expect(
            "slots of a new session", [status[f"slot_{s}_{what}"] for s in (0, 1) for what in WHAT], OPENED
        )
        for frame in range(FRAMES_EACH_SESSION):
            value = self.random.getrandbits(32)
            self.known = Known(self.session, frame, frame, chunks_in, chunks_out)
            self.disturb()
            written = self.status("write", wire.to_bytes([value]), frame=frame + 1, index=REGISTER, count=1)
            expect("last write", written["last_write"], frame + 1)
            self.known = Known(self.session, frame, frame + 1, chunks_in, chunks_out)
            self.run_frame(frame, self.rng.integers(0, 1 << 16, (height, width), np.uint16))
            _, content = self.ask("read", "values", index=REGISTER, count=1)
            expect("the register", content, wire.to_bytes([value]))

    def run_frame(self, frame: int, pixels: npt.NDArray[np.uint16]) -> None:
        chunks = list(chunks_of(pixels.astype("<u2").tobytes()))
        for index, chunk in enumerate(chunks):
            self.disturb()
            status = self.status("pixels", chunk, flags=1, frame=frame, index=index)
            state, last = status[f"slot_{frame % 2}_state"], index == len(chunks) - 1
            expect("chunks", status[f"slot_{frame % 2}_chunks"], index + 1)
            expect("filling", state == wire.STATES["filling"], not last)
        self.disturb()
        expect("state", self.state_after_the_run(frame), wire.STATES["done"])
        words = np.cumsum(pixels.ravel(), dtype=np.uint64) + np.arange(1, pixels.size + 1, dtype=np.uint64)
        for index, chunk in enumerate(chunks_of(words.astype("<u4").tobytes())):
            self.disturb()
            header, content = self.ask("fetch", "words", frame=frame, index=index, count=1)
            expect("frame and chunk", (header["frame"], header["index"]), (frame, index))
            own = chunk[: 4 * max(0, min(wire.CHUNK_WORDS, pixels.size - index * wire.CHUNK_WORDS))]
            expect("words", content[: len(own)], own)
            check = wire.check_of(own, self.session, frame, index)
            expect("check", content[-4:], wire.to_bytes([check]))
            self.totals.words += len(own) // 4
        self.status("release", frame=frame)
        self.totals.frames += 1

    def state_after_the_run(self, frame: int) -> int:
        state = wire.STATES["full"]
        for _ in range(MOST_WAITS):
            state = self.status("status", frame=frame)[f"slot_{frame % 2}_state"]
            if state not in (wire.STATES["full"], wire.STATES["running"]):
                break
            self.server.wait(WAIT_CLOCKS)
        return state


WHAT = ("frame", "state", "chunks")
OPENED = [0, wire.STATES["filling"], 0, 1, wire.STATES["filling"], 0]


def expect(what: str, found: object, wanted: object) -> None:
    if found != wanted:
        raise WrongAnswerError(f"{what}: {found!r} for {wanted!r}")


def chunks_of(data: bytes) -> Iterator[bytes]:
    """Chunks, of which the last is filled up."""
    size = wire.CONSTANTS["CHUNK_BYTES"]
    for begin in range(0, len(data), size):
        yield data[begin : begin + size].ljust(size, b"\xa5")


def run(library: Path, packets: int, seed: int) -> Totals:
    """Raises WrongAnswerError with the first thing that is wrong."""
    totals = Totals()
    server = Server(library)
    client = Client(server, seed, totals)
    begin, told = time.monotonic(), 0
    try:
        while totals.packets < packets:
            client.run_session()
            totals.clocks, totals.seconds = server.clocks(), round(time.monotonic() - begin, 1)
            if totals.packets - told >= 250_000:
                told = totals.packets
                print(totals, file=sys.stderr, flush=True)
    finally:
        server.close()
    return totals


def table_of(runs: dict[str, dict[str, float]]) -> dict[str, object]:
    def total(name: str) -> int:
        return int(sum(run[name] for run in runs.values()))

    numbers = {
        "packets that must not be obeyed": total("packets"),
        "frames between them": total("frames"),
        "words compared": total("words"),
        "wrong words, answers or registers": 0,
        "clocks of the server": total("clocks"),
        "seconds": total("seconds"),
    }
    rows = [[name, f"{number:,}"] for name, number in numbers.items()]
    return {"name": "board-packets", "heads": ["against the Verilated server", "count"], "rows": rows}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--packets", type=int, default=100_000, help="that must not be obeyed (100000)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "board" / "packets.json")
    args = parser.parse_args()
    try:
        found = run(LIBRARY, args.packets, args.seed)
    except WrongAnswerError as error:
        sys.exit(f"soak_packets: {error}")
    runs = earlier_runs(args.out) | {str(args.seed): asdict(found)}
    figures = {"library": digest_of([LIBRARY]), "runs": runs}
    content = {"tables": [table_of(runs)], "figures": figures}
    args.out.write_text(as_text(content) + "\n")
    print(as_text(asdict(found)))


def earlier_runs(path: Path) -> dict[str, dict[str, float]]:
    """Those of this server with other seeds, each in a run of its own."""
    if not path.is_file():
        return {}
    figures = json.loads(path.read_text())["figures"]
    return figures["runs"] if figures["library"] == digest_of([LIBRARY]) else {}


if __name__ == "__main__":
    main()
