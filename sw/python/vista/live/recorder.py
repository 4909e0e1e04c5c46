"""Writes what cameras see as a folder of pairs (vista.sequence.pairs), whole at every moment."""

from __future__ import annotations

import time
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.live.source import Shot
from vista.output import LineFile, make_folder, write_atomically
from vista.sequence.pairs import CALIBRATION, TIMES

FAST = [cv2.IMWRITE_PNG_COMPRESSION, 1]  # more takes longer than there is between two frames


class PairFolder:
    """NNNNNN_left.png, NNNNNN_right.png and times.csv, which names a pair once both images are there."""

    def __init__(self, path: Path, calibration: str | None) -> None:
        """calibration: the text of a calibration.toml that is put beside the pairs. Raises InputError for a
        folder that holds anything, and for one that cannot be written."""
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            raise InputError(path, "not an empty folder: name one that is new")
        make_folder(path)
        if calibration is not None:
            write_atomically(path / CALIBRATION, calibration.encode())
        self._path, self.pairs = path, 0
        self._times: LineFile | None = None
        # Cameras are timed by a clock that never leaps; poses from elsewhere count by the clock of the day.
        self._day_ns = time.time_ns() - time.monotonic_ns()

    def write(self, shot: Shot) -> str:
        """The name of the pair. Raises InputError if the disk is full."""
        name = f"{self.pairs:06d}"
        images = [
            (side, png(image)) for side, image in (("left", shot.frame.left), ("right", shot.frame.right))
        ]
        for side, data in images:
            write_atomically(self._path / f"{name}_{side}.png", data)
        if self._times is None:
            self._times = LineFile(self._path / TIMES)
            self._times.write_line("name,t_ns")
        self._times.write_line(f"{name},{shot.exposed_ns + self._day_ns}")
        self.pairs += 1
        return name

    def close(self) -> None:
        if self._times is not None:
            self._times.close()


def png(image: NDArray[np.uint8]) -> bytes:
    return bytes(cv2.imencode(".png", image, FAST)[1])
