"""Text on pictures: outlined, sized to the picture, and placed where it covers no other label."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.palette import INK, Colour

FONT = cv2.FONT_HERSHEY_SIMPLEX


def text_scale(picture: NDArray[np.uint8]) -> float:
    return min(max(picture.shape[0] / 480.0, 0.8), 2.0) * 0.55


def text_size(text: str, scale: float) -> tuple[int, int]:
    """(width, height) in px, without the descenders."""
    (width, height), _ = cv2.getTextSize(text, FONT, scale, 1)
    return width, height


def put_text(picture: NDArray[np.uint8], text: str, x: int, y: int, scale: float, colour: Colour) -> None:
    """Baseline starts at (x, y); a dark outline keeps it legible on white."""
    cv2.putText(picture, text, (x, y), FONT, scale, INK, 4, cv2.LINE_AA)
    cv2.putText(picture, text, (x, y), FONT, scale, colour, 1, cv2.LINE_AA)


Box = tuple[int, int, int, int]  # left, top, right, bottom


class Labels:
    """Labels of one picture: first come, first placed; one that finds no free place is left out."""

    def __init__(self, picture: NDArray[np.uint8]) -> None:
        self._picture = picture
        self._scale = text_scale(picture)
        self._placed: list[tuple[str, Box, Colour]] = []

    def reserve(self, text: str, u: float, v: float, colour: Colour) -> None:
        """Wants the text centred above (u, v); tries a few places nearby."""
        if not np.isfinite([u, v]).all():
            return
        width, height = text_size(text, self._scale)
        rows, columns = self._picture.shape[:2]
        step = height + 6
        for shift in (0, -1, 1, -2, 2, 3):
            left = int(np.clip(u - width / 2, 3, max(columns - width - 3, 3)))
            bottom = int(np.clip(v - 6 + shift * step, height + 3, rows - 2 * step))
            box = (left - 2, bottom - height - 2, left + width + 2, bottom + 3)
            if not any(_overlap(box, other) for _, other, _ in self._placed):
                self._placed.append((text, box, colour))
                return

    def draw(self) -> None:
        for text, (left, _, _, bottom), colour in reversed(self._placed):
            put_text(self._picture, text, left + 2, bottom - 3, self._scale, colour)


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
