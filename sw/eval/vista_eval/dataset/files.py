"""Files of a rendered flight; each appears as a whole or not at all, also when rendering is interrupted."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np
from vista.output import make_folder


def write_bytes(path: Path, content: bytes) -> None:
    make_folder(path.parent)
    partial = path.with_name(path.name + ".partial")
    partial.write_bytes(content)
    partial.replace(path)


def write_text(path: Path, lines: Iterable[str]) -> None:
    write_bytes(path, ("\n".join(lines) + "\n").encode())


def write_image(path: Path, image: np.ndarray) -> None:
    ok, png = cv2.imencode(".png", image)
    if not ok:
        raise OSError(f"{path}: cannot encode the image")
    write_bytes(path, png.tobytes())
