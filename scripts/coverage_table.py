"""Prints coverage by folder: coverage_table.py C.json PYTHON.json, as gcovr and coverage.py write them."""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from pathlib import Path, PurePath


def lines_by_folder(files: dict[str, tuple[int, int]]) -> dict[str, tuple[int, int]]:
    """Covered lines and all lines of each folder, files below it not included."""
    folders: dict[str, tuple[int, int]] = defaultdict(lambda: (0, 0))
    for name, (covered, lines) in files.items():
        folder = str(PurePath(name).parent)
        folders[folder] = folders[folder][0] + covered, folders[folder][1] + lines
    return dict(sorted(folders.items()))


def table(title: str, files: dict[str, tuple[int, int]]) -> list[str]:
    rows = [*lines_by_folder(files).items()]
    rows.append(("together", (sum(c for c, _ in files.values()), sum(n for _, n in files.values()))))
    return [f"{title:<48} {'lines':>7} {'covered':>8}"] + [
        f"{folder:<48} {lines:>7} {100 * covered / max(lines, 1):>6.1f} %"
        for folder, (covered, lines) in rows
    ]


def main() -> None:
    c, python = (json.loads(Path(name).read_text()) for name in sys.argv[1:])
    c_files = {file["filename"]: (file["line_covered"], file["line_total"]) for file in c["files"]}
    python_files = {
        name: (file["summary"]["covered_lines"], file["summary"]["num_statements"])
        for name, file in python["files"].items()
    }
    print("\n".join([*table("C and C++", c_files), "", *table("Python", python_files)]))


if __name__ == "__main__":
    main()
