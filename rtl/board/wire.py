# SPDX-License-Identifier: Apache-2.0
"""The board's protocol as Python sees it, read from wire.toml: names and packets as numbers."""

from __future__ import annotations

import struct
import tomllib
from pathlib import Path
from typing import Any, NamedTuple

WIRE: dict[str, Any] = tomllib.loads(Path(__file__).with_name("wire.toml").read_text())
CONSTANTS: dict[str, int] = {name: entry["value"] for name, entry in WIRE["constants"].items()}
REQUESTS: dict[str, int] = {name: entry["kind"] for name, entry in WIRE["requests"].items()}
REPLIES: dict[str, int] = {name: entry["kind"] for name, entry in WIRE["replies"].items()}
STATES: dict[str, int] = {name: entry["value"] for name, entry in WIRE["states"].items()}

CHUNK_WORDS = CONSTANTS["CHUNK_BYTES"] // 4
BITMAP_WORDS = CONSTANTS["MAX_CHUNKS_IN"] // 32


class Field(NamedTuple):
    word: int
    low: int
    bits: int


def _layout(words: dict[str, list[dict[str, Any]]]) -> dict[str, Field]:
    found = {}
    for number, parts in enumerate(words.values()):
        low = 0
        for part in parts:
            found[part["name"]] = Field(number, low, part["bits"])
            low += part["bits"]
    return found


HEADER = _layout(WIRE["header"])
HEADER_WORDS = len(WIRE["header"])
PAYLOAD = {name: _layout(words) for name, words in WIRE["payload"].items()}
PAYLOAD_WORDS = {name: len(words) for name, words in WIRE["payload"].items()}


def _pack(layout: dict[str, Field], count: int, values: dict[str, int]) -> list[int]:
    words = [0] * count
    for name, value in values.items():
        field = layout[name]
        if not 0 <= value < 1 << field.bits:
            raise ValueError(f"{name} does not fit: {value}")
        words[field.word] |= value << field.low
    return words


def _unpack(layout: dict[str, Field], words: tuple[int, ...]) -> dict[str, int]:
    return {name: words[f.word] >> f.low & (1 << f.bits) - 1 for name, f in layout.items()}


def to_bytes(words: list[int]) -> bytes:
    return struct.pack(f"<{len(words)}I", *words)


def payload(name: str, values: dict[str, int]) -> list[int]:
    """The words of the payload of an open or a status, without its bitmap."""
    return _pack(PAYLOAD[name], PAYLOAD_WORDS[name], values)


def packet(header: dict[str, int], body: bytes = b"") -> bytes:
    own = {"magic": CONSTANTS["MAGIC"], "version": CONSTANTS["VERSION"]}
    return to_bytes(_pack(HEADER, HEADER_WORDS, own | header)) + body


def parse(data: bytes) -> tuple[dict[str, int], bytes]:
    """Header and payload; ValueError if there is no header."""
    if len(data) < 4 * HEADER_WORDS:
        raise ValueError("no header")
    header = _unpack(HEADER, struct.unpack_from(f"<{HEADER_WORDS}I", data))
    return header, data[4 * HEADER_WORDS :]


def parse_payload(name: str, body: bytes) -> dict[str, int]:
    """ValueError if it is too short."""
    count = PAYLOAD_WORDS[name]
    if len(body) < 4 * count:
        raise ValueError(f"{name} is too short")
    return _unpack(PAYLOAD[name], struct.unpack_from(f"<{count}I", body))


def check_of(words: bytes, session: int, frame: int, chunk: int) -> int:
    """The check of a chunk of words."""
    check = session ^ frame ^ chunk << 16
    for (word,) in struct.iter_unpack("<I", words):
        check = ((check << 1 & 0xFFFFFFFF | check >> 31) + word) & 0xFFFFFFFF
    return check
