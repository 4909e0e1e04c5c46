"""Files of a rendered flight; each appears as a whole or not at all, also when rendering is interrupted."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np
from vista.output import make_folder, write_atomically


def write_text(path: Path, lines: Iterable[str]) -> None:
    make_folder(path.parent)
    write_atomically(path, "\n".join(lines) + "\n")


def write_image(path: Path, image: np.ndarray) -> None:
    ok, png = cv2.imencode(".png", image)
    if not ok:
        raise OSError(f"{path}: cannot encode the image")
    make_folder(path.parent)
    write_atomically(path, png.tobytes())
