"""Creates a stereo engine by its name."""

from __future__ import annotations

from dataclasses import asdict

from vista.control_grid import GridPair
from vista.engine.board import DEFAULT_TIMEOUT_S, BoardEngine
from vista.engine.contract import Engine, EngineParameters
from vista.engine.golden import StereoEngine
from vista.engine.opencv import OpenCvEngine
from vista.engine.rtl import DEFAULT_WIDTH_PX, RtlEngine

ENGINES = ("golden", "rtl", "opencv")
REMOTE_ENGINES = ("board",)  # for commands that take an address
RECTIFYING_ENGINES = ("rtl", "board")  # they take raw images and a map


def create_engine(
    name: str,
    parameters: EngineParameters,
    threads: int = 1,
    rtl_width_px: int | None = None,
    grids: GridPair | None = None,
    address: str | None = None,
    board_timeout_s: int = DEFAULT_TIMEOUT_S,
) -> Engine:
    """The engine called golden (C model), opencv, rtl or board; ValueError for what it cannot do.

    rtl_width_px: widest image of the RTL build to use, None for that of the reference build.
    grids: what rtl and board rectify raw images by.
    address: HOST[:PORT] of the board.
    board_timeout_s: how long it may be silent, or work at one frame.
    """
    if name == "golden":
        return StereoEngine(**asdict(parameters), threads=threads)
    if name == "opencv":
        return OpenCvEngine(parameters)
    if name == "rtl":
        return RtlEngine(parameters, rtl_width_px or DEFAULT_WIDTH_PX, grids)
    if name == "board" and address is not None:
        return BoardEngine(parameters, address, grids, 1000 * board_timeout_s)
    raise ValueError(f"engine must be one of {', '.join((*ENGINES, *REMOTE_ENGINES))}, not {name!r}")
