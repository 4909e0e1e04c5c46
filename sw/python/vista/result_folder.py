"""The folder that a run writes: obstacles.jsonl, frames/NNNNNN.jpg, summary.json, report.html.

Nothing is created before the first frame is done. Every file is whole or absent.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.output import LineFile, unwritable, write_atomically

OBSTACLES, SUMMARY, REPORT, FRAMES = "obstacles.jsonl", "summary.json", "report.html", "frames"
FRAME_PICTURE = re.compile(r"\d{6,}\.jpg")
JPEG_QUALITY = 88


def encoded(picture: NDArray[np.uint8]) -> bytes:
    """Encodes a picture as JPEG."""
    return bytes(cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1])


class ResultFolder:
    def __init__(self, path: Path) -> None:
        """Raises InputError when the path is a file, or a folder that holds anything but results."""
        self.path = path
        self.frames = path / FRAMES
        self._lines: LineFile | None = None
        if path.exists() and not path.is_dir():
            raise InputError(path, "not a folder")
        foreign = self._foreign_file() if path.is_dir() else None
        if foreign is not None:
            raise InputError(
                path, f"holds other files ({foreign}); name a new folder, or one of an earlier run"
            )

    def write_frame(self, index: int, line: str, jpeg: bytes | None) -> None:
        """The frame's picture, then its line: a line says that all of its frame is there."""
        lines = self._lines or self._create()
        if jpeg is not None:
            write_atomically(self.frame_path(index), jpeg)
        lines.write_line(line)

    def frame_path(self, index: int) -> Path:
        return self.frames / f"{index:06d}.jpg"

    def write_summary(self, summary: dict[str, Any]) -> None:
        write_atomically(self.path / SUMMARY, json.dumps(summary, indent=2, allow_nan=False) + "\n")

    def write_report(self, page: str) -> Path:
        write_atomically(self.path / REPORT, page)
        return self.path / REPORT

    def close(self) -> None:
        if self._lines is not None:
            self._lines.close()

    def _foreign_file(self) -> str | None:
        for entry in sorted(self.path.iterdir()):
            if entry.name == FRAMES and entry.is_dir():
                if all(FRAME_PICTURE.fullmatch(picture.name) for picture in entry.iterdir()):
                    continue
            elif entry.name in (OBSTACLES, SUMMARY, REPORT) and entry.is_file():
                continue
            return entry.name
        return None

    def _create(self) -> LineFile:
        """Makes the folder, without what an earlier run left in it."""
        try:
            self.frames.mkdir(parents=True, exist_ok=True)
            for stale in (self.path / SUMMARY, self.path / REPORT, *self.frames.iterdir()):
                stale.unlink(missing_ok=True)
        except OSError as error:
            raise unwritable(self.path, error) from None
        self._lines = LineFile(self.path / OBSTACLES)
        return self._lines
