"""The rivals: the detector as configured and what stands beside it. Frames in, regions and obstacles out.

as configured         the project's engine and host
spanning forest       the cut's own seeds, shells, links, merging and refinement; a maximum spanning forest
                      divides what the cut divides (segmentation.solver)
SGBM words            the words of OpenCV's StereoSGBM, three ways, in the same host
smoothed images       the engine's words of smoothed images (stereo.smooth)
four paths            of the same images, those of a matcher whose costs follow four paths of one pass
                      (baselines.four_paths), on all of the engine's levels
perfect disparities   the true disparity of every pixel, rounded to the engine's words, on all of its levels:
                      what is nearer than a level matches, or is sky, has none. An upper bound for the engine
place vote            the engine's words at places along the path in the last six frames, with neither regions
                      nor tracks (baselines.place_vote): one warning a frame at most, and no free space
reference method      the engine's words and the host's graph, partitioned without a cut
                      (baselines.reference_method); the host judges these regions as it judges its own
stereo alone          words thresholded and clustered (baselines.stereo_alone); every cluster is an obstacle.
                      It knows no ground: a road that matches is one, too. On flights it is scored at each of
                      many thresholds, with the host's tracker (baselines.tracked_stereo)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.chain import Step, engine_parameters
from vista.engine import (
    INVALID,
    SCALE,
    Disparity,
    Engine,
    EngineParameters,
    Image,
    StereoEngine,
    create_engine,
)
from vista.geometry import Calibration
from vista.history import FrameRecord
from vista.pipeline import Result
from vista.rectify import Rectifier

from vista_eval.baselines.four_paths import FourPathsEngine
from vista_eval.baselines.place_vote import vote
from vista_eval.baselines.reference_method import ReferenceParameters, merge_cells
from vista_eval.baselines.stereo_alone import Threshold, label_clusters, thresholded
from vista_eval.cache import code_digest, digest_of
from vista_eval.cell_graph import CellGraph, OpenPipeline
from vista_eval.dataset.stereo_pair import TruthPair
from vista_eval.dataset.truth import TRUTH, FlightTruth, read_truth
from vista_eval.fly import flight_digest, fly, fly_cached, judged, kept_records, open_flight
from vista_eval.metrics.standing_points import ACCEPTED, Judged

OURS, FOREST, SGBM, PERFECT = "as configured", "spanning forest", "SGBM words", "perfect disparities"
REFERENCE, ALONE, VOTE = "reference method", "stereo alone", "place vote"
SMOOTHED, PATHS = "smoothed images", "four paths"
# Without a false alarm on nine flights that nothing was chosen on, and it finds most of what stands there.
ALONE_THRESHOLD = Threshold(texture=2000, uniqueness=20, sad=62.0, pixels=80)
SGBM_BLOCK, SGBM_UNIQUENESS = 5, 10
SGBM_SPECKLE_PIXELS, SGBM_SPECKLE_PX = 100, 2


def as_judged(_: Calibration, steps: Iterator[Step]) -> Iterator[FrameRecord]:
    return map(judged, steps)


class Rival(Protocol):
    @property
    def name(self) -> str: ...

    def judge(self, camera: OneCamera, pair: TruthPair) -> Judged:
        """What it makes of a pair by itself."""


class OneCamera:
    """The host for pairs of one camera, each by itself; a pipeline for each set of parameters."""

    def __init__(self, camera: Calibration, values: parameters.Values) -> None:
        self.camera, self.values = camera, values
        self._made: dict[str, tuple[Engine, OpenPipeline]] = {}

    def of(self, rival: InHost) -> tuple[Engine, OpenPipeline]:
        if rival.name not in self._made:
            values = at_first_sight(rival.values(self.values))
            self._made[rival.name] = rival.engine_of(values, None), OpenPipeline(self.camera, values)
        return self._made[rival.name]


@dataclass(frozen=True)
class InHost:
    """The project's host with one thing exchanged: parameters, the engine, the cut, or what is made of a
    flight's frames."""

    name: str
    values: Callable[[parameters.Values], parameters.Values] = lambda values: values
    engine: Callable[[EngineParameters, FlightTruth | None], Engine] | None = None
    partition: Callable[[CellGraph], NDArray[np.int32]] | None = None
    records: Callable[[Calibration, Iterator[Step]], Iterator[FrameRecord]] = as_judged

    def engine_of(self, values: parameters.Values, truth: FlightTruth | None) -> Engine:
        stereo = engine_parameters(values)
        return create_engine("golden", stereo) if self.engine is None else self.engine(stereo, truth)

    def process(self, camera: OneCamera, pair: TruthPair) -> Result:
        engine, pipeline = camera.of(self)
        pipeline.reset()
        return pipeline.process(pair.left, list(engine.levels(pair.left, pair.right)), t_ns=0)

    def judge(self, camera: OneCamera, pair: TruthPair) -> Judged:
        result = self.process(camera, pair)
        if self.partition is None:
            return Judged(result.words, result.region_of_pixel, result.verdict_of_region)
        _, pipeline = camera.of(self)
        return Judged(result.words, *pipeline.judge_partition(self.partition(pipeline.cell_graph())))

    def fly(self, folder: Path, values: parameters.Values) -> list[FrameRecord]:
        """The records of a whole flight. No other partition than the host's own is tracked."""
        assert self.partition is None
        values = self.values(values)
        engine = None if self.engine is None else self.engine_of(values, read_truth(folder))
        sequence = open_flight(folder)
        camera = Rectifier(sequence.calibration).calibration
        return list(self.records(camera, fly(sequence, values, engine)))

    def fly_cached(self, folder: Path, values: parameters.Values, cache: Path) -> list[FrameRecord]:
        """Records from `cache`, if of this flight, chain, rival and parameters; else flown."""
        if self.name == OURS:
            return fly_cached(folder, values, cache)
        digest = digest_of(self.name, flight_digest(folder, values), code_digest(__name__), folder / TRUTH)
        return kept_records(cache, digest, lambda: self.fly(folder, values))


class Clusters:
    """Stereo alone at one threshold."""

    name = ALONE

    def judge(self, camera: OneCamera, pair: TruthPair) -> Judged:
        stereo, at = engine_parameters(camera.values), ALONE_THRESHOLD
        engine = StereoEngine(**asdict(thresholded(stereo, at.texture, at.uniqueness)))
        words, smin = engine.compute_with_smin(pair.left, pair.right)
        good = np.where(smin <= at.sad * stereo.block_size**2, words, np.int16(INVALID))
        label = label_clusters(good, at.pixels)
        return Judged(good, label, [ACCEPTED] * (int(label.max(initial=-1)) + 1))


def at_first_sight(values: parameters.Values) -> parameters.Values:
    """What one frame shows is confirmed in that frame."""
    return values | {"tracker": values["tracker"] | {"confirm_hits": 1, "confirm_window": 1}}


def at_one_level(values: parameters.Values) -> parameters.Values:
    return values | {"stereo": values["stereo"] | {"levels": 1}}


def with_forest(values: parameters.Values) -> parameters.Values:
    return values | {"segmentation": values["segmentation"] | {"solver": "forest"}}


def with_smoothing(values: parameters.Values) -> parameters.Values:
    return values | {"stereo": values["stereo"] | {"smooth": "binomial3"}}


def merged(graph: CellGraph) -> NDArray[np.int32]:
    return merge_cells(graph.edges, graph.affinity, graph.horizontal, ReferenceParameters())


# ---- engines ----


def make_sgbm(
    stereo: EngineParameters,
) -> Callable[[NDArray[np.uint8], NDArray[np.uint8]], NDArray[np.int16]]:
    """Words of a left and a right image."""
    area = SGBM_BLOCK**2
    matcher = cv2.StereoSGBM.create(
        minDisparity=0,
        numDisparities=stereo.num_disparities,
        blockSize=SGBM_BLOCK,
        P1=8 * area,
        P2=32 * area,
        disp12MaxDiff=1,
        uniquenessRatio=SGBM_UNIQUENESS,
        speckleWindowSize=SGBM_SPECKLE_PIXELS,
        speckleRange=SGBM_SPECKLE_PX,
        mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    )

    def words(left: NDArray[np.uint8], right: NDArray[np.uint8]) -> NDArray[np.int16]:
        found = np.asarray(matcher.compute(left, right), np.int16)
        return np.where(found < 0, np.int16(INVALID), found)

    return words


class SgbmEngine:
    """OpenCV's StereoSGBM: one level."""

    def __init__(self, parameters: EngineParameters, _: FlightTruth | None) -> None:
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

    def __init__(self, parameters: EngineParameters, truth: FlightTruth | None) -> None:
        assert truth is not None, "only rendered flights have a disparity at every pixel"
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


# ---- the registry ----

DETECTOR = InHost(OURS)
IN_HOST = {
    rival.name: rival
    for rival in (
        DETECTOR,
        InHost(FOREST, values=with_forest),
        InHost(SGBM, values=at_one_level, engine=SgbmEngine),
        InHost(SMOOTHED, values=with_smoothing),
        InHost(PATHS, values=with_smoothing, engine=lambda stereo, _: FourPathsEngine(stereo)),
        InHost(PERFECT, engine=TruthEngine),
        InHost(VOTE, records=vote),
        InHost(REFERENCE, partition=merged),
    )
}
RIVALS: dict[str, Rival] = {**IN_HOST, ALONE: Clusters()}
OF_FLIGHTS = (OURS, FOREST, SGBM, PERFECT, VOTE)
ASKED_FOR = (*OF_FLIGHTS[1:], SMOOTHED, PATHS)  # beside the detector; the last two fly only if they are named
OF_PAIRS = (OURS, REFERENCE, SGBM, ALONE)
