"""Make the parts of the documentation that state what other files define.

The documentation's conf.py calls this before each build: parameters.md comes from sw/parameters.toml,
obstacles.md from the JSON Schema of obstacles.jsonl, requirements.md from doc/requirements.toml, testplan.md
from rtl/testplan.toml, and the C headers are copied with their comments in the form that hawkmoth reads.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

from evidence import REQUIREMENTS, TESTPLAN, named, read

ROOT = Path(__file__).resolve().parents[1]
PARAMETERS = ROOT / "sw" / "parameters.toml"
SCHEMA = ROOT / "doc" / "obstacles.schema.json"
INCLUDE_FOLDERS = (ROOT / "sw" / "include", ROOT / "model" / "c" / "include")

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


# ---- requirements and test plan ----


def evidence_of(entry: Entry) -> str:
    return ", ".join(f"{kind} `{what}`" for kind, what in named([entry]))


def testplan_page(points: list[Entry]) -> str:
    """The points of the test plan with their evidence, a table for each part."""
    lines = []
    for part, entries in groupby(points, key=lambda point: str(point["part"])):
        rows: list[tuple[str, ...]] = [(p["id"], p["text"], evidence_of(p)) for p in entries]
        lines += [f"### {part.capitalize()}", "", *table("point | promise | evidence", rows)]
    return "\n".join(lines)


def requirements_page(content: dict[str, list[Entry]]) -> str:
    """The hazards with the requirements that meet them, and the requirements with their evidence."""
    hazards: list[tuple[str, ...]] = [
        (
            f"*{hazard['id']}*: {hazard['text']}",
            hazard["causes"],
            ", ".join(r["id"] for r in content["requirement"] if hazard["id"] in r["hazards"]),
            hazard["remains"],
        )
        for hazard in content["hazard"]
    ]
    requirements: list[tuple[str, ...]] = [
        (
            r["id"],
            r["text"],
            f"{r['source']}; {', '.join(r['hazards'])}",
            evidence_of(r),
        )
        for r in content["requirement"]
    ]
    lines = ["## Hazards", "", *table("hazard | causes | met by | what remains", hazards)]
    lines += ["## Requirements", "", *table("id | requirement | source; hazards | evidence", requirements)]
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


# ---- C headers ----

COMMENT = re.compile(
    r"^(?P<indent>[ \t]*)(?P<code>[^\n]*?)[ \t]*/\*(?P<text>.*?)\*/", re.DOTALL | re.MULTILINE
)
# A member whose name says all still has to be listed.
BARE_MEMBER = re.compile(r"(?<=[;,{]\n)(  )(\w[^\n/*]*(?:\*\w+)?[;,]?)(?=\n)")
# hawkmoth lists the first of several members that are declared together.
TOGETHER = re.compile(r"(  /\*\*(?:(?!\*/).)*\*/\n  )((?:const )?\w+ )([^;(){}\n]*,[^;(){}\n]*);", re.DOTALL)
RST_MARKUP = re.compile(r"([*|`\\]|_\b)")


def escape(found: re.Match[str]) -> str:
    return f"\\{found[0]}"


def text_of(comment: str, markup: re.Pattern[str] | None = None) -> list[str]:
    """The lines of a comment without its frame, with what is markup escaped."""
    lines = [re.sub(r"^[ \t]*\*? ?", "", line).rstrip() for line in comment.lstrip("*").split("\n")]
    return [markup.sub(escape, line) if markup else line for line in lines]


def documented(header: str) -> str:
    """The header with every comment as a documentation comment in front of what it describes.

    The comment at the head of the file and those behind preprocessor lines stay as they are.
    """

    def moved(found: re.Match[str]) -> str:
        indent, code = found["indent"], found["code"]
        if code.startswith("#") or found.start() == 0:
            return found[0]
        text = [f"{indent} * {line}".rstrip() for line in text_of(found["text"], RST_MARKUP)]
        comment = "\n".join([f"{indent}/**", *text, f"{indent} */"])
        return f"{comment}\n{indent}{code}" if code else comment

    def apart(found: re.Match[str]) -> str:
        comment, kind, names = found.groups()
        return "\n".join(f"{comment}{kind}{name.strip()};" for name in names.split(","))

    return TOGETHER.sub(apart, BARE_MEMBER.sub(r"\1/** */\n\1\2", COMMENT.sub(moved, header)))


def headers() -> dict[str, str]:
    """Name, as an #include has it, and text of each public header."""
    return {
        str(path.relative_to(folder)): path.read_text()
        for folder in INCLUDE_FOLDERS
        for path in sorted(folder.rglob("*.h"))
    }


def c_page(texts: dict[str, str]) -> str:
    """A section for each header: the comment at its head, and what it declares."""
    lines = []
    for name, text in texts.items():
        head = COMMENT.match(text)
        about = text_of(head["text"]) if head else []
        lines += [f"## {name}", "", *about, ""]
        if "/**" in documented(text):
            lines += ["```{eval-rst}", f".. c:autodoc:: {name}", "```", ""]
    return "\n".join(lines)


def write_if_other(path: Path, text: str) -> None:
    """Leaves a file alone that is already as it should be, so that nothing is built without need."""
    if not path.is_file() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def write_pages(folder: Path, header_folder: Path) -> None:
    write_if_other(folder / "parameters.md", parameters_page(tomllib.loads(PARAMETERS.read_text())))
    write_if_other(folder / "requirements.md", requirements_page(read(REQUIREMENTS)))
    write_if_other(folder / "testplan.md", testplan_page(read(TESTPLAN)["point"]))
    write_if_other(folder / "obstacles.md", obstacles_page(json.loads(SCHEMA.read_text())))
    write_if_other(folder / "c.md", c_page(headers()))
    for name, text in headers().items():
        write_if_other(header_folder / name, documented(text))
