"""The engine in C (model/c), the reference of all engines."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from vista import native
from vista.engine.contract import Disparity, EngineParameters, Image, check_images, check_parameters
from vista.engine.frontend import LevelEngine, c_front_end

_SCRATCH_ALIGNMENT = 64


class StereoEngine(LevelEngine):
    """The stereo engine in C. It holds its working memory, so each thread needs an object of its own.

    :param num_disparities: disparities that are searched, 16, 32 .. 256
    :param block_size: side of the block that is matched, odd, 5 .. 21 px
    :param prefilter: ``xsobel`` or ``none``
    :param prefilter_cap: limit of the prefilter's response, 1 .. 63 grey levels
    :param texture_threshold: texture that a block needs to be matched
    :param uniqueness_ratio: margin of the best match over the others, 0 .. 100 percent
    :param lr_max_diff: largest difference that the left/right check accepts, px; None: no check
    :param threads: number of threads among which the rows are divided; the words do not depend on it
    :param smooth: smooth both images before matching
    :param levels: number of pyramid levels; `compute` gives the words of the first level, `compute_levels` a
        list with those of every level
    :param isa: ``auto``, ``portable``, ``avx2``, ``avx512`` or ``neon``; the words do not depend on it
    """

    def __init__(
        self,
        num_disparities: int = 32,
        block_size: int = 11,
        prefilter: str = "xsobel",
        prefilter_cap: int = 31,
        texture_threshold: int = 10,
        uniqueness_ratio: int = 15,
        lr_max_diff: int | None = 1,
        threads: int = 1,
        *,
        smooth: bool = False,
        levels: int = 1,
        isa: str = "auto",
    ) -> None:
        self.parameters = EngineParameters(
            num_disparities,
            block_size,
            prefilter,
            prefilter_cap,
            texture_threshold,
            uniqueness_ratio,
            lr_max_diff,
            smooth,
            levels,
        )
        check_parameters(self.parameters)
        self._ffi, self._lib = native.load("vista_engine")
        if not isinstance(threads, int) or not 1 <= threads <= self._lib.VISTA_ENGINE_MAX_THREADS:
            most = self._lib.VISTA_ENGINE_MAX_THREADS
            raise ValueError(f"threads must be from 1 to {most}, not {threads!r}")
        self.threads = threads
        self._params = self._c_params(isa)
        self._check(self._lib.vista_engine_validate(self._params))
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None
        front_end = c_front_end(self._params.isa)
        self._front_end = replace(front_end, map=self._pool.map) if self._pool else front_end
        self._scratch = np.empty((threads, 0), np.uint8)

    def check_size(self, width_px: int, height_px: int) -> None:
        self._scratch_for(width_px, height_px)

    def compute_with_smin(self, left: Image, right: Image) -> tuple[Disparity, npt.NDArray[np.uint32]]:
        """Words of level 0 and the smallest cost of every matched pixel, valid or not, else 2**32 - 1."""
        check_images(left, right)
        smin = np.empty(left.shape, np.uint32)
        pair = next(self._front_end.pairs(left, right, self.parameters))
        return self._match(*pair, smin), smin

    def _c_params(self, isa: str) -> Any:
        isas = _isas(self._lib)
        if isa not in isas:
            raise ValueError(f"isa must be one of {', '.join(isas)}, not {isa!r}")
        values: dict[str, Any] = asdict(self.parameters)
        del values["smooth"], values["levels"]  # the front end's
        values["prefilter"] = getattr(self._lib, f"VISTA_ENGINE_PREFILTER_{values['prefilter'].upper()}")
        values["lr_max_diff"] = self.parameters.lr_number
        return self._ffi.new("vista_engine_params *", {**values, "isa": isas[isa]})

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status)

    def _match(self, left: Image, right: Image, smin: npt.NDArray[np.uint32] | None = None) -> Disparity:
        left, right = np.ascontiguousarray(left), np.ascontiguousarray(right)
        height, width = left.shape
        disparity = np.empty((height, width), np.int16)
        ffi = self._ffi
        images = ffi.new(
            "vista_engine_images *",
            (
                ffi.from_buffer("uint8_t[]", left),
                ffi.from_buffer("uint8_t[]", right),
                width,
                height,
                width,
                width,
            ),
        )
        smin_data = ffi.NULL if smin is None else ffi.from_buffer("uint32_t[]", smin)
        output = ffi.new(
            "vista_engine_output *", (ffi.from_buffer("int16_t[]", disparity), smin_data, width, width)
        )
        scratch = self._scratch_for(width, height)

        def band(index: int) -> int:
            first, end = (height * i // self.threads for i in (index, index + 1))
            data = ffi.from_buffer("uint8_t[]", scratch[index])
            compute_rows = self._lib.vista_engine_compute_rows
            return int(compute_rows(self._params, images, output, first, end, data, len(data)))

        if self._pool is None:
            self._check(band(0))
        else:
            for status in self._pool.map(band, range(self.threads)):
                self._check(status)
        return disparity

    def _scratch_for(self, width: int, height: int) -> npt.NDArray[np.uint8]:
        """Aligned working memory, one row a thread; kept, and grown when an image needs more."""
        one = self._lib.vista_engine_scratch_bytes(self._params, width, height, 1)
        if one == 0:
            raise ValueError(f"images must be at most {self._lib.VISTA_ENGINE_MAX_SIDE_PX} px a side")
        if one > self._scratch.shape[1]:
            memory = np.empty(one * self.threads + _SCRATCH_ALIGNMENT, np.uint8)
            start = -memory.ctypes.data % _SCRATCH_ALIGNMENT
            self._scratch = memory[start : start + one * self.threads].reshape(self.threads, one)
        return self._scratch


def _isas(lib: Any) -> dict[str, int]:
    names = ("auto", "portable", "avx2", "avx512", "neon")
    return {name: getattr(lib, f"VISTA_ENGINE_ISA_{name.upper()}") for name in names}
