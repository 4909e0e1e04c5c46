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
from typing import Any

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
from vista_eval.cell_graph import PADDING, OpenPipeline
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
        self.pipeline = JudgingPipeline(camera, at_first_sight(values))

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
        region_of_pixel = self.pipeline.refine_boundaries(region_of_cell)
        verdicts = self.pipeline.judge_regions(result.words, region_of_cell, region_of_pixel)
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


class JudgingPipeline(OpenPipeline):
    """The host's verdict on any partition of the frame that it processed last."""

    def judge_regions(
        self,
        words: NDArray[np.int16],
        region_of_cell: NDArray[np.int32],
        region_of_pixel: NDArray[np.int32],
    ) -> list[str]:
        """One a region; all regions are taken for grown from disparities of their own. Pixels of the ground
        at the foot of obstacles leave region_of_pixel, as they leave the host's own regions."""
        ffi, lib = self._ffi, self._lib
        frame = lib.vista_pipeline_look(self._pipeline)
        words = np.ascontiguousarray(words)
        label = np.ascontiguousarray(region_of_cell, np.int32)
        f = frame.foveation
        u, v = (self._array(pixels, region_of_pixel.size, np.int16) for pixels in (f.pixel_u, f.pixel_v))
        listed = np.pad(region_of_pixel[v, u].astype(np.int32), (0, PADDING))
        count = int(label.max()) + 1
        segmentation = ffi.new("vista_segmentation *")
        segmentation.label = ffi.cast("int32_t *", label.ctypes.data)
        segmentation.region_count = segmentation.obstacle_count = count
        refinement = ffi.new("vista_refinement *")
        refinement.listed = ffi.cast("int32_t *", listed.ctypes.data)
        drawn = np.ascontiguousarray(region_of_pixel, np.int32)
        refinement.label = ffi.cast("int32_t *", drawn.ctypes.data)
        border = np.ones(label.size, np.uint8)
        refinement.border = ffi.cast("uint8_t *", border.ctypes.data)
        height, width = words.shape
        image = ffi.new(
            "vista_disparity_image *", (ffi.cast("int16_t *", words.ctypes.data), width, height, width)
        )
        regions, memory = self._lay_out_regions(frame.foveation)
        self._check(
            lib.vista_regions_compute(
                frame.foveation,
                ffi.addressof(self._parameters[0], "region"),
                self._c_camera,
                ffi.new("double[3]", [0.0, -1.0, 0.0]),
                self._parameters.surface.horizontal_deg,
                frame.matched,
                image,
                frame.cells,
                frame.surfaces,
                segmentation,
                refinement,
                regions,
            )
        )
        self._check(
            lib.vista_footing_clear(
                ffi.addressof(self._parameters[0], "region"),
                self._c_camera,
                image,
                frame.surfaces,
                regions,
                refinement,
            )
        )
        np.copyto(region_of_pixel, drawn)
        verdicts = [regions.items[k].verdict for k in range(count)]
        del memory  # the regions lay in it
        return [ffi.string(lib.vista_region_verdict_name(verdict)).decode() for verdict in verdicts]

    def _lay_out_regions(self, foveation: Any) -> tuple[Any, Any]:
        ffi, lib = self._ffi, self._lib
        regions, arena = ffi.new("vista_regions *"), ffi.new("vista_arena *")
        self._check(lib.vista_regions_layout(regions, arena, foveation))
        memory = ffi.new("unsigned char[]", arena.used + 64)
        base = int(ffi.cast("uintptr_t", memory))
        arena.base = ffi.cast("unsigned char *", base + -base % 64)
        arena.size, arena.used = arena.used, 0
        self._check(lib.vista_regions_layout(regions, arena, foveation))
        return regions, memory
