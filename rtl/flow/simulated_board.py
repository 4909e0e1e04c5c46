# SPDX-License-Identifier: Apache-2.0
"""The simulated board (`make board-sim`, `make board-clocks`)."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Board:
    port: int
    packets: dict[str, int] = field(default_factory=dict)  # what the link did, once the board has ended


def program_of(name: str, disparities: int, block_px: int, max_width_px: int, rectify_rows: int) -> Path:
    """board-sim or board-clocks, of this build."""
    build = f"d{disparities}_b{block_px}_w{max_width_px}_r{rectify_rows}"
    program = ROOT / "build" / "board" / build / name
    if not program.is_file():
        parts = " ".join(f"{part[0].upper()}={part[1:]}" for part in build.split("_"))
        sys.exit(f"{Path(sys.argv[0]).stem}: {program.relative_to(ROOT)} is missing: make {name} {parts}")
    return program


@contextmanager
def running(program: Path, *options: str) -> Iterator[Board]:
    """The simulation, until it is left."""
    command = [str(program), *options]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        board = Board(int(process.stdout.readline()))
        yield board
        said, _ = process.communicate()
    board.packets = {name: int(count) for count, name in re.findall(r"(\d+) (\w+)", said)}
