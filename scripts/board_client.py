"""The simulated board (`make board-sim`, `make board-clocks`), and the client of libvista in Python."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt
from measured_figures import ROOT
from vista import native
from vista.engine import EngineParameters
from vista.engine.hardware import settings_of

ffi, lib = native.load("vista")

Image = npt.NDArray[np.uint8]


class BoardError(Exception):
    pass


def checked(status: int) -> None:
    if status != lib.VISTA_OK:
        raise BoardError(ffi.string(lib.vista_status_text(status)).decode())


class Client:
    """BoardError, with the text of the status, for whatever fails."""

    def __init__(self, port: int, timeout_ms: int) -> None:
        self._memory, handle = ffi.new("char[]", lib.vista_board_bytes()), ffi.new("vista_board **")
        checked(
            lib.vista_board_connect(self._memory, len(self._memory), b"127.0.0.1", port, timeout_ms, handle)
        )
        self._board = handle[0]

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        lib.vista_board_disconnect(self._board)

    def configure(
        self,
        parameters: EngineParameters,
        width_px: int,
        height_px: int,
        grids: npt.NDArray[np.int16] | None = None,
    ) -> None:
        settings = settings_of(parameters) | {"width_px": width_px, "height_px": height_px}
        maps = [
            ffi.from_buffer("int16_t[]", np.ascontiguousarray(grid))
            for grid in (() if grids is None else grids)
        ]
        settings |= dict(zip(("left_map", "right_map"), maps, strict=False))
        checked(lib.vista_board_configure(self._board, ffi.new("vista_board_settings *", settings)))

    def submit(self, left: Image, right: Image) -> None:
        pixels = [ffi.from_buffer("uint8_t[]", np.ascontiguousarray(image)) for image in (left, right)]
        checked(lib.vista_board_submit(self._board, *pixels, left.shape[1]))

    def collect(self) -> npt.NDArray[np.int16]:
        """The words of all levels, one after the other."""
        words = np.empty(lib.vista_board_words(self._board), np.int16)
        checked(lib.vista_board_collect(self._board, ffi.from_buffer("int16_t[]", words), words.size))
        return words

    @property
    def counts(self) -> Any:
        return lib.vista_board_count(self._board)


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
