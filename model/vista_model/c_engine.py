"""The C library behind the reference's parameters, bare: what tests and benches of model/ compare."""

from __future__ import annotations

import functools
import importlib.util
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from vista_model.engine import Image, Outputs, Parameters
from vista_model.rectify import Grid

_ROOT = Path(__file__).resolve().parents[2]
_ISAS = ("portable", "avx2", "avx512", "neon")


@functools.cache
def library() -> tuple[Any, Any]:
    """The cffi pair (ffi, lib) of libvista_engine."""
    build = os.environ.get("VISTA_BUILD", "build")  # of libraries built otherwise, as for the sanitizers
    binding = _ROOT / "build" / "python" / "vista_engine_abi.py"
    shared = _ROOT / build / "lib" / "libvista_engine.so"
    if not (binding.is_file() and shared.is_file()):
        raise ImportError("libvista_engine.so is not built: run `make build`")
    spec = importlib.util.spec_from_file_location("vista_engine_abi", binding)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.ffi, module.ffi.dlopen(str(shared))


def isas() -> list[str]:
    """The instruction sets of this build and machine, slowest first."""
    lib = library()[1]
    return [name for name in _ISAS if lib.vista_engine_isa_available(_isa(name))]


def _isa(name: str) -> int:
    return getattr(library()[1], f"VISTA_ENGINE_ISA_{name.upper()}")


def c_params(parameters: Parameters, isa: str = "auto") -> Any:
    """The C struct; its prefilter and check are spelled as the reference's."""
    ffi, lib = library()
    values = dict(vars(parameters), isa=_isa(isa))
    values["prefilter"] = getattr(lib, f"VISTA_ENGINE_PREFILTER_{parameters.prefilter.upper()}")
    values["lr_max_diff"] = -1 if parameters.lr_max_diff is None else parameters.lr_max_diff
    return ffi.new("vista_engine_params *", values)


def aligned_bytes(size: int) -> npt.NDArray[np.uint8]:
    """Scratch as the library wants it; not zero, since nothing may hang on what it holds."""
    memory = np.full(size + 64, 0xA5, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start : start + size]


class CEngine:
    """One set of parameters; keeps its scratch from call to call."""

    def __init__(self, parameters: Parameters, isa: str = "auto") -> None:
        self._params = c_params(parameters, isa)
        self._scratch = aligned_bytes(0)

    def prepare(
        self,
        left: Image,
        right: Image,
        disparity: npt.NDArray[np.int16],
        smin: npt.NDArray[np.uint32] | None = None,
        rows: tuple[int, int] | None = None,
        confidence: npt.NDArray[np.uint16] | None = None,
    ) -> Callable[[], None]:
        """The bare C call on these arrays, which the caller keeps alive. Images may have a row stride."""
        ffi, lib = library()
        height, width = left.shape
        needed = lib.vista_engine_scratch_bytes(self._params, width, height, 1)
        if len(self._scratch) < needed:
            self._scratch = aligned_bytes(needed)

        def pointer(kind: str, array: npt.NDArray[Any] | None) -> Any:
            return ffi.NULL if array is None else ffi.cast(f"{kind} *", array.ctypes.data)

        sides = (pointer("uint8_t", left), pointer("uint8_t", right))
        images = ffi.new("vista_engine_images *", (*sides, width, height, left.strides[0], right.strides[0]))
        results = (pointer("int16_t", disparity), pointer("uint32_t", smin))
        strides = (width, width, pointer("uint16_t", confidence), width)
        output = ffi.new("vista_engine_output *", (*results, *strides))
        scratch = (pointer("uint8_t", self._scratch), len(self._scratch))

        def call() -> None:
            if rows is None:
                status = lib.vista_engine_compute(self._params, images, output, *scratch)
            else:
                status = lib.vista_engine_compute_rows(self._params, images, output, *rows, *scratch)
            if status != lib.VISTA_ENGINE_OK:
                raise ValueError(ffi.string(lib.vista_engine_status_name(status)).decode())

        return call

    def compute(
        self, left: Image, right: Image, rows: tuple[int, int] | None = None
    ) -> tuple[npt.NDArray[np.int16], npt.NDArray[np.uint32]]:
        """Words and Smin; with `rows` only of first .. end-1, the others 0."""
        disparity, smin = np.zeros(left.shape, np.int16), np.zeros(left.shape, np.uint32)
        self.prepare(left, right, disparity, smin, rows)()
        return disparity, smin

    def compute_all(self, left: Image, right: Image, rows: tuple[int, int] | None = None) -> Outputs:
        """The same with the confidence."""
        outputs = Outputs(*(np.zeros(left.shape, kind) for kind in (np.int16, np.uint32, np.uint16)))
        self.prepare(left, right, outputs.words, outputs.smin, rows, outputs.confidence)()
        return outputs


def prepare_smooth(image: Image, out: Image, isa: str = "auto") -> Callable[[], None]:
    """The bare C call that smooths an image; the caller keeps both arrays alive. Rows may have a stride."""
    return _prepare_front(library()[1].vista_frontend_smooth, image, out, isa)


def prepare_reduce(image: Image, out: Image, isa: str = "auto") -> Callable[[], None]:
    """The same for the next level of the pyramid."""
    return _prepare_front(library()[1].vista_frontend_reduce, image, out, isa)


def _prepare_front(function: Any, image: Image, out: Image, isa: str) -> Callable[[], None]:
    c_image, c_out = _c_images(image, out)
    return lambda: _check(function(c_image, c_out, out.strides[0], _isa(isa)))


def _c_images(image: Image, out: Image) -> tuple[Any, Any]:
    ffi = library()[0]
    height, width = image.shape
    data, c_out = (ffi.cast("uint8_t *", array.ctypes.data) for array in (image, out))
    return ffi.new("vista_frontend_image *", (data, width, height, image.strides[0])), c_out


def _check(status: int) -> None:
    ffi, lib = library()
    if status != lib.VISTA_ENGINE_OK:
        raise ValueError(ffi.string(lib.vista_engine_status_name(status)).decode())


def c_grid(grid: Grid) -> Any:
    """The C view of a control grid, which the caller keeps alive."""
    return library()[0].from_buffer("vista_frontend_offset[]", grid)


def prepare_rectify(image: Image, grid: Grid, out: Image) -> Callable[[], None]:
    """The same for rectification by a control grid."""
    c_image, c_out = _c_images(image, out)
    return lambda: _check(library()[1].vista_frontend_rectify(c_image, c_grid(grid), c_out, out.strides[0]))


def reduced_shape(shape: tuple[int, ...]) -> tuple[int, int]:
    height, width = map(library()[1].vista_frontend_reduced_px, shape)
    return height, width
