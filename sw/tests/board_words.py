"""Pairs for the sensors of a board, and the lines that the detector should make of their words alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import sequence_cases as cases
from command_line import without_time
from numpy.typing import NDArray
from vista import parameters
from vista.chain import Chain, finish, make_chain, take
from vista.history import StageClock
from vista.obstacle_line import obstacle_line
from vista.sequence import Frame, Sequence
from vista.sequence.pairs import read_calibration_file

WIDTH, HEIGHT = 160, 120
CONFIG = """[stereo]
num_disparities = 16
block_size = 5
smooth = "binomial3"
levels = 2
rectify_rows = 16
"""
CAMERA = """[{}]
fx_px = 150.0
fy_px = 150.0
cx = 80.0
cy = 60.0
distortion = [{}, 0.0, 0.0, 0.0]
"""
BASELINE = """[right_from_left]
rotation = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
translation_m = [-0.5, 0.0, 0.0]
"""
Pair = tuple[NDArray[np.uint8], NDArray[np.uint8]]


def shown_pairs(count: int) -> list[Pair]:
    """A board before a wall, elsewhere and at another distance in each pair."""
    pairs = []
    for k in range(count):
        left, right = cases.texture_pair(0, WIDTH, HEIGHT)
        near, _ = cases.texture_pair(1, 30, 60)
        for image, shift in ((left, 0), (right, 12 - k)):
            image[30:90, 65 + 10 * k - shift : 95 + 10 * k - shift] = near
        pairs.append((left, right))
    return pairs


def written(folder: Path) -> tuple[Path, Path]:
    """calibration.toml of raw cameras, and a file of parameters."""
    config = folder / "parameters.toml"
    config.write_text(CONFIG)
    calibration = folder / "calibration.toml"
    calibration.write_text(CAMERA.format("left", -0.02) + CAMERA.format("right", -0.015) + BASELINE)
    return calibration, config


def chain_of(calibration: Path, config: Path) -> Chain:
    """That of `vista live`, with the engine in C."""
    described = read_calibration_file(calibration, (WIDTH, HEIGHT)).calibration
    cameras = Sequence("board", "camera", described, ())
    return make_chain(cameras, "golden", parameters.load(config), 1, every_pair=False)


class WordsAlone:
    """The engine in C matches pairs, and a detector of its own gets their words alone."""

    def __init__(self, calibration: Path, config: Path) -> None:
        self._matching, self.chain = chain_of(calibration, config), chain_of(calibration, config)
        self._time_ns = 0

    def line(self, pair: Pair, number: int, t_ns: int, restarts: bool = False) -> str:
        """The line of a pair with this number and time, without what it took."""
        words = self.words(pair)
        frame = Frame(number, t_ns, *pair, None, tuple(words))
        take(self.chain, frame, restarts)
        return without_time(obstacle_line(finish(self.chain, frame, StageClock()).record))

    def words(self, pair: Pair) -> list[NDArray[np.int16]]:
        """Those of each level."""
        self._time_ns += 1
        take(self._matching, Frame(0, self._time_ns, *pair, None), restarts=True)
        self._matching.detector.match()
        return self._matching.detector.pair().levels


def raw_bytes(pairs: list[Pair]) -> bytes:
    return b"".join(image.tobytes() for pair in pairs for image in pair)
