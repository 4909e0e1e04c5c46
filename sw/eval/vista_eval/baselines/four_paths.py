"""A matcher that an FPGA could hold beside the engine's: census or SAD costs along four paths of one pass (C,
src/four_paths.h). Its words go through the detector as the rival "four paths".

    python -m vista_eval.baselines.four_paths    # its processor time for an image, by turns with the engine's
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, replace

import numpy as np
from vista import native
from vista.engine import Disparity, EngineParameters, Image, StereoEngine
from vista.engine.frontend import LevelEngine, c_front_end

_ALIGNMENT = 64


@dataclass(frozen=True)
class PathCosts:
    """What is aggregated, and how. `near` and `far` are the P1 and P2 of semi-global matching."""

    cost: str = "sad"  # or census
    near: int = 16
    far: int = 96
    texture_threshold: int = 600
    uniqueness_ratio: int = 40


CHOSEN = PathCosts()


class FourPathsEngine(LevelEngine):
    """Candidates, left/right check and pyramid as the engine's parameters say."""

    def __init__(self, parameters: EngineParameters, costs: PathCosts = CHOSEN) -> None:
        self.parameters = parameters
        self._front_end = c_front_end()
        self._ffi, self._lib = native.load("vista_render")
        values = asdict(costs) | {"num_disparities": parameters.num_disparities}
        values["cost"] = getattr(self._lib, f"VISTA_PATHS_{costs.cost.upper()}")
        self._params = self._ffi.new("vista_paths_params *", values | {"lr_max_diff": parameters.lr_number})
        self._scratch = np.empty(0, np.uint8)
        self.check_size(1, 1)

    def check_size(self, width_px: int, height_px: int) -> None:
        self._check(self._lib.vista_paths_refused(self._params, width_px, height_px))

    def _match(self, left: Image, right: Image) -> Disparity:
        left, right = np.ascontiguousarray(left), np.ascontiguousarray(right)
        height, width = left.shape
        self.check_size(width, height)
        needed = self._lib.vista_paths_scratch_bytes(self._params, width, height)
        if needed > len(self._scratch):
            memory = np.empty(needed + _ALIGNMENT, np.uint8)
            start = -memory.ctypes.data % _ALIGNMENT
            self._scratch = memory[start : start + needed]
        words = np.empty(left.shape, np.int16)
        buffer = self._ffi.from_buffer
        images = [buffer("uint8_t[]", image) for image in (left, right)]
        out, scratch = buffer("int16_t[]", words), buffer("uint8_t[]", self._scratch)
        self._check(self._lib.vista_paths_match(self._params, *images, width, height, out, scratch))
        return words

    def _check(self, refused: object) -> None:
        if refused != self._ffi.NULL:
            raise ValueError(self._ffi.string(refused).decode())


def main(turns: int = 101) -> None:
    """Medians on images of 640x480 px that show a texture 10 px apart."""
    texture = np.random.default_rng(1).integers(0, 256, (480, 650), np.uint8)
    left, right = texture[:, :640], texture[:, 10:]
    engines: dict[str, LevelEngine] = {}
    for count in (32, 64):
        parameters = EngineParameters(count)
        engines |= {f"engine, {count} disparities": StereoEngine(**asdict(parameters))}
        for cost in ("census", "sad"):
            paths = FourPathsEngine(parameters, replace(CHOSEN, cost=cost))
            engines |= {f"four paths, {cost}, {count} disparities": paths}
    times: dict[str, list[float]] = {name: [] for name in engines}
    for _ in range(turns):
        for name, engine in engines.items():
            start = time.thread_time()
            engine.compute(left, right)
            times[name].append(1e3 * (time.thread_time() - start))
    for name, taken in times.items():
        print(f"{name:34s}{np.median(taken):6.2f} ms")


if __name__ == "__main__":
    main()
