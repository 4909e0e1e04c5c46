"""OpenCV's block matcher as an engine."""

from __future__ import annotations

from vista.engine.contract import Disparity, EngineParameters, Image, check_images, check_parameters


class OpenCvEngine:
    """OpenCV's StereoBM set to the contract, for comparison; prefilter none and the check are not its own."""

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

    def check_size(self, width_px: int, height_px: int) -> None:
        """OpenCV takes any."""

    def compute(self, left: Image, right: Image) -> Disparity:
        """Disparity words of the left image."""
        check_images(left, right)
        return self._matcher.compute(left, right)
