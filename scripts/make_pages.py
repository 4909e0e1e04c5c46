"""Make the parts of the documentation that state what other files define.

usage: make_pages.py FOLDER

FOLDER receives parameters.md from sw/parameters.toml and obstacles.md from the JSON Schema of obstacles.jsonl.
The documentation's conf.py calls this before each build.
"""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PARAMETERS = ROOT / "sw" / "parameters.toml"
SCHEMA = ROOT / "doc" / "obstacles.schema.json"

Entry = dict[str, Any]


def table(head: str, rows: list[tuple[str, ...]]) -> list[str]:
    escaped = (" | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in row) for row in rows)
    return [f"| {head} |", "|---" * (head.count(" | ") + 1) + "|", *(f"| {row} |" for row in escaped), ""]


# ---- parameters ----


def allowed(entry: Entry) -> str:
    if entry["type"] == "choice":
        return ", ".join(f"`{choice}`" for choice in entry["choices"])
    unit = f" {entry['unit']}" if entry.get("unit") else ""
    limit = f", at most `{entry['at_most']}`" if "at_most" in entry else ""
    return f"{entry['min']:g} to {entry['max']:g}{unit}{limit}"


def parameter_row(name: str, entry: Entry) -> tuple[str, ...]:
    symbol = f" Symbol in the paper: {entry['symbol']}." if entry.get("symbol") else ""
    return f"`{name}`", f"`{entry['default']}`", allowed(entry), entry["doc"] + symbol


def parameters_page(schema: dict[str, Entry]) -> str:
    """One section of the documentation for each section of the file."""
    lines = []
    for section, content in schema.items():
        rows = [parameter_row(name, entry) for name, entry in content.items() if isinstance(entry, dict)]
        lines += [f"## {section}", "", content["doc"], ""]
        lines += table("parameter | default | range | meaning", rows)
    return "\n".join(lines)


# ---- obstacles.jsonl ----


def type_of(schema: Entry) -> str:
    if "const" in schema:
        return json.dumps(schema["const"])
    if "enum" in schema:
        return " or ".join(f"`{value}`" for value in schema["enum"])
    kind = schema.get("type", "any")
    names = kind if isinstance(kind, list) else [kind]
    if "array" in names and "items" in schema:
        count = schema.get("minItems")
        fixed = f"{count} " if count is not None and count == schema.get("maxItems") else ""
        names = [f"array of {fixed}({type_of(schema['items'])})" if n == "array" else n for n in names]
    return " or ".join(names)


def schema_rows(schema: Entry, prefix: str = "") -> Iterator[tuple[str, ...]]:
    """A row for each key, those of nested objects below their own."""
    for name, content in schema.get("properties", {}).items():
        path = f"{prefix}{name}"
        optional = "" if name in schema.get("required", ()) else " (may be absent)"
        yield f"`{path}`", type_of(content) + optional, content["description"]
        yield from schema_rows(content, f"{path}.")
        yield from schema_rows(content.get("items", {}), f"{path}[].")


def obstacles_page(schema: Entry) -> str:
    return "\n".join([schema["description"], "", *table("key | type | meaning", list(schema_rows(schema)))])


def write_pages(folder: Path) -> None:
    """Leaves pages alone that are already as they should be, so that nothing is built without need."""
    pages = {
        "parameters.md": parameters_page(tomllib.loads(PARAMETERS.read_text())),
        "obstacles.md": obstacles_page(json.loads(SCHEMA.read_text())),
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages.items():
        path = folder / name
        if not path.is_file() or path.read_text() != text:
            path.write_text(text)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    write_pages(parser.parse_args().folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
