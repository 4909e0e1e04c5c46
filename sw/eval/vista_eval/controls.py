"""What is flown beside the detector on the same flights, each through the same host: what its parts are
worth.

as configured         the project's engine and host
spanning forest       the cut's own seeds, shells, links, merging and refinement; a maximum spanning forest
                      divides what the cut divides (segmentation.solver)
SGBM words            the words of OpenCV's StereoSGBM, three ways
perfect disparities   the true disparity of every pixel, rounded to the engine's words, on all of its levels:
                      what is nearer than a level matches, or is sky, has none. An upper bound for the engine
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import INVALID, SCALE, Disparity, Engine, EngineParameters, Image
from vista.history import FrameRecord

from vista_eval.cache import code_digest, digest_of, kept
from vista_eval.dataset.truth import TRUTH, FlightTruth, read_truth
from vista_eval.detectors import OURS, SGBM, make_sgbm
from vista_eval.fly import (
    flight_digest,
    fly,
    fly_cached,
    judged,
    open_flight,
    read_record,
)

FOREST, PERFECT = "spanning forest", "perfect disparities"
CONTROLS = (OURS, FOREST, SGBM, PERFECT)


def with_forest(values: parameters.Values) -> parameters.Values:
    return values | {"segmentation": values["segmentation"] | {"solver": "forest"}}


def fly_control(control: str, folder: Path, values: parameters.Values) -> list[FrameRecord]:
    """control: of CONTROLS."""
    if control == FOREST:
        values = with_forest(values)
    engine: Engine | None = None
    if control == SGBM:
        engine = SgbmEngine(engine_parameters(values))
    elif control == PERFECT:
        engine = TruthEngine(engine_parameters(values), read_truth(folder))
    return [judged(step) for step in fly(open_flight(folder), values, engine)]


def control_cached(control: str, folder: Path, values: parameters.Values, cache: Path) -> list[FrameRecord]:
    """Records from `cache`, if of this flight, chain, control and parameters; else flown."""
    if control == OURS:
        return fly_cached(folder, values, cache)
    digest = digest_of(
        control,
        flight_digest(folder, values),
        code_digest(__name__),
        folder / TRUTH,
    )
    return kept(
        cache,
        digest,
        lambda: fly_control(control, folder, values),
        lambda records: [read_record(record) for record in records],
    )


class SgbmEngine:
    """OpenCV's StereoSGBM: one level."""

    def __init__(self, parameters: EngineParameters) -> None:
        self.parameters = parameters
        self._words = make_sgbm(parameters)

    def check_size(self, width_px: int, height_px: int) -> None:
        """It takes any."""

    def compute(self, left: Image, right: Image) -> Disparity:
        return self._words(left, right)

    def levels(self, left: Image, right: Image) -> Iterator[Disparity]:
        yield self.compute(left, right)


class TruthEngine:
    """The true disparities of a flight's frames, one after the other."""

    def __init__(self, parameters: EngineParameters, truth: FlightTruth) -> None:
        self.parameters = parameters
        self._truth = truth
        self._times_ns = iter(truth.times_ns)

    def check_size(self, width_px: int, height_px: int) -> None:
        """It takes any."""

    def compute(self, left: Image, right: Image) -> Disparity:
        return next(self.levels(left, right))

    def levels(self, left: Image, right: Image) -> Iterator[Disparity]:
        disparity_px = self._truth.disparity_px(next(self._times_ns))
        for level in range(self.parameters.levels):
            yield true_words(disparity_px, level, self.parameters.num_disparities)


def true_words(disparity_px: NDArray[np.float32], level: int, num_disparities: int) -> Disparity:
    """Words of a level of the pyramid without error; disparity_px: at level 0, 0 without a surface."""
    every = 1 << level
    words = np.rint(SCALE * disparity_px[::every, ::every] / every)
    valid = (words > 0) & (words <= SCALE * (num_disparities - 1))
    return np.where(valid, words, INVALID).astype(np.int16)
