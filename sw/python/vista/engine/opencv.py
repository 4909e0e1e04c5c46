"""OpenCV's block matcher as an engine."""

from __future__ import annotations

import numpy as np

from vista.engine.contract import INVALID, Disparity, EngineParameters, Image, check_parameters
from vista.engine.frontend import FrontEnd, LevelEngine


class OpenCvEngine(LevelEngine):
    """OpenCV's StereoBM, GaussianBlur and pyrDown set to the contract, for comparison.

    StereoBM has no matching without prefilter, and its left/right check compares other things."""

    def __init__(self, parameters: EngineParameters) -> None:
        import cv2

        check_parameters(parameters)
        if parameters.prefilter != "xsobel":
            raise ValueError("engine opencv: prefilter must be xsobel")
        if parameters.lr_max_diff is not None:
            raise ValueError("engine opencv: lr_max_diff must be off")
        self.parameters = parameters
        self._matcher = cv2.StereoBM.create(parameters.num_disparities, parameters.block_size)
        self._matcher.setMinDisparity(0)
        self._matcher.setPreFilterType(cv2.STEREO_BM_PREFILTER_XSOBEL)
        self._matcher.setPreFilterCap(parameters.prefilter_cap)
        self._matcher.setTextureThreshold(parameters.texture_threshold)
        self._matcher.setUniquenessRatio(parameters.uniqueness_ratio)
        self._matcher.setDisp12MaxDiff(-1)
        self._matcher.setSpeckleWindowSize(0)
        self._front_end = FrontEnd(
            smooth=lambda image: np.asarray(cv2.GaussianBlur(image, (3, 3), 0), np.uint8),
            reduce=lambda image: np.asarray(cv2.pyrDown(image), np.uint8),
        )

    def check_size(self, width_px: int, height_px: int) -> None:
        """OpenCV takes any."""

    def _match(self, left: Image, right: Image) -> Disparity:
        height, width = left.shape
        if not self.parameters.matches(width, height):  # StereoBM's words would mean nothing
            return np.full(left.shape, INVALID, np.int16)
        if height == self.parameters.block_size:
            raise ValueError(
                f"engine opencv: {width}x{height} px is no higher than a block, StereoBM refuses it"
            )
        return np.asarray(self._matcher.compute(left, right), np.int16)
