"""Frames for the benches: images, parameters, sizes; their beats, and the words of the C model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from registers import COMMIT, LR_CHECK, OUTPUT, PREFILTER, SIZE, TEXTURE, UNIQUENESS
from rtl_package import struct_bits, struct_fields
from verilated import LAST, PACES, USER, WORD_LAST, WORD_USER, Pace, Rtl
from vista_model.c_engine import CEngine
from vista_model.engine import INVALID, Parameters

Image = npt.NDArray[np.uint8]
# Kinds of images, and how often they are drawn.
IMAGE_SHARES = {
    "noise": 0.15, "shifted": 0.2, "gradient": 0.1, "repeated": 0.1, "black": 0.05, "saturated": 0.05,
    "checker": 0.05, "flat_patches": 0.05, "faint": 0.2, "black_and_white": 0.05,
}  # fmt: skip
IMAGE_KINDS = tuple(IMAGE_SHARES)
MAX_CAP = 63


@dataclass
class Frame:
    """A pair and the parameters to match it with."""

    left: Image
    right: Image
    parameters: Parameters
    narrow: bool = False  # words of two disparities
    confidence: bool = False  # in place of Smin; narrow goes before it

    @property
    def shape(self) -> tuple[int, int]:
        return self.left.shape  # type: ignore[return-value]


def random_pair(rng: np.random.Generator, kind: str, height: int, width: int) -> tuple[Image, Image]:
    noise = rng.integers(0, 256, (2, height, width), np.uint8)
    columns = np.arange(width)
    if kind == "noise":
        return noise[0], noise[1]
    if kind == "faint":  # costs so small that many nearly tie, or lie at the bound of uniqueness
        faint = noise % np.uint8(rng.integers(2, 9))
        right = faint[1] if rng.integers(2) else faint[0] + (noise[1] & 1)
        return faint[0], np.roll(right, -int(rng.integers(0, 12)), 1)
    if kind == "black_and_white":  # some of the largest costs, beside small ones
        noise = (noise & 1) * np.uint8(255)
        return noise[0], np.roll(noise[rng.integers(2)], -int(rng.integers(0, 12)), 1)
    if kind == "shifted":  # a slanted plane of true disparities, with a little noise
        shift = rng.integers(0, 24) + np.arange(height)[:, None] * rng.integers(0, 3) // 4
        source = np.clip(columns[None, :] + shift, 0, width - 1)
        right = np.take_along_axis(noise[0], source, 1)
        return noise[0], np.clip(right.astype(int) + rng.integers(-2, 3, right.shape), 0, 255).astype(
            np.uint8
        )
    if kind == "gradient":
        ramp = (columns * rng.integers(1, 9) + np.arange(height)[:, None] * rng.integers(0, 5)) & 255
        return ramp.astype(np.uint8), np.roll(ramp, -int(rng.integers(0, 12)), 1).astype(np.uint8)
    if kind == "repeated":  # ties in plenty
        tile = np.tile(noise[0][:, : rng.integers(2, 9)], (1, width))[:, :width]
        return tile, np.roll(tile, int(rng.integers(0, 8)), 1)
    if kind == "black":
        return np.zeros((height, width), np.uint8), np.zeros((height, width), np.uint8)
    if kind == "saturated":  # the largest costs there are
        return np.full((height, width), 255, np.uint8), np.zeros((height, width), np.uint8)
    if kind == "checker":
        board = (
            (columns[None, :] // rng.integers(1, 6) + np.arange(height)[:, None] // rng.integers(1, 6)) & 1
        ) * 255
        return board.astype(np.uint8), np.roll(board, int(rng.integers(-3, 4)), 1).astype(np.uint8)
    patches = np.repeat(np.repeat(noise[0][::8, ::8], 8, 0), 8, 1)[:height, :width]
    return patches, np.roll(patches, -int(rng.integers(0, 10)), 1)


def random_parameters(rng: np.random.Generator, num_disparities: int, block_size: int) -> Parameters:
    area = block_size * block_size
    thresholds = area * 8, area * MAX_CAP + 2, 65536
    return Parameters(
        num_disparities=num_disparities,
        block_size=block_size,
        prefilter=("xsobel", "none")[rng.integers(2)],
        prefilter_cap=int(rng.choice([1, 31, MAX_CAP, rng.integers(1, MAX_CAP + 1)])),
        texture_threshold=int(
            rng.choice([0, 10, *(rng.integers(0, end) for end in thresholds)], p=[0.4, 0.1, 0.25, 0.15, 0.1])
        ),
        # With multiples of 5 the bound is a whole number for many costs.
        uniqueness_ratio=int(rng.choice([0, 15, 100, 5 * rng.integers(0, 21), rng.integers(0, 101)])),
        lr_max_diff=(None, 0, 1, 1 << int(rng.integers(8)), int(rng.integers(0, 256)))[rng.integers(5)],
    )


def random_frame(
    rng: np.random.Generator,
    num_disparities: int,
    block_size: int,
    max_width: int,
    parameters: Parameters | None = None,
) -> Frame:
    """Mostly wide enough to be matched; sizes at the edges of that, and the smallest, come often too."""
    narrowest = num_disparities + 2 * (block_size // 2)
    width = int(
        rng.choice(
            [rng.integers(4, narrowest), narrowest, narrowest + rng.integers(0, 90)], p=[0.1, 0.1, 0.8]
        )
    )
    height = int(
        rng.choice(
            [rng.integers(2, block_size), block_size, block_size + rng.integers(0, 16)], p=[0.1, 0.1, 0.8]
        )
    )
    left, right = random_pair(
        rng,
        str(rng.choice(IMAGE_KINDS, p=list(IMAGE_SHARES.values()))),
        height,
        min(width, max_width),
    )
    return Frame(left, right, parameters or random_parameters(rng, num_disparities, block_size))


def beats(left: Image, right: Image) -> npt.NDArray[np.uint32]:
    """The video of a pair, well framed."""
    data = left.astype(np.uint32) | right.astype(np.uint32) << 8
    data[0, 0] |= USER
    data[:, -1] |= LAST
    return data.ravel()


def expected_words(frame: Frame) -> npt.NDArray[np.uint32]:
    """What the engine has to send: {Smin saturated to 16 bits, disparity}, or two disparities in a word, or
    {confidence, disparity}."""
    engine = CEngine(frame.parameters)
    upper: npt.NDArray[np.unsignedinteger]
    if frame.confidence:
        disparity, _, upper = engine.compute_all(frame.left, frame.right)
    else:
        disparity, smin = engine.compute(frame.left, frame.right)
        upper = np.minimum(smin, 0xFFFF)
    if frame.narrow:
        return packed(disparity)
    return (disparity.view(np.uint16) | upper.astype(np.uint32) << 16).astype(np.uint32).ravel()


def packed(disparity: npt.NDArray[np.int16]) -> npt.NDArray[np.uint32]:
    """Words of two disparities."""
    padded = np.pad(disparity, ((0, 0), (0, disparity.shape[1] % 2)), constant_values=INVALID)
    return np.ascontiguousarray(padded).view(np.uint32).ravel()


def expected_flags(height: int, width: int, narrow: bool = False) -> npt.NDArray[np.uint8]:
    flags = np.zeros((height, (width + 1) // 2 if narrow else width), np.uint8)
    flags[0, 0] |= WORD_USER
    flags[:, -1] |= WORD_LAST
    return flags.ravel()


def register_values(frame: Frame) -> dict[int, int]:
    """Values that are written for a frame, by address, the commit last."""
    height, width = frame.shape
    p = frame.parameters
    return {
        SIZE: width | height << 16,
        PREFILTER: (p.prefilter == "xsobel") | p.prefilter_cap << 8,
        TEXTURE: p.texture_threshold,
        UNIQUENESS: p.uniqueness_ratio,
        LR_CHECK: (p.lr_max_diff is not None) | (p.lr_max_diff or 0) << 8,
        OUTPUT: frame.narrow | frame.confidence << 1,
        COMMIT: 1,
    }


_PARAMS = struct_fields("params_t")
PARAMS_BITS = sum(_PARAMS.values())


def params_bits(p: Parameters, narrow: bool = False, confidence: bool = False) -> int:
    """The packed struct params_t."""
    values = {
        "xsobel": p.prefilter == "xsobel", "cap": p.prefilter_cap, "texture_threshold": p.texture_threshold,
        "uniqueness_ratio": p.uniqueness_ratio, "lr_enable": p.lr_max_diff is not None,
        "lr_max_diff": p.lr_max_diff or 0, "narrow": narrow,
        "confidence": confidence,
    }  # fmt: skip
    assert len(values) == len(_PARAMS), "params_t has a field that nothing here sets"
    return struct_bits(_PARAMS, values)


def set_up(rtl: Rtl, frame: Frame) -> None:
    for address, data in register_values(frame).items():
        rtl.write(address, data)


def check(rtl: Rtl, frame: Frame, pace_in: Pace, pace_out: Pace, seed: int) -> None:
    height, width = frame.shape
    set_up(rtl, frame)
    expected = expected_words(frame)
    got = rtl.stream(beats(frame.left, frame.right), len(expected), pace_in, pace_out, seed)
    rerun = f"VISTA_WAVES=1 VISTA_SEED={seed} pytest tb/top/test_words.py -k 'random and {rtl.config.name}'"
    assert len(got.words) == len(expected), (
        f"{len(got.words)} of {len(expected)} words, {frame.parameters}; {rerun}"
    )
    wrong = np.flatnonzero(got.words != expected)
    if len(wrong):
        y, x = divmod(int(wrong[0]), len(expected) // height)
        raise AssertionError(f"{len(wrong)} words differ, the first at x {x}, y {y} of {width}x{height}: "
                    f"{got.words[wrong[0]]:08x} for {expected[wrong[0]]:08x}, {frame.parameters}; "
                    f"{rerun}")  # fmt: skip
    assert (got.flags == expected_flags(height, width, frame.narrow)).all(), rerun


def run_seed(rtl: Rtl, seed: int) -> None:
    rng = np.random.default_rng(seed)
    c = rtl.config
    frame = random_frame(rng, c.num_disparities, c.block_size, c.max_width)
    frame.narrow = bool(rng.random() < 0.3)
    frame.confidence = c.confidence and bool(rng.random() < 0.7)
    check(rtl, frame, PACES[rng.integers(len(PACES))], PACES[rng.integers(len(PACES))], seed)
