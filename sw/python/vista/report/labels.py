"""Text on pictures: on a dark ground, sized to the picture, and placed where it covers no other label."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.pipeline import ID_GROUND, ID_PLACE, ID_TOO_NEAR
from vista.report.palette import INK, Colour

FONT = cv2.FONT_HERSHEY_SIMPLEX
PADDING_PX = 4
NAME_WITHOUT_TRACK = {ID_TOO_NEAR: "too near", ID_GROUND: "ground", ID_PLACE: "in the way"}


def obstacle_name(obstacle_id: int) -> str:
    """The number of its track, or what it is."""
    return NAME_WITHOUT_TRACK.get(obstacle_id, f"#{obstacle_id}")


def counted(count: int, noun: str) -> str:
    """The count before its noun, which is in the plural unless it is one."""
    return f"{count} {noun}{'s' * (count != 1)}"


def text_scale(rows: int, columns: int) -> float:
    """Scale of OpenCV's font: it grows with the picture, so that a wide one can be shown small."""
    return 0.5 * min(max(rows / 480.0, columns / 800.0, 0.8), 2.5)


def text_size(text: str, scale: float) -> tuple[int, int]:
    """(width, height) in px, without the descenders."""
    (width, height), _ = cv2.getTextSize(text, FONT, scale, 1)
    return width, height


def put_text(
    picture: NDArray[np.uint8],
    text: str,
    x: int,
    y: int,
    scale: float,
    colour: Colour,
    ground_colour: Colour = INK,
) -> None:
    """The baseline starts at (x, y); the ground below the text keeps it legible."""
    width, height = text_size(text, scale)
    top, left = max(y - height - PADDING_PX, 0), max(x - PADDING_PX, 0)
    ground = picture[top : y + PADDING_PX + 1, left : x + width + PADDING_PX]
    share = 0.7 if ground_colour == INK else 0.95
    ground[:] = cv2.addWeighted(ground, 1.0 - share, np.full_like(ground, ground_colour), share, 0.0)
    cv2.putText(picture, text, (x, y), FONT, scale, colour, 1, cv2.LINE_AA)


Box = tuple[int, int, int, int]  # left, top, right, bottom


class Labels:
    """Labels of one picture: first come, first placed; one that finds no free place is left out."""

    def __init__(self, picture: NDArray[np.uint8]) -> None:
        self._picture = picture
        self._scale = text_scale(*picture.shape[:2])
        self._placed: list[tuple[str, Box, Colour, Colour]] = []

    def reserve(self, text: str, u: float, v: float, colour: Colour, ground: Colour = INK) -> None:
        """Wants the text centred above (u, v); tries a few places nearby."""
        if not np.isfinite([u, v]).all():
            return
        width, height = text_size(text, self._scale)
        rows, columns = self._picture.shape[:2]
        line = height + 2 * PADDING_PX + 2
        for shift in (0, -1, 1, -2, 2, 3):
            x = int(np.clip(u - width / 2, PADDING_PX, max(columns - width - PADDING_PX, PADDING_PX)))
            y = int(
                np.clip(v - 2 * PADDING_PX + shift * line, line, rows - 2 * line)
            )  # the caption's line stays free
            box = (x - PADDING_PX, y - height - PADDING_PX, x + width + PADDING_PX, y + PADDING_PX)
            if not any(_overlap(box, other) for _, other, _, _ in self._placed):
                self._placed.append((text, box, colour, ground))
                return

    def draw(self) -> None:
        for text, (left, _, _, bottom), colour, ground in self._placed:
            put_text(self._picture, text, left + PADDING_PX, bottom - PADDING_PX, self._scale, colour, ground)


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
