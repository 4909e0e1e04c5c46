# SPDX-License-Identifier: Apache-2.0
"""Packets that a board must not obey, drawn at random, for a board with a session of somebody else.

Each is a request that differs from a sound one in its magic, its version, its session, its length, or in a
number beyond the frame. Sent between the packets of a client, none may change a word of its frames.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

import wire

KINDS = list(wire.REQUESTS.values())
OTHER_MAGIC = [magic for magic in range(256) if magic != wire.CONSTANTS["MAGIC"]]
OTHER_VERSIONS = [version for version in range(256) if version != wire.CONSTANTS["VERSION"]]
MOST_BYTES = 4 * (wire.HEADER_WORDS + wire.CHUNK_WORDS)


@dataclass(frozen=True)
class Known:
    """What somebody who overhears the link knows of the session."""

    session: int
    frame: int  # that the client is at
    last_write: int
    chunks_in: int
    chunks_out: int


def hostile_packets(rng: Random, known: Known) -> Iterator[bytes]:
    while True:
        yield rng.choice(FLAWS)(rng, known)


def request(rng: Random, known: Known, **changed: int) -> bytes:
    """A request that would be obeyed, but for the fields that are given."""
    kind = rng.choice(KINDS)
    write = kind == wire.REQUESTS["write"]
    count = rng.randrange(1, 4)
    header = {
        "kind": kind,
        "flags": rng.randrange(2),
        "session": known.session,
        "token": rng.getrandbits(32),
        "frame": known.last_write + 1 if write else known.frame + rng.randrange(-2, 3) & 0xFFFFFFFF,
        "index": 4 * rng.randrange(32) if write else rng.randrange(known.chunks_out),
        "count": count,
    } | changed
    kind = header["kind"]
    words = {
        wire.REQUESTS["write"]: count,
        wire.REQUESTS["pixels"]: wire.CHUNK_WORDS,
        wire.REQUESTS["open"]: wire.PAYLOAD_WORDS["open"],
    }.get(kind, 0)
    body = rng.randbytes(4 * words)
    if kind == wire.REQUESTS["open"]:
        body = wire.to_bytes([known.session]) + body[4:]
    return wire.packet(header, body)


def wrong_magic(rng: Random, known: Known) -> bytes:
    return request(rng, known, magic=rng.choice(OTHER_MAGIC))


def wrong_version(rng: Random, known: Known) -> bytes:
    """Not a status or a read, which are answered whatever the version."""
    return request(rng, known, version=rng.choice(OTHER_VERSIONS))


def wrong_session(rng: Random, known: Known) -> bytes:
    """An open that names a session that is not in force."""
    other = rng.randrange(1, 1 << 32)
    sound = request(rng, known, session=other if other != known.session else other ^ 1)
    if sound[0] == wire.REQUESTS["open"]:
        return sound[: 4 * wire.HEADER_WORDS] + wire.to_bytes([other]) + sound[4 * wire.HEADER_WORDS + 4 :]
    return sound


def wrong_length(rng: Random, known: Known) -> bytes:
    """Cut off, by bytes that do not make a word as well, or too long. A fetch, a release or a status with
    more words than it needs is sound."""
    sound = request(rng, known)
    if sound[0] in (wire.REQUESTS["write"], wire.REQUESTS["open"]) and rng.random() < 0.3:
        return sound + bytes(4 * rng.randrange(1, 10))
    shorter = rng.randrange(1, len(sound)) if rng.random() < 0.5 else len(sound) - rng.randrange(1, 4)
    if shorter % 4 == 0 and shorter >= 4 * wire.HEADER_WORDS and len(sound) == 4 * wire.HEADER_WORDS:
        shorter -= 1
    return sound[:shorter]


def beyond_the_frame(rng: Random, known: Known) -> bytes:
    """Chunks that no frame of the session has, also by numbers whose sum goes round within 16 bits."""
    drawn = rng.random()
    if drawn < 0.5:
        index = rng.randrange(known.chunks_in, 1 << 16)
        return request(rng, known, kind=wire.REQUESTS["pixels"], index=index)
    if drawn < 0.7:
        index = rng.randrange(known.chunks_out + 1, 1 << 16)
        count = (1 << 16) - index + rng.randrange(known.chunks_out + 1)
    else:
        index = rng.randrange(1 << 16)
        count = rng.randrange(max(known.chunks_out - index, 0) + 1, 1 << 16)
    return request(rng, known, kind=wire.REQUESTS["fetch"], index=index, count=count)


def too_large(rng: Random, known: Known) -> bytes:
    """A session whose frames have no room."""
    body = wire.payload(
        "open",
        {
            "previous": known.session,
            "width": 640,
            "height": 480,
            "chunks_in": rng.randrange(wire.CONSTANTS["MAX_CHUNKS_IN"] + 1, 1 << 32),
            "words_out": rng.randrange(wire.CONSTANTS["MAX_CHUNKS_OUT"] * wire.CHUNK_WORDS + 1, 1 << 32),
        },
    )
    header = {"kind": wire.REQUESTS["open"], "session": known.session ^ rng.randrange(1, 1 << 32)}
    return wire.packet(header, wire.to_bytes(body))


def noise(rng: Random, _known: Known) -> bytes:
    return rng.randbytes(rng.randrange(MOST_BYTES + 200))


FLAWS = [wrong_magic, wrong_version, wrong_session, wrong_length, beyond_the_frame, too_large, noise]
