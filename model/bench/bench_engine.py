"""The C engine beside cv2.StereoBM: same images, same parameters, same run, one thread, identical words.

Both are called by turns on arrays that are ready. Times are processor time of the calling
thread, so that other work on the machine counts less; medians, and the spread from the 10th to the 90th
percentile.
Without the left/right check, which StereoBM does differently; further lines show what it costs, and what the
front end costs: smoothing and pyramid of both images, and the matching of three levels against that of one.

    bench_engine.py [--repetitions 21] [--out build/bench/engine.json]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "model"))

from vista_model import Parameters  # noqa: E402
from vista_model.c_engine import (  # noqa: E402
    CEngine,
    isas,
    library,
    prepare_reduce,
    prepare_smooth,
    reduced_shape,
)

SIZES = [(320, 240), (640, 480), (1280, 720), (1920, 1080)]
DISPARITIES = [16, 32, 64, 128]
HEADLINE = Parameters(num_disparities=32, block_size=11, lr_max_diff=None)
HEADLINE_SIZE = (640, 480)


def scene(width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """A slanted textured plane with flat patches, so that valid and invalid pixels both occur."""
    rng = np.random.default_rng(20)
    texture = cv2.GaussianBlur(rng.integers(0, 256, (height, width + 64), dtype=np.uint8), (0, 0), 1.6)
    texture = cv2.normalize(texture, None, 0, 255, cv2.NORM_MINMAX)
    for x, y in rng.integers(0, (width, height), (12, 2)):
        texture[y : y + height // 8, x : x + width // 8] = 128
    shifts = np.linspace(4, 14, height).astype(int)
    right = np.stack([row[d : d + width] for row, d in zip(texture, shifts, strict=True)])
    noise = rng.integers(0, 6, (2, height, width), dtype=np.uint8)
    return cv2.add(texture[:, :width], noise[0]), cv2.add(right, noise[1])


def opencv_matcher(parameters: Parameters) -> cv2.StereoBM:
    matcher = cv2.StereoBM.create(parameters.num_disparities, parameters.block_size)
    matcher.setPreFilterType(cv2.STEREO_BM_PREFILTER_XSOBEL)
    matcher.setPreFilterCap(parameters.prefilter_cap)
    matcher.setTextureThreshold(parameters.texture_threshold)
    matcher.setUniquenessRatio(parameters.uniqueness_ratio)
    matcher.setDisp12MaxDiff(-1)
    matcher.setSpeckleWindowSize(0)
    return matcher


def by_turns_ms(calls: dict[str, Callable[[], object]], repetitions: int) -> dict[str, list[float]]:
    times: dict[str, list[float]] = {name: [] for name in calls}
    for repetition in range(repetitions + 1):
        for name, call in calls.items():
            start = time.thread_time_ns()
            call()
            if repetition > 0:  # the first call of each warms up
                times[name].append((time.thread_time_ns() - start) / 1e6)
    return times


def spread(samples: list[float]) -> dict[str, float]:
    low, median, high = np.percentile(samples, [10, 50, 90])
    return {"p10": round(low, 4), "median": round(median, 4), "p90": round(high, 4)}


def compare(size: tuple[int, int], parameters: Parameters, names: list[str], repetitions: int) -> dict:
    """Times of OpenCV and of the engine on each instruction set, and the ratios turn by turn."""
    left, right = scene(*size)
    matcher = opencv_matcher(parameters)
    words = {name: np.empty(left.shape, np.int16) for name in ["opencv", *names]}
    calls: dict[str, Callable[[], object]] = {
        "opencv": lambda: matcher.compute(left, right, words["opencv"]),
        **{name: CEngine(parameters, name).prepare(left, right, words[name]) for name in names},
    }
    times = by_turns_ms(calls, repetitions)
    for name in names:
        np.testing.assert_array_equal(words[name], words["opencv"], f"{name} {size} {parameters}")
    ratios = {
        name: spread([o / c for o, c in zip(times["opencv"], times[name], strict=True)]) for name in names
    }
    return {
        "width": size[0],
        "height": size[1],
        "num_disparities": parameters.num_disparities,
        "block_size": parameters.block_size,
        "valid_fraction": round(float((words["opencv"] >= 0).mean()), 3),
        "ms": {name: spread(samples) for name, samples in times.items()},
        "ratio": ratios,
    }


def row(result: dict, name: str) -> str:
    cv, c, ratio = result["ms"]["opencv"], result["ms"][name], result["ratio"][name]
    pixels = result["width"] * result["height"] * result["num_disparities"]
    return (
        f"{result['width']:5d}x{result['height']:<5d}{result['num_disparities']:4d}  {name:9s}"
        f"{cv['median']:9.2f} {c['median']:9.3f} ({c['p10']:.3f} .. {c['p90']:.3f})"
        f"{ratio['median']:7.1f}x ({ratio['p10']:.1f} .. {ratio['p90']:.1f})"
        f"{pixels / c['median'] / 1e6:8.1f}"
    )


def check_cost(repetitions: int) -> dict:
    """The engine alone, in the modes that StereoBM does not have."""
    left, right = scene(*HEADLINE_SIZE)
    words = np.empty(left.shape, np.int16)
    calls = {
        "check off": CEngine(HEADLINE).prepare(left, right, words),
        "check on": CEngine(replace(HEADLINE, lr_max_diff=1)).prepare(left, right, words),
        "no prefilter": CEngine(replace(HEADLINE, prefilter="none")).prepare(left, right, words),
    }
    return {name: spread(samples) for name, samples in by_turns_ms(calls, repetitions).items()}


def in_turn(calls: list[Callable[[], None]], arrays: list[np.ndarray]) -> Callable[[], list[np.ndarray]]:
    """All calls in one, which keeps alive the arrays that they write."""

    def call() -> list[np.ndarray]:
        for one in calls:
            one()
        return arrays

    return call


def prepare_levels(
    left: np.ndarray, right: np.ndarray, parameters: Parameters, isa: str, levels: int, smoothed: bool
) -> Callable[[], list[np.ndarray]]:
    """The C calls that give the words of so many levels, on arrays that are ready."""
    calls: list[Callable[[], None]] = []
    arrays: list[np.ndarray] = []
    pair = left, right
    for level in range(levels):
        if level > 0:
            smaller = [np.empty(reduced_shape(image.shape), np.uint8) for image in pair]
            calls += [prepare_reduce(image, out, isa) for image, out in zip(pair, smaller, strict=True)]
            arrays += smaller
            pair = smaller
        matched = pair
        if smoothed:
            matched = [np.empty_like(image) for image in pair]
            arrays += matched
            calls += [prepare_smooth(image, out, isa) for image, out in zip(pair, matched, strict=True)]
        words = np.empty(matched[0].shape, np.int16)
        arrays.append(words)
        calls.append(CEngine(parameters, isa).prepare(*matched, words))
    return in_turn(calls, arrays)


def front_end(isa: str, repetitions: int) -> dict:
    """Levels against one level, turn by turn, and the filters alone beside OpenCV's, on both images."""
    pair = scene(*HEADLINE_SIZE)
    smooth = [np.empty_like(image) for image in pair]
    small = [np.empty(reduced_shape(image.shape), np.uint8) for image in pair]
    opencv_smooth, opencv_small = ([np.empty_like(image) for image in images] for images in (smooth, small))
    calls: dict[str, Callable[[], object]] = {
        "smooth": in_turn([prepare_smooth(i, o, isa) for i, o in zip(pair, smooth, strict=True)], smooth),
        "GaussianBlur": lambda: [
            cv2.GaussianBlur(i, (3, 3), 0, o) for i, o in zip(pair, opencv_smooth, strict=True)
        ],
        "reduce": in_turn([prepare_reduce(i, o, isa) for i, o in zip(pair, small, strict=True)], small),
        "pyrDown": lambda: [cv2.pyrDown(i, o) for i, o in zip(pair, opencv_small, strict=True)],
    }
    for check, lr_max_diff in (("", None), (", check", 1)):
        parameters = replace(HEADLINE, lr_max_diff=lr_max_diff)
        calls["1 level" + check] = prepare_levels(*pair, parameters, isa, 1, False)
        calls["3 levels" + check] = prepare_levels(*pair, parameters, isa, 3, False)
        calls["1 level, smoothed" + check] = prepare_levels(*pair, parameters, isa, 1, True)
        calls["3 levels, smoothed" + check] = prepare_levels(*pair, parameters, isa, 3, True)
    times = by_turns_ms(calls, repetitions)
    np.testing.assert_array_equal(smooth, opencv_smooth)
    np.testing.assert_array_equal(small, opencv_small)
    against = {"smooth": "GaussianBlur", "reduce": "pyrDown"}
    against |= {
        name: "1 level, check" if name.endswith("check") else "1 level" for name in times if "level" in name
    }
    ratios = {
        name: spread([a / b for a, b in zip(times[name], times[other], strict=True)])
        for name, other in against.items()
    }
    return {"isa": isa, "ms": {name: spread(samples) for name, samples in times.items()}, "ratio": ratios}


def front_end_rows(result: dict) -> list[str]:
    rows = []
    for name, ms in result["ms"].items():
        ratio = result["ratio"].get(name)
        text = f"  640x480    32  {result['isa']:9s}{name:26s}"
        text += f"{ms['median']:.3f} ms ({ms['p10']:.3f} .. {ms['p90']:.3f})"
        rows.append(
            text + (f"{ratio['median']:7.2f} ({ratio['p10']:.2f} .. {ratio['p90']:.2f})" if ratio else "")
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=21)
    parser.add_argument("--out", type=Path, default=REPOSITORY / "build" / "bench" / "engine.json")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    library()
    best = isas()[-1]

    print(f"stereo engine beside cv2.StereoBM {cv2.__version__}, one thread, block 11, identical words")
    print("       size   D  code       opencv ms   engine ms (p10 .. p90)   ratio (p10 .. p90)  Gcost/s")
    headline = compare(HEADLINE_SIZE, HEADLINE, isas(), 3 * options.repetitions)
    for name in isas():
        print(row(headline, name))
    table = []
    for size in SIZES:
        for disparities in DISPARITIES:
            parameters = replace(HEADLINE, num_disparities=disparities)
            table.append(compare(size, parameters, [best], options.repetitions))
            print(row(table[-1], best), flush=True)
    alone = check_cost(options.repetitions)
    for name, times in alone.items():
        print(
            f"  640x480    32  {name:13s}{times['median']:.3f} ms ({times['p10']:.3f} .. {times['p90']:.3f})"
        )

    print("front end, both images; ratios to the OpenCV function, to one level without smoothing")
    front_ends = [front_end(name, 3 * options.repetitions) for name in isas()]
    for result in front_ends:
        print("\n".join(front_end_rows(result)))

    options.out.parent.mkdir(parents=True, exist_ok=True)
    result = {
        "opencv": cv2.__version__,
        "isa": best,
        "headline": headline,
        "table": table,
        "engine_ms": alone,
        "front_end": front_ends,
    }
    options.out.write_text(json.dumps({"engine": result}, indent=1) + "\n")


if __name__ == "__main__":
    main()
