"""Write the tables of the documentation from the measurements that are committed as JSON.

usage: make_tables.py [--check]
       make_tables.py --save NAME=FILE.json ... --command COMMAND

A measurement is the JSON of the command that made it: `tables`, each with a name, `heads`, `rows` and, if
there is one, a `legend` below; `headline`, what it adds to the table of the front page; and `figures`, what
else is worth keeping. This program knows none of them. Without options it puts every table between the marks
`<!-- table: NAME -->` and `<!-- end of table -->` of the Markdown files; --check changes nothing and fails
when one differs. --save takes over what a command has measured, adds commit, date and machine, and replaces
doc/results/data/NAME.json; the tables follow at once.

Two tables are made here: `headline` of the measurements that its mark names, and `sources` of all.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from run_benches import processor

ROOT = Path(__file__).resolve().parents[1]
DATA = ROOT / "doc" / "results" / "data"
SYNTHESIS = ROOT / "rtl" / "synth" / "results.json"
NAME = "[a-z0-9-]+"
MARKED = re.compile(rf"(<!-- table: ({NAME})((?: {NAME})*) -->\n).*?(<!-- end of table -->)", re.DOTALL)
KEPT = ("tables", "headline", "figures")  # of what a command writes

Record = dict[str, Any]


# ---- measurements ----


def file_of(name: str) -> Path:
    return SYNTHESIS if name == "synthesis" else DATA / f"{name}.json"


def figure_files() -> list[Path]:
    return [*sorted(DATA.glob("*.json")), SYNTHESIS]


def measured(command: str) -> Record:
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True)
    return {
        "commit": commit.stdout.strip(),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "machine": f"{os.cpu_count()} processors, {processor()}",
        "command": command,
    }


def as_text(content: Any, indent: int = 0) -> str:
    """JSON with a line for whatever fits on one."""
    flat = json.dumps(content, ensure_ascii=False)
    if not isinstance(content, dict | list) or len(flat) + indent <= 118:
        return flat
    pad, end = " " * (indent + 1), " " * indent
    if isinstance(content, dict):
        inside = [f"{pad}{json.dumps(key)}: {as_text(value, indent + 1)}" for key, value in content.items()]
        return "{\n" + ",\n".join(inside) + f"\n{end}}}"
    return "[\n" + ",\n".join(pad + as_text(value, indent + 1) for value in content) + f"\n{end}]"


def save(name: str, source: Path, command: str) -> None:
    """Replace the committed measurement. Of a table of `parts`, the rows of the parts that were not measured
    now stay; the first word of a row is its part."""
    raw = json.loads(source.read_text())
    content = {key: raw[key] for key in KEPT if key in raw}
    for table in content["tables"]:
        if table.get("parts") and file_of(name).exists():
            (before,) = (one for one in tables_of(file_of(name)) if one["name"] == table["name"])
            now = {part_of(row) for row in table["rows"]}
            table["rows"] = [row for row in before["rows"] if part_of(row) not in now] + table["rows"]
    file_of(name).write_text(as_text({"measured": measured(command)} | content) + "\n")


def part_of(row: list[str]) -> str:
    return row[0].split()[0].strip("`")


def tables_of(path: Path) -> list[Record]:
    tables: list[Record] = json.loads(path.read_text())["tables"]
    return tables


# ---- tables ----


def markdown(heads: list[str], rows: list[list[str]]) -> str:
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def with_legend(table: Record, origin: Record) -> str:
    """The table, what it says of itself, and when it was measured; a table measured apart from the others of
    its file says that itself."""
    when = table.get("origin", f"Measured at commit {origin['commit']}, {origin['date']}")
    parts = [markdown(table["heads"], table["rows"]), table.get("legend", ""), f"*{when}.*"]
    return "\n\n".join(filter(None, parts))


def measured_tables() -> dict[str, str]:
    contents = [json.loads(path.read_text()) for path in figure_files()]
    return {
        table["name"]: with_legend(table, content["measured"])
        for content in contents
        for table in content["tables"]
    }


def headline_table(names: list[str]) -> str:
    """The few figures that the front page states, each with the command that gives it and the commit at which
    it did."""
    rows = []
    for content in (json.loads(file_of(name).read_text()) for name in names):
        origin = content["measured"]
        rows.append([*content["headline"], f"`{origin['command']}`", origin["commit"]])
    return markdown(["what", "measured", "command", "at commit"], rows)


def sources_table() -> str:
    rows = []
    for path in figure_files():
        origin = json.loads(path.read_text())["measured"]
        cells = [f"`{path.relative_to(ROOT)}`", f"`{origin['command']}`"]
        rows.append([*cells, f"{origin['commit']}, {origin['date']}", origin["machine"]])
    return markdown(["figures", "command", "commit, date", "machine"], rows)


# ---- pages ----


def pages() -> Iterator[Path]:
    yield ROOT / "README.md"
    yield from sorted((ROOT / "doc").rglob("*.md"))


def with_tables(text: str, made: dict[str, str]) -> str:
    def table(found: re.Match[str]) -> str:
        name, names = found[2], found[3].split()
        if name == "headline":
            content = headline_table(names)
        else:
            content = sources_table() if name == "sources" else made[name]
        return f"{found[1]}\n{content}\n\n{found[4]}"

    return MARKED.sub(table, text)


def write_tables(check: bool) -> list[Path]:
    """The pages whose tables were not those of the measurements."""
    stale, made = [], measured_tables()
    for path in pages():
        text = path.read_text()
        if (wanted := with_tables(text, made)) != text:
            stale.append(path)
            if not check:
                path.write_text(wanted)
    return stale


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="write nothing; fail when a table is stale")
    parser.add_argument("--save", nargs="+", default=[], metavar="NAME=FILE.json", help="figures to commit")
    parser.add_argument("--command", default="", help="the command that has measured them")
    arguments = parser.parse_args()
    if arguments.save and not arguments.command:
        parser.error("--save needs --command")
    for one in arguments.save:
        name, _, source = one.partition("=")
        save(name, Path(source), arguments.command)
    stale = write_tables(arguments.check)
    if arguments.check and stale:
        names = ", ".join(str(path.relative_to(ROOT)) for path in stale)
        print(f"make_tables: {names}: differs from the figures in JSON; run make generate", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
