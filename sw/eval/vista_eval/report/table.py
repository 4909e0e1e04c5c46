"""Tables: as text, as cells for a page, and as what a measurement keeps for the documentation.

`scripts/make_tables.py --save` takes over what `write_measurement` writes.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from vista.output import make_folder, write_atomically


@dataclass(frozen=True)
class Table:
    name: str
    heads: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]  # one cell alone: a line across all columns
    legend: str = ""  # a text below it
    title: str = ""

    def as_text(self) -> str:
        heads = [self.heads] if self.heads else []
        return "\n".join(filter(None, [self.title, aligned([*heads, *self.rows]), self.legend]))

    def is_text(self, column: int) -> bool:
        """A column of words, which begin at the left."""
        cells = [row[column] for row in self.rows if len(row) > 1]
        return not any(cell[:1].isdigit() for cell in cells) and any(cell[:1].isalpha() for cell in cells)


def aligned(rows: Sequence[tuple[str, ...]]) -> str:
    """First column to the left, the others to the right. A row of one cell is a line across all columns."""
    widths = [max(map(len, column)) for column in zip(*(row for row in rows if len(row) > 1), strict=True)]
    lines = []
    for row in rows:
        cells = row if len(row) == 1 else (row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:]))
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def write_measurement(
    path: Path,
    tables: Sequence[Table],
    figures: Any = None,
    headline: tuple[str, str] | None = None,
    **beside: Any,
) -> None:
    """tables, figures and headline (what was measured, and what it came to) are what the documentation keeps;
    `beside` is for whoever reads the file."""
    content: dict[str, Any] = {} if headline is None else {"headline": headline}
    content["tables"] = [
        {key: value for key, value in asdict(table).items() if key == "rows" or (value and key != "title")}
        for table in tables
    ]
    content |= ({} if figures is None else {"figures": figures}) | beside
    make_folder(path.parent)
    write_atomically(path, json.dumps(content, indent=1) + "\n")


def rounded(value: Any, digits: int) -> Any:
    """The same with all numbers rounded, however deep they lie."""
    if isinstance(value, dict):
        return {key: rounded(one, digits) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(one, digits) for one in value]
    return round(value, digits) if isinstance(value, float) else value


# ---- cells ----


def fixed(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def span(values: Sequence[float] | None, unit: str = "") -> str:
    """The ends of a range; one number where there is only one."""
    if values is None:
        return ""
    ends = f"{values[0]:g}" if len(values) == 1 else f"{values[0]:g} to {values[1]:g}"
    return ends + unit


def with_interval(share: dict[str, Any]) -> str:
    if share["value"] is None:
        return ""
    return f"{share['value']:.3f} ({share['low']:.3f} to {share['high']:.3f})"
