"""Recordings of words: of the board flight, and of rectified cameras."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from board_flight import UP_WORLD, WORLD_FROM_CAMERA, BoardFrame
from numpy.typing import NDArray
from pipeline_library import CALIBRATION
from vista import parameters
from vista.geometry import Pose
from vista.recording import Content, Recorder, rectified_source
from vista.rectify import Rectifier
from vista.sequence import Frame


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
    source = rectified_source(CALIBRATION, stills, None if stills else UP_WORLD)
    with Recorder(path, source, Rectifier(source.calibration), values, Content.LEFT) as recorder:
        for index, board in enumerate(sources):
            pose = None if stills else Pose(WORLD_FROM_CAMERA, board.position_m)
            recorder.write(
                Frame(index, board.t_ns, board.left, board.left, pose), levels_of(board, levels), stills
            )
    return path
