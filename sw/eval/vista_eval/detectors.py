"""The detector and what stands beside it, each on one pair by itself: words, regions, and a verdict of each.

as configured       the project's engine and host
SGBM words          the words of OpenCV's StereoSGBM, three ways, in the same host
reference method    the engine's words and the host's graph, partitioned without a cut
                    (baselines.reference_method); the host judges these regions as it judges its own
stereo alone        words thresholded and clustered (baselines.stereo_alone); every cluster is an obstacle. It
                    knows no ground: a road that matches is one, too
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict

import cv2
import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import INVALID, Engine, EngineParameters, StereoEngine, create_engine
from vista.geometry import Calibration
from vista.pipeline import Result

from vista_eval.baselines.reference_method import ReferenceParameters, merge_cells
from vista_eval.baselines.stereo_alone import Threshold, label_clusters, thresholded
from vista_eval.cell_graph import OpenPipeline
from vista_eval.dataset.stereo_pair import TruthPair
from vista_eval.metrics.standing_points import ACCEPTED, Judged

OURS, SGBM, REFERENCE, ALONE = "as configured", "SGBM words", "reference method", "stereo alone"
# Without a false alarm on nine flights that nothing was chosen on, and it finds most of what stands there.
ALONE_THRESHOLD = Threshold(texture=2000, uniqueness=20, sad=62.0, pixels=80)
SGBM_BLOCK, SGBM_UNIQUENESS = 5, 10
SGBM_SPECKLE_PIXELS, SGBM_SPECKLE_PX = 100, 2


def at_first_sight(values: parameters.Values) -> parameters.Values:
    """What one frame shows is confirmed in that frame."""
    return values | {"tracker": values["tracker"] | {"confirm_hits": 1, "confirm_window": 1}}


class Detectors:
    """Detectors of the pairs of one camera."""

    def __init__(self, camera: Calibration, values: parameters.Values) -> None:
        stereo = engine_parameters(values)
        self._engine: Engine = create_engine("golden", stereo)
        self._alone = StereoEngine(
            **asdict(thresholded(stereo, ALONE_THRESHOLD.texture, ALONE_THRESHOLD.uniqueness))
        )
        self._block_pixels = stereo.block_size**2
        self._sgbm = make_sgbm(stereo)
        self.pipeline = OpenPipeline(camera, at_first_sight(values))

    def judge(self, pair: TruthPair) -> dict[str, Judged]:
        """Judgements by detector."""
        result = self.process(pair, self.levels(pair))
        return {
            OURS: Judged(result.words, result.region_of_pixel, result.verdict_of_region),
            REFERENCE: self._reference(pair, result),  # works on the frame processed last
            SGBM: self._with_words(pair, [self._sgbm(pair.left, pair.right)]),
            ALONE: self._stereo_alone(pair),
        }

    def process(self, pair: TruthPair, levels: list[NDArray[np.int16]]) -> Result:
        """The host on a pair by itself."""
        self.pipeline.reset()
        return self.pipeline.process(pair.left, levels, t_ns=0)

    def levels(self, pair: TruthPair) -> list[NDArray[np.int16]]:
        return list(self._engine.levels(pair.left, pair.right))

    def _with_words(self, pair: TruthPair, levels: list[NDArray[np.int16]]) -> Judged:
        result = self.process(pair, levels)
        return Judged(result.words, result.region_of_pixel, result.verdict_of_region)

    def _reference(self, pair: TruthPair, result: Result) -> Judged:
        graph = self.pipeline.cell_graph()
        region_of_cell = merge_cells(graph.edges, graph.affinity, graph.horizontal, ReferenceParameters())
        region_of_pixel, verdicts = self.pipeline.judge_partition(region_of_cell)
        return Judged(result.words, region_of_pixel, verdicts)

    def _stereo_alone(self, pair: TruthPair) -> Judged:
        words, smin = self._alone.compute_with_smin(pair.left, pair.right)
        kept = np.where(smin <= ALONE_THRESHOLD.sad * self._block_pixels, words, np.int16(INVALID))
        label = label_clusters(kept, ALONE_THRESHOLD.pixels)
        return Judged(kept, label, [ACCEPTED] * (int(label.max(initial=-1)) + 1))


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
