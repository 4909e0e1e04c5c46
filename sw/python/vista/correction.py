"""Corrects the calibration in flight: from what the rows of a pair say to how the next ones are rectified.

libvista does it (vista/correction.h), for vista-fly as well."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from vista import native, parameters
from vista.alignment import Alignment, Turn, c_camera, c_images
from vista.control_grid import Grid, GridPair
from vista.errors import InputError
from vista.rectify import Map, RawCamera, Rectifier
from vista.sequence import Frame


class RectifyingEngine(Protocol):
    """An engine that takes raw images, and the map to rectify them by."""

    def load_map(self, grids: GridPair) -> None: ...


class Correction:
    """Belongs to one run. engine: that which rectifies in place of the rectifier, if one does."""

    def __init__(
        self, rectifier: Rectifier, values: parameters.Values, engine: RectifyingEngine | None = None
    ) -> None:
        """ValueError for images that are too small."""
        from vista.pipeline import c_parameters

        self._rectifier, self._engine = rectifier, engine
        self._ffi, self._lib = ffi, lib = native.load("vista")
        c_values, camera = c_parameters(ffi, lib, values), c_camera(ffi, rectifier.calibration)
        right = ffi.new("vista_right_rectification *", {"raw": c_raw_camera(ffi, rectifier.right)[0]})
        if rectifier.grids is not None:
            self._grid = np.ascontiguousarray(rectifier.grids.right)  # C goes on reading it
            right.rows, right.columns = self._grid.shape[:2]
            right.grid = ffi.from_buffer("int16_t[]", self._grid)
        size, handle = ffi.new("size_t *"), ffi.new("vista_correction **")
        self._check(lib.vista_correction_bytes(c_values, camera, right, size))
        self._memory = ffi.new("unsigned char[]", size[0])
        self._check(lib.vista_correction_create(self._memory, size[0], c_values, camera, right, handle))
        self._correction = handle[0]

    def update(self, frame: Frame) -> Alignment:
        """frame: rectified. How the next one is rectified has changed when the result says so.

        ValueError for times that do not increase."""
        result = self._ffi.new("vista_alignment_result *")
        images = c_images(self._ffi, frame.left, frame.right)
        self._check(self._lib.vista_correction_update(self._correction, *images, frame.t_ns, result))
        found = Alignment.copied(self._ffi, result)
        if not found.changed:
            return found
        try:
            self._apply(found.correction, self._table())
        except InputError:  # the hardware's line buffer does not reach so far
            self._lib.vista_correction_refuse(self._correction, result)
            return Alignment.copied(self._ffi, result)
        return found

    def reset(self) -> None:
        """What comes next does not continue what came before: the calibration holds again."""
        self._lib.vista_correction_reset(self._correction)
        self._apply(Turn(), None)

    def _apply(self, turn: Turn, table: Map | Grid | None) -> None:
        self._rectifier.align(turn, table)
        if self._engine is not None and self._rectifier.grids is not None:
            self._engine.load_map(self._rectifier.grids)

    def _table(self) -> Map | Grid:
        """A copy of what C has made."""
        made, camera = self._lib.vista_correction_table(self._correction), self._rectifier.calibration
        if self._rectifier.grids is not None:
            grid: Grid = self._copy(made.grid, np.int16, self._grid.shape)
            return grid
        size = camera.height, camera.width
        return self._copy(made.whole, np.int16, (*size, 2)), self._copy(made.fraction, np.uint16, size)

    def _copy(self, pointer: Any, kind: Any, shape: tuple[int, ...]) -> Any:
        count = int(np.prod(shape))
        data = self._ffi.buffer(pointer, count * np.dtype(kind).itemsize)
        return np.frombuffer(data, kind).reshape(shape).copy()

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status)


def c_raw_camera(ffi: Any, camera: RawCamera) -> Any:
    """vista_raw_camera."""
    rotation = camera.rectified_from_raw.ravel().tolist()
    return ffi.new("vista_raw_camera *", (camera.lens, *camera.intrinsics_px, camera.distortion, rotation))
