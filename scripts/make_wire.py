"""Write the C header and the documentation of the board's protocol from rtl/board/wire.toml.

make_wire.py WIRE.toml HEADER.h PAGE.md [--check]
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Entry = dict[str, Any]
ORIGIN = "scripts/make_wire.py from rtl/board/wire.toml: make generate"


def fields(words: Entry) -> Iterator[tuple[int, int, Entry]]:
    """Word, lowest bit and entry of each field."""
    for number, parts in enumerate(words.values()):
        low = 0
        for part in parts:
            yield number, low, part
            low += part["bits"]


def define(name: str, value: int | str, doc: str = "") -> str:
    return f"#define WIRE_{name} {value}" + (f" /* {doc} */" if doc else "")


def layout(prefix: str, words: Entry) -> list[str]:
    """A field as a number: 256 * its word + its lowest bit, and 65536 * its width."""
    lines = [
        define(f"{prefix}_{part['name'].upper()}", f"0x{part['bits'] << 16 | number << 8 | low:06X}")
        for number, low, part in fields(words)
    ]
    return [*lines, define(f"{prefix}_WORDS", len(words))]


def header(wire: Entry) -> str:
    lines = [
        "/* SPDX-License-Identifier: Apache-2.0 */",
        f"/* Written by {ORIGIN}.",
        " *",
        " * A field is given as 65536 * its width in bits + 256 * its word + its lowest bit. */",
        "#ifndef VISTA_BOARD_WIRE_H",
        "#define VISTA_BOARD_WIRE_H",
        "",
        *(define(name, entry["value"]) for name, entry in wire["constants"].items()),
        "",
        *(
            define(f"{group}_{name.upper()}", f"0x{entry['kind']:02X}")
            for group, key in (("REQUEST", "requests"), ("REPLY", "replies"))
            for name, entry in wire[key].items()
        ),
        "",
        *layout("HEADER", wire["header"]),
        "",
    ]
    for name, words in wire["payload"].items():
        lines += [*layout(name.upper(), words), ""]
    lines += [define(f"STATE_{name.upper()}", entry["value"]) for name, entry in wire["states"].items()]
    return "\n".join([*lines, "", "#endif", ""])


def table(head: str, rows: list[tuple[Any, ...]]) -> list[str]:
    body = ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return [f"| {head} |", "|---" * (head.count(" | ") + 1) + "|", *body, ""]


def layout_table(words: Entry) -> list[str]:
    rows = [
        (number, f"{low + part['bits'] - 1}:{low}", f"`{part['name']}`", part["doc"])
        for number, low, part in fields(words)
    ]
    return table("word | bits | field | meaning", rows)


def page(wire: Entry) -> str:
    constants = [(f"`{name}`", entry["value"], entry["doc"]) for name, entry in wire["constants"].items()]
    requests = [
        (f"`{name}`", f"0x{entry['kind']:02X}", entry["doc"], entry["answer"])
        for name, entry in wire["requests"].items()
    ]
    replies = [
        (f"`{name}`", f"0x{entry['kind']:02X}", entry["doc"]) for name, entry in wire["replies"].items()
    ]
    states = [(entry["value"], f"`{name}`", entry["doc"]) for name, entry in wire["states"].items()]
    lines = [
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        f"<!-- Written by {ORIGIN} -->",
        "### Constants",
        "",
        *table("name | value | meaning", constants),
        "### Header of each packet",
        "",
        *layout_table(wire["header"]),
        "### Requests",
        "",
        *table("packet | kind | meaning | answer", requests),
        "### Replies",
        "",
        *table("packet | kind | meaning", replies),
    ]
    for name, words in wire["payload"].items():
        lines += [f"### Payload of `{name}`", "", *layout_table(words)]
    lines += [
        "A bitmap of `MAX_CHUNKS_IN` bits follows: bit i of its word n is 1 if chunk 32 n + i has come.",
        "",
    ]
    lines += ["### States of a slot", "", *table("value | state | meaning", states)]
    return "\n".join(lines).rstrip() + "\n"


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wire", type=Path)
    parser.add_argument("header", type=Path)
    parser.add_argument("page", type=Path)
    parser.add_argument("--check", action="store_true", help="compare with the files instead of writing them")
    options = parser.parse_args(arguments)
    wire = tomllib.loads(options.wire.read_text())
    for path, text in ((options.header, header(wire)), (options.page, page(wire))):
        if not options.check:
            path.write_text(text)
        elif not path.is_file() or path.read_text() != text:
            raise SystemExit(f"{path} is not what {options.wire} says: make generate")


if __name__ == "__main__":
    main(sys.argv[1:])
