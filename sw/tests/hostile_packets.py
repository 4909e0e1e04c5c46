"""Packets that a board must not obey, drawn at random, for a board with a session of somebody else.

Each is a request that differs from a sound one in its magic, its version, its session, its length, or in a
number beyond the frame. Sent between the packets of a client, none may change a word of its frames.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import wire

KINDS = list(wire.REQUESTS.values())
MOST_BYTES = 4 * (wire.HEADER_WORDS + wire.CHUNK_WORDS)


@dataclass(frozen=True)
class Known:
    """What somebody who overhears the link knows of the session."""

    session: int
    frame: int  # that the client is at
    last_write: int
    chunks_in: int
    chunks_out: int


def hostile_packets(rng: np.random.Generator, known: Known) -> Iterator[bytes]:
    while True:
        yield FLAWS[rng.integers(len(FLAWS))](rng, known)


def request(rng: np.random.Generator, known: Known, **changed: int) -> bytes:
    """A request that would be obeyed, but for the fields that are given."""
    kind = int(rng.choice(KINDS))
    write = kind == wire.REQUESTS["write"]
    count = int(rng.integers(1, 4))
    header = {
        "kind": kind,
        "flags": int(rng.integers(2)),
        "session": known.session,
        "token": int(rng.integers(1 << 32)),
        "frame": known.last_write + 1 if write else known.frame + int(rng.integers(-2, 3)) & 0xFFFFFFFF,
        "index": 4 * int(rng.integers(32)) if write else int(rng.integers(known.chunks_out)),
        "count": count,
    } | changed
    kind = header["kind"]
    words = {
        wire.REQUESTS["write"]: count,
        wire.REQUESTS["pixels"]: wire.CHUNK_WORDS,
        wire.REQUESTS["open"]: wire.PAYLOAD_WORDS["open"],
    }.get(kind, 0)
    body = rng.integers(0, 1 << 32, words, np.uint32)
    if kind == wire.REQUESTS["open"]:
        body[0] = known.session
    return wire.packet(header, body.tobytes())


def wrong_magic(rng: np.random.Generator, known: Known) -> bytes:
    return request(rng, known, magic=int(rng.choice([*range(0, 0x56), *range(0x57, 0x100)])))


def wrong_version(rng: np.random.Generator, known: Known) -> bytes:
    """Not a status or a read, which are answered whatever the version."""
    others = [version for version in range(256) if version != wire.CONSTANTS["VERSION"]]
    return request(rng, known, version=int(rng.choice(others)))


def wrong_session(rng: np.random.Generator, known: Known) -> bytes:
    """An open that names a session that is not in force."""
    other = int(rng.integers(1, 1 << 32))
    sound = request(rng, known, session=other if other != known.session else other ^ 1)
    if sound[0] == wire.REQUESTS["open"]:
        return sound[: 4 * wire.HEADER_WORDS] + wire.to_bytes([other]) + sound[4 * wire.HEADER_WORDS + 4 :]
    return sound


def wrong_length(rng: np.random.Generator, known: Known) -> bytes:
    """Cut off, by bytes that do not make a word as well, or too long. A fetch, a release or a status with
    more words than it needs is sound."""
    sound = request(rng, known)
    if sound[0] in (wire.REQUESTS["write"], wire.REQUESTS["open"]) and rng.random() < 0.3:
        return sound + bytes(4 * int(rng.integers(1, 10)))
    shorter = int(rng.integers(1, len(sound))) if rng.random() < 0.5 else len(sound) - int(rng.integers(1, 4))
    if shorter % 4 == 0 and shorter >= 4 * wire.HEADER_WORDS and len(sound) == 4 * wire.HEADER_WORDS:
        shorter -= 1
    return sound[:shorter]


def beyond_the_frame(rng: np.random.Generator, known: Known) -> bytes:
    """Chunks that no frame of the session has."""
    if rng.random() < 0.5:
        index = int(rng.integers(known.chunks_in, 1 << 16))
        return request(rng, known, kind=wire.REQUESTS["pixels"], index=index)
    index = int(rng.integers(1 << 16))
    count = int(rng.integers(max(known.chunks_out - index, 0) + 1, 1 << 16))
    return request(rng, known, kind=wire.REQUESTS["fetch"], index=index, count=count)


def too_large(rng: np.random.Generator, known: Known) -> bytes:
    """A session whose frames have no room."""
    body = wire.payload(
        "open",
        {
            "previous": known.session,
            "width": 640,
            "height": 480,
            "chunks_in": int(rng.integers(wire.CONSTANTS["MAX_CHUNKS_IN"] + 1, 1 << 32)),
            "words_out": int(rng.integers(wire.CONSTANTS["MAX_CHUNKS_OUT"] * wire.CHUNK_WORDS + 1, 1 << 32)),
        },
    )
    header = {"kind": wire.REQUESTS["open"], "session": known.session ^ int(rng.integers(1, 1 << 32))}
    return wire.packet(header, wire.to_bytes(body))


def noise(rng: np.random.Generator, _known: Known) -> bytes:
    return rng.integers(0, 256, rng.integers(0, MOST_BYTES + 200), np.uint8).tobytes()


FLAWS = [wrong_magic, wrong_version, wrong_session, wrong_length, beyond_the_frame, too_large, noise]
