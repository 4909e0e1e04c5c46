"""Stereo engines: parameters and two rectified images in, one disparity image out.

    import vista
    disparity = vista.StereoEngine(num_disparities=32, block_size=11).compute(left, right)

Images are uint8, height x width, rectified, left is the reference. Disparities are int16 in 1/16 px of the
left image, -16 where there is none. doc/design/engine-contract.md defines them to the bit.
"""

from vista.engine.board import BoardEngine
from vista.engine.contract import INVALID, LR_OFF, SCALE, Disparity, Engine, EngineParameters, Image
from vista.engine.create import ENGINES, RECTIFYING_ENGINES, REMOTE_ENGINES, create_engine
from vista.engine.golden import StereoEngine
from vista.engine.opencv import OpenCvEngine
from vista.engine.rtl import RtlEngine

__all__ = [
    "ENGINES",
    "INVALID",
    "LR_OFF",
    "RECTIFYING_ENGINES",
    "REMOTE_ENGINES",
    "SCALE",
    "BoardEngine",
    "Disparity",
    "Engine",
    "EngineParameters",
    "Image",
    "OpenCvEngine",
    "RtlEngine",
    "StereoEngine",
    "create_engine",
]
