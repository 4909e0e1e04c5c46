"""Tables as text."""

from __future__ import annotations


def aligned(rows: list[tuple[str, ...]], below: dict[int, list[str]]) -> str:
    """First column to the left, the others to the right; below: whole lines after a row, by its index."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for k, row in enumerate(rows):
        cells = [row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]
        lines += ["  ".join(cells).rstrip(), *below.get(k, [])]
    return "\n".join(lines)
