"""What the engine has to do with badly framed video: doc/rtl.md, Framing errors, as a program.

A frame is cut at its first framing error. Of a cut frame only those disparities stand whose inputs, left and
right candidates included, had all come: (x, y) stands if (min(x + r + D, W-1), y + r + 1) came before it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from frames import Frame, expected_words, packed
from verilated import LAST, USER
from vista_model.engine import Parameters

NOTHING = 0xFFFFFFF0  # Smin or confidence all ones, disparity -16
EARLY_EOL, LATE_EOL, EARLY_SOF, LATE_SOF, SIZE = 1, 2, 4, 8, 16  # bits of ERRORS


@dataclass
class Received:
    """Pixels of one frame, in raster order, and whether it ended as it should."""

    pixels: list[int] = field(default_factory=list)
    whole: bool = False


@dataclass
class Reaction:
    frames: list[Received]
    errors: int
    lost: bool  # a start of frame is being searched for


def react(beats: npt.NDArray[np.uint32], width: int, height: int, lost: bool = True) -> Reaction:
    """The frames begun by a stream of beats, and the error bits it sets; reset leaves the engine lost."""
    frames: list[Received] = []
    errors, current = 0, None
    for beat in map(int, beats):
        sof, eol = bool(beat & USER), bool(beat & LAST)
        if current is not None and sof:
            errors |= EARLY_SOF
            current = None
        if current is None:
            if not sof:
                errors |= 0 if lost else LATE_SOF
                lost = True
                continue
            current, lost = Received(), False
            frames.append(current)
        current.pixels.append(beat & 0xFFFF)
        last = len(current.pixels) % width == 0
        if eol != last:
            errors |= EARLY_EOL if eol else LATE_EOL
            current, lost = None, True
        elif len(current.pixels) == width * height:
            current.whole = True
            current = None
    return Reaction(frames, errors, lost)


def expected_after(
    received: Received,
    width: int,
    height: int,
    parameters: Parameters,
    narrow: bool = False,
    confidence: bool = False,
) -> npt.NDArray[np.uint32]:
    """The words of a frame that may have been cut."""
    pixels = np.zeros(width * height, np.uint32)
    pixels[: len(received.pixels)] = received.pixels
    pair = pixels.reshape(height, width)
    left, right = (pair & 255).astype(np.uint8), (pair >> 8).astype(np.uint8)
    words = expected_words(Frame(left, right, parameters, confidence=confidence))
    if not received.whole:
        radius = parameters.block_size // 2
        y, x = np.divmod(np.arange(width * height), width)
        needed = (y + radius + 1) * width + np.minimum(x + radius + parameters.num_disparities, width - 1)
        stands = (needed < len(received.pixels)) & (y + radius + 1 < height)
        words = np.where(stands, words, np.uint32(NOTHING))
    return packed(words.astype(np.uint16).view(np.int16).reshape(height, width)) if narrow else words
