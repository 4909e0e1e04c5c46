"""A small recording of the board flight, and its parts to be damaged."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from board_flight import UP_WORLD, WORLD_FROM_CAMERA, BoardFrame
from numpy.typing import NDArray
from pipeline_library import CALIBRATION
from vista import parameters
from vista.geometry import CameraModel, Pose, RawCalibration, camera_matrix
from vista.recording import FRAME, HEADER, PARAMETER, Recorder
from vista.sequence import Frame, Sequence

PARAMETER_COUNT = len(parameters.flat(parameters.defaults()))
PARAMETERS_AT = HEADER.size
FRAMES_AT = PARAMETERS_AT + PARAMETER_COUNT * PARAMETER.size
FRAME_BYTES = FRAME.size + 3 * CALIBRATION.width * CALIBRATION.height


def board_sequence(stills: bool = False) -> Sequence:
    matrix = camera_matrix(CALIBRATION.focal_px, CALIBRATION.focal_px, CALIBRATION.cx, CALIBRATION.cy)
    camera = CameraModel(CALIBRATION.width, CALIBRATION.height, matrix)
    motion = Pose(np.eye(3), np.array([-CALIBRATION.baseline_m, 0.0, 0.0]))
    raw = RawCalibration(camera, camera, motion, "board flight")
    up_world = None if stills else UP_WORLD
    return Sequence("board", "pairs", raw, frames=(), up_world=up_world, stills=stills)


def levels_of(source: BoardFrame, levels: int) -> list[NDArray[np.int16]]:
    """The words as a pyramid would have them."""
    return [
        np.where(words < 0, words, words >> k)
        for k, words in enumerate(source.words[:: 1 << k, :: 1 << k] for k in range(levels))
    ]


def record(
    path: Path,
    sources: Iterable[BoardFrame],
    values: parameters.Values | None = None,
    stills: bool = False,
    levels: int = 1,
) -> Path:
    """Stills have neither pose nor up direction."""
    values = values or parameters.defaults()
    values = values | {"stereo": values["stereo"] | {"levels": levels}}
    with Recorder(path, board_sequence(stills), CALIBRATION, values) as recorder:
        for index, source in enumerate(sources):
            pose = None if stills else Pose(WORLD_FROM_CAMERA, source.position_m)
            recorder.write(
                Frame(index, source.t_ns, source.left, source.left, pose), levels_of(source, levels), stills
            )
    return path
