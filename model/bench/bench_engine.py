"""The C engine beside cv2.StereoBM: same images, same parameters, same run, one thread, identical words.

Both are called by turns on arrays that are ready. Times are processor time of the calling
thread, so that other work on the machine counts less; medians, and the spread from the 10th to the 90th
percentile.
Without the left/right check, which StereoBM does differently; the last lines show what it costs.

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
from vista_model.c_engine import CEngine, isas, library  # noqa: E402

SIZES = [(320, 240), (640, 480), (1280, 720), (1920, 1080)]
DISPARITIES = [16, 32, 64, 128]
HEADLINE = Parameters(num_disparities=32, block_size=11, lr_max_diff=None)
HEADLINE_SIZE = (640, 480)


def scene(width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """A slanted textured plane with flat patches, so that valid and invalid pixels both occur."""
    rng = np.random.default_rng(20)
    texture = cv2.GaussianBlur(rng.integers(0, 256, (height, width + 64), dtype=np.uint8), (0, 0), 1.6)
    texture = cv2.normalize(texture, np.empty_like(texture), 0, 255, cv2.NORM_MINMAX)
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
    words, confidence = np.empty(left.shape, np.int16), np.empty(left.shape, np.uint16)
    calls: dict[str, Callable[[], object]] = {
        "check off": CEngine(HEADLINE).prepare(left, right, words),
        "with confidence": CEngine(HEADLINE).prepare(left, right, words, confidence=confidence),
        "check on": CEngine(replace(HEADLINE, lr_max_diff=1)).prepare(left, right, words),
        "no prefilter": CEngine(replace(HEADLINE, prefilter="none")).prepare(left, right, words),
    }
    return {name: spread(samples) for name, samples in by_turns_ms(calls, repetitions).items()}


def table_of_isas(headline: dict) -> dict:
    def cell(times: dict[str, float], digits: int) -> str:
        return f"{times['median']:.{digits}f} ({times['p10']:.{digits}f} to {times['p90']:.{digits}f})"

    return {
        "name": "engine",
        "heads": ["instruction set", "ms: median (10th to 90th percentile)", "times as fast as StereoBM"],
        "rows": [
            [name, cell(times, 2), cell(headline["ratio"][name], 1)]
            for name, times in headline["ms"].items()
            if name != "opencv"
        ],
    }


def table_of_sizes(isa: str, results: list[dict]) -> dict:
    disparities = sorted({row["num_disparities"] for row in results})
    cells: dict[str, list[str]] = {}
    for row in results:
        ms, ratio = row["ms"][isa]["median"], row["ratio"][isa]["median"]
        cells.setdefault(f"{row['width']}x{row['height']}", []).append(f"{ms:.3g} ({ratio:.1f})")
    return {
        "name": "engine-sizes",
        "heads": [f"{isa}: ms (times as fast)", *(f"{count} disparities" for count in disparities)],
        "rows": [[size, *values] for size, values in cells.items()],
    }


def front_page(isa: str, headline: dict) -> list[str]:
    return [
        "stereo engine in C, 640x480, 32 disparities, one thread",
        f"{headline['ms'][isa]['median']:.1f} ms, {headline['ratio'][isa]['median']:.1f} times as "
        "fast as OpenCV's StereoBM with the same words",
    ]


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
            f"  640x480    32  {name:16s}{times['median']:.3f} ms ({times['p10']:.3f} .. {times['p90']:.3f})"
        )

    options.out.parent.mkdir(parents=True, exist_ok=True)
    result = {
        "opencv": cv2.__version__,
        "isa": best,
        "headline": headline,
        "table": table,
        "engine_ms": alone,
    }
    content = {
        "headline": front_page(best, headline),
        "tables": [table_of_isas(headline), table_of_sizes(best, table)],
        "figures": {"engine": result},
    }
    options.out.write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
