"""The longest time of the host: inputs that are made to be slow, against the middle of a street.

Each of the made inputs is a kind of image with a kind of words, 640x480, flown for FRAMES frames: noise,
checkerboards, stripes and soft texture, with words that are random, sparse, in cells or stripes of many
sizes, or a ramp. Processor time of one thread counts, and of each frame the shortest of REPEATS flights, so
that other programs on the machine do not.

    bench_slow.py [--out build/bench/slow.json]
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

import numpy as np
from bench_host import STREET, enlarged, frames_of, middle  # type: ignore[import-not-found]
from numpy.typing import NDArray
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import INVALID, SCALE, create_engine
from vista.geometry import Calibration, Pose
from vista.pipeline import Pipeline
from vista.rectify import Rectifier
from vista.sequence import open_sequence
from vista_eval.report.table import Table, write_measurement

WIDTH, HEIGHT = 640, 480
CAMERA = Calibration(WIDTH, HEIGHT, 480.0, (WIDTH - 1) / 2, (HEIGHT - 1) / 2, 0.5)
UP = np.array([0.0, -1.0, 0.0])
FRAMES, REPEATS, PERIOD_NS, STEP_M = 6, 2, 100_000_000, 0.8
ROWS, COLUMNS = np.mgrid[:HEIGHT, :WIDTH]
SIZES_PX = (6, 10, 16, 24, 40)

Image = NDArray[np.uint8]
Words = NDArray[np.int16]
Shot = tuple[Image, list[Words], Pose | None]


def tiles(size_px: int) -> NDArray[np.bool_]:
    return np.asarray((COLUMNS // size_px + ROWS // size_px) % 2 == 1)


def stripes(size_px: int) -> NDArray[np.bool_]:
    return np.asarray(COLUMNS // size_px % 2 == 1)


def two_greys(where: NDArray[np.bool_], _: int) -> Image:
    return np.where(where, 200, 40).astype(np.uint8)


IMAGES: dict[str, Callable[[int], Image]] = {
    "flat": lambda _: np.full((HEIGHT, WIDTH), 120, np.uint8),
    "noise": lambda k: np.random.default_rng(k).integers(0, 256, (HEIGHT, WIDTH), np.uint8),
    **{f"checkerboard of {size} px": partial(two_greys, tiles(size)) for size in (2, 8, 24)},
    **{f"stripes of {size} px": partial(two_greys, stripes(size)) for size in (2, 8, 24)},
}


def cells(size_px: int, share: float, stay: bool, number: int) -> Words:
    """Patches of one disparity each, this share of which has one."""
    random = np.random.default_rng((size_px, 0 if stay else number))
    shape = (-(-HEIGHT // size_px), -(-WIDTH // size_px))
    patches = np.where(random.random(shape) < share, random.integers(2 * SCALE, 50 * SCALE, shape), INVALID)
    return np.kron(patches, np.ones((size_px, size_px), int))[:HEIGHT, :WIDTH].astype(np.int16)


def two_words(where: NDArray[np.bool_], _: int) -> Words:
    return np.where(where, 30 * SCALE, 8 * SCALE).astype(np.int16)


WORDS: dict[str, Callable[[int], Words]] = {
    "each of its own": partial(cells, 1, 1.0, False),
    "half of them": partial(cells, 1, 0.5, False),
    "a ramp": lambda _: (8 * SCALE + ROWS * 40 * SCALE // HEIGHT).astype(np.int16),
    **{f"cells of {size} px": partial(cells, size, 1.0, False) for size in SIZES_PX},
    **{f"cells of {size} px that stay": partial(cells, size, 1.0, True) for size in SIZES_PX},
    **{f"half the cells of {size} px": partial(cells, size, 0.5, True) for size in SIZES_PX},
    **{f"a checkerboard of {size} px": partial(two_words, tiles(size)) for size in SIZES_PX},
    **{f"stripes of {size} px": partial(two_words, stripes(size)) for size in SIZES_PX},
}


def levels(words: Words) -> list[Words]:
    """Those of a pyramid of three levels."""
    coarser = [words[:: 1 << k, :: 1 << k] for k in (1, 2)]
    return [words, *(np.where(w < 0, INVALID, w >> k).astype(np.int16) for k, w in enumerate(coarser, 1))]


def made(image: Callable[[int], Image], words: Callable[[int], Words]) -> list[Shot]:
    return [
        (image(k), levels(words(k)), Pose(np.eye(3), np.array([0.0, 0.0, STEP_M * k]))) for k in range(FRAMES)
    ]


def street() -> tuple[Calibration, list[Shot]]:
    """The middle of the street, as bench_host.py has it."""
    sequence, values = open_sequence(STREET), parameters.defaults()
    rectifier = Rectifier(sequence.calibration)
    camera, columns, _ = middle(rectifier.calibration, WIDTH, HEIGHT)
    engine = create_engine("golden", engine_parameters(values))
    seen = [enlarged(frame, columns, (WIDTH, HEIGHT)) for frame in frames_of(sequence, rectifier)]
    words = [list(engine.levels(frame.left, frame.right)) for frame in seen]
    return camera, [(f.left, w, f.world_from_camera) for f, w in zip(seen, words, strict=True)]


def processor_ms(camera: Calibration, shots: Iterable[Shot]) -> tuple[NDArray[np.float64], int]:
    """Gives the time of each frame, and how many of the frames say that they left something out."""
    flights, crowded = [], 0
    for _ in range(REPEATS):
        pipeline, times = Pipeline(camera, parameters.defaults()), []
        crowded = 0
        for k, (image, words, pose) in enumerate(shots):
            start = time.thread_time()
            result = pipeline.process(image, words, k * PERIOD_NS, pose, UP)
            times.append(1e3 * (time.thread_time() - start))
            crowded += "crowded" in result.health.reasons
        flights.append(times)
    return np.min(flights, axis=0), crowded


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    if not STREET.is_dir():
        print("KITTI odometry 00, which the times are compared with, is not there")
        return 0
    usual, _ = processor_ms(*street())
    median = float(np.median(usual))
    found = [
        (image, words, *processor_ms(CAMERA, made(IMAGES[image], WORDS[words])))
        for image in IMAGES
        for words in WORDS
    ]
    found.sort(key=lambda f: -float(f[2].max()))
    rows = [
        (image, words, f"{times.max():.1f}", f"{times.max() / median:.1f}", f"{crowded} of {FRAMES}")
        for image, words, times, crowded in found[:5]
    ]
    of_all = np.concatenate([times for _, _, times, _ in found])
    rows.append(("all", f"{len(of_all)} frames: median", f"{np.median(of_all):.1f}",
                 f"{np.median(of_all) / median:.1f}", f"{sum(f[3] for f in found)}"))  # fmt: skip
    rows.append(("street", f"{len(usual)} frames: median", f"{median:.1f}", "1", "0"))
    rows.append(("street", "longest", f"{usual.max():.1f}", f"{usual.max() / median:.1f}", "0"))
    heads = ("image", "words", "ms, longest frame", "times the street's median", "frames that are crowded")
    shown = Table("slow", heads, rows)
    print(shown.as_text())
    if arguments.out is not None:
        write_measurement(arguments.out, [shown], {"median_ms": median, "longest_ms": float(of_all.max())})
    return 0


if __name__ == "__main__":
    sys.exit(main())
