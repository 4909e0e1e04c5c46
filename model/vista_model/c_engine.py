"""The C library behind the reference's parameters, bare: what tests and benches of model/ compare."""

from __future__ import annotations

import functools
import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from vista_model.engine import Image, Parameters

_BUILD = Path(__file__).resolve().parents[2] / "build"
_ISAS = ("portable", "avx2", "avx512")


@functools.cache
def library() -> tuple[Any, Any]:
    """The cffi pair (ffi, lib) of libvista_engine."""
    binding, shared = _BUILD / "python" / "vista_engine_abi.py", _BUILD / "lib" / "libvista_engine.so"
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

    def compute(
        self, left: Image, right: Image, rows: tuple[int, int] | None = None
    ) -> tuple[npt.NDArray[np.int16], npt.NDArray[np.uint32]]:
        """Words and Smin; with `rows` only of first .. end-1, the others 0. Images may have a row stride."""
        ffi, lib = library()
        height, width = left.shape
        disparity, smin = np.zeros((height, width), np.int16), np.zeros((height, width), np.uint32)
        needed = lib.vista_engine_scratch_bytes(self._params, width, height, 1)
        if len(self._scratch) < needed:
            self._scratch = aligned_bytes(needed)

        def pointer(kind: str, array: npt.NDArray[Any]) -> Any:
            return ffi.cast(f"{kind} *", array.ctypes.data)

        sides = (pointer("uint8_t", left), pointer("uint8_t", right))
        images = ffi.new("vista_engine_images *", (*sides, width, height, left.strides[0], right.strides[0]))
        results = (pointer("int16_t", disparity), pointer("uint32_t", smin), width, width)
        output = ffi.new("vista_engine_output *", results)
        scratch = pointer("uint8_t", self._scratch)
        size = len(self._scratch)
        if rows is None:
            status = lib.vista_engine_compute(self._params, images, output, scratch, size)
        else:
            status = lib.vista_engine_compute_rows(self._params, images, output, *rows, scratch, size)
        if status != lib.VISTA_ENGINE_OK:
            raise ValueError(ffi.string(lib.vista_engine_status_name(status)).decode())
        return disparity, smin
