"""The stereo engine: one function for each step of the contract (doc/design/engine-contract.md).

Images are uint8, height x width, rectified, left is the reference. Costs S are held as an array [d, y, x]
over the matched pixels only: x - (D-1+r) and y - r index it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

INVALID = -16  # the word of a pixel without a disparity
NO_COST = 2**32 - 1  # Smin of a pixel that is not matched
NO_CONFIDENCE = 2**16 - 1  # the confidence of a pixel that is not matched
NEAREST_DISTANCE, FARTHEST_DISTANCE = -128, 127  # px, of a rival: those that 8 bits hold
LARGEST_MARGIN = 15  # in 1/32 of Smin

Image = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int32]
Words = npt.NDArray[np.int16]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Parameters:
    num_disparities: int = 32  # D: 16, 32 .. 256 px
    block_size: int = 11  # odd, 5 .. 21 px
    prefilter: str = "xsobel"  # or "none"
    prefilter_cap: int = 31  # c: 1 .. 63
    texture_threshold: int = 10  # 0 ..
    uniqueness_ratio: int = 15  # u: 0 .. 100 percent
    lr_max_diff: int | None = 1  # None: off, or 0 .. px

    def __post_init__(self) -> None:
        ranges = {
            "num_disparities": range(16, 257, 16),
            "block_size": range(5, 22, 2),
            "prefilter": ("xsobel", "none"),
            "prefilter_cap": range(1, 64),
            "texture_threshold": range(2**31),
            "uniqueness_ratio": range(101),
        }
        for name, allowed in ranges.items():
            if getattr(self, name) not in allowed:
                raise ValueError(f"{name} out of range: {getattr(self, name)!r}")
        if self.lr_max_diff is not None and self.lr_max_diff < 0:
            raise ValueError(f"lr_max_diff out of range: {self.lr_max_diff!r}")

    @property
    def radius(self) -> int:
        return (self.block_size - 1) // 2


def xsobel(image: Image, cap: int) -> Image:
    """Step 1: clamp(g, -c, c) + c with g = [1 2 1]^T * [-1 0 1]."""
    height, width = image.shape
    out = np.full((height, width), cap, np.uint8)
    if width < 3 or height < 2:
        return out
    rows = np.pad(image.astype(np.int32), ((1, 1), (0, 0)), mode="reflect")
    smooth = rows[:-2] + 2 * rows[1:-1] + rows[2:]
    out[:, 1:-1] = np.clip(smooth[:, 2:] - smooth[:, :-2], -cap, cap) + cap
    if height % 2 == 1:
        out[-1] = cap
    return out


def block_sums(values: Ints, block_size: int) -> Ints:
    """Sums over every whole block inside the last two axes, which shrink by block_size - 1."""
    for axis in (-2, -1):
        sums = np.cumsum(values, axis=axis, dtype=np.int32)
        before = np.concatenate([np.zeros_like(sums.take([0], axis)), sums], axis=axis)
        count = values.shape[axis] - block_size + 1
        ends = np.arange(count) + block_size
        values = before.take(ends, axis) - before.take(ends - block_size, axis)
    return values


def costs(left: Image, right: Image, parameters: Parameters) -> Ints:
    """Step 2: S(x, y, d) over the matched pixels, of prefiltered images."""
    D, width = parameters.num_disparities, left.shape[1]
    left_part = left[:, D - 1 :].astype(np.int32)
    return np.stack(
        [
            block_sums(np.abs(left_part - right[:, D - 1 - d : width - d]), parameters.block_size)
            for d in range(D)
        ]
    )


def last_smallest(S: Ints) -> Ints:
    """The index of the smallest along the first axis; ties go to the larger."""
    return (len(S) - 1 - np.argmin(S[::-1], axis=0)).astype(np.int32)


def winner(S: Ints) -> tuple[Ints, Ints]:
    """Step 3: dL and Smin."""
    return last_smallest(S), S.min(axis=0)


def texture(left: Image, parameters: Parameters) -> Ints:
    """Step 4, over the matched pixels; `left` is the image itself, not prefiltered."""
    c = parameters.prefilter_cap
    strength = np.abs(xsobel(left, c).astype(np.int32) - c)
    return block_sums(strength[:, parameters.num_disparities - 1 :], parameters.block_size)


def away(S: Ints, dL: Ints) -> Mask:
    """Marks the candidates that are neither the winner nor beside it."""
    return np.abs(np.arange(len(S), dtype=np.int32)[:, None, None] - dL) > 1


def unique(S: Ints, dL: Ints, smin: Ints, ratio: int) -> Mask:
    """Step 5: no d away from the winner comes close to it."""
    if ratio == 0:
        return np.ones(dL.shape, np.bool_)
    close = smin + smin * ratio // 100 >= S
    return ~np.any(away(S, dL) & close, axis=0)


def right_winner(S: Ints) -> Ints:
    """Step 6: dR by right pixel, columns counted so that column i is right pixel i + r.

    Right pixel xr meets left pixel xr + d; where that is not a matched pixel the cost is above any other.
    """
    D, rows, columns = S.shape
    diagonal = np.full((D, rows, columns + D - 1), np.iinfo(np.int32).max, np.int32)
    for d in range(D):
        start = D - 1 - d  # left pixel D-1+r, the first matched, is right pixel D-1+r-d
        diagonal[d, :, start : start + columns] = S[d]
    return last_smallest(diagonal)


def consistent(dL: Ints, dR: Ints, num_disparities: int, lr_max_diff: int | None) -> Mask:
    """Step 6: the right image's winner points back to within lr_max_diff."""
    if lr_max_diff is None:
        return np.ones(dL.shape, np.bool_)
    x = np.arange(dL.shape[1]) + num_disparities - 1
    return np.abs(dL - np.take_along_axis(dR, x - dL, axis=1)) <= lr_max_diff


def subpixel(S: Ints, dL: Ints, smin: Ints) -> Words:
    """Step 7: the disparity word."""
    D = len(S)
    before = np.where(dL == 0, 1, dL - 1)
    after = np.where(dL == D - 1, D - 2, dL + 1)
    p = np.take_along_axis(S, before[None], axis=0)[0].astype(np.int64)
    n = np.take_along_axis(S, after[None], axis=0)[0].astype(np.int64)
    q = p + n - 2 * smin + np.abs(p - n)
    size = 256 * np.abs(p - n) // np.maximum(q, 1)  # towards zero: sign apart; p = n where q = 0
    return ((256 * dL + np.sign(p - n) * size + 15) >> 4).astype(np.int16)


def confidence(S: Ints, dL: Ints, smin: Ints, texture_sums: Ints) -> npt.NDArray[np.uint16]:
    """Step 8: distance of the rival, its margin and the bits of the texture."""
    d2, cost = winner(np.where(away(S, dL), S, np.iinfo(np.int32).max))
    distance = np.clip(d2 - dL, NEAREST_DISTANCE, FARTHEST_DISTANCE)
    passed = np.arange(1, LARGEST_MARGIN + 1)[:, None, None] * smin < 32 * (cost - smin)
    bits = np.frexp(texture_sums)[1]  # 0 of 0
    return (distance << 8 & 0xFF00 | np.count_nonzero(passed, axis=0) << 4 | bits).astype(np.uint16)


class Outputs(NamedTuple):
    """What the engine gives of a pair, by pixel."""

    words: Words
    smin: npt.NDArray[np.uint32]
    confidence: npt.NDArray[np.uint16]


def compute_all(left: Image, right: Image, parameters: Parameters, with_confidence: bool = True) -> Outputs:
    """Disparity words; Smin and confidence of every matched pixel whether valid or not. A confidence
    that is not wanted costs nothing, and is NO_CONFIDENCE everywhere."""
    if left.shape != right.shape or left.ndim != 2 or left.dtype != np.uint8 or right.dtype != np.uint8:
        raise ValueError("left and right must be uint8 images of the same height and width")
    height, width = left.shape
    D, r = parameters.num_disparities, parameters.radius
    outputs = Outputs(
        np.full((height, width), INVALID, np.int16),
        np.full((height, width), NO_COST, np.uint32),
        np.full((height, width), NO_CONFIDENCE, np.uint16),
    )
    matched = np.s_[r : height - r, D - 1 + r : width - r]
    if height < 2 * r + 1 or width < D + 2 * r:
        return outputs

    filtered_left, filtered_right = (
        xsobel(image, parameters.prefilter_cap) if parameters.prefilter == "xsobel" else image
        for image in (left, right)
    )
    S = costs(filtered_left, filtered_right, parameters)
    dL, smin = winner(S)
    texture_sums = texture(left, parameters)
    valid = (
        (texture_sums >= parameters.texture_threshold)
        & unique(S, dL, smin, parameters.uniqueness_ratio)
        & consistent(dL, right_winner(S), D, parameters.lr_max_diff)
    )
    outputs.words[matched] = np.where(valid, subpixel(S, dL, smin), INVALID)
    outputs.smin[matched] = smin
    if with_confidence:
        outputs.confidence[matched] = confidence(S, dL, smin, texture_sums)
    return outputs


def compute_with_smin(
    left: Image, right: Image, parameters: Parameters
) -> tuple[Words, npt.NDArray[np.uint32]]:
    """Disparity words, and Smin of every matched pixel whether valid or not (NO_COST elsewhere)."""
    return compute_all(left, right, parameters, with_confidence=False)[:2]


def compute(left: Image, right: Image, parameters: Parameters) -> Words:
    """Disparity words of the left image."""
    return compute_all(left, right, parameters, with_confidence=False).words
