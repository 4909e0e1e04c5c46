"""Creates a stereo engine by its name."""

from __future__ import annotations

from dataclasses import asdict

from vista.control_grid import GridPair
from vista.engine.contract import Engine, EngineParameters
from vista.engine.golden import StereoEngine
from vista.engine.opencv import OpenCvEngine
from vista.engine.rtl import DEFAULT_WIDTH_PX, RtlEngine

ENGINES = ("golden", "rtl", "opencv")


def create_engine(
    name: str,
    parameters: EngineParameters,
    threads: int = 1,
    rtl_width_px: int | None = None,
    rtl_grids: GridPair | None = None,
) -> Engine:
    """The engine called golden (C model), opencv or rtl; ValueError for what it cannot do.

    rtl_width_px: widest image of the RTL build to use, None for that of the reference build.
    rtl_grids: the RTL rectifies by them and takes raw images.
    """
    if name == "golden":
        return StereoEngine(**asdict(parameters), threads=threads)
    if name == "opencv":
        return OpenCvEngine(parameters)
    if name == "rtl":
        return RtlEngine(parameters, rtl_width_px or DEFAULT_WIDTH_PX, rtl_grids)
    raise ValueError(f"engine must be one of {', '.join(ENGINES)}, not {name!r}")
