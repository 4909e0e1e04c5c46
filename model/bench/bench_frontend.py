"""Smoothing and pyramid in C beside OpenCV's, and the words of three levels beside those of one.

Both images of 640x480; 32 disparities, block 11. All are called by turns on arrays that are ready; the
filters give the pixels of OpenCV. Times are processor time of the calling thread: medians, and the spread
from the 10th to the 90th percentile; ratios are taken turn by turn.

    bench_frontend.py [--repetitions 63] [--out build/bench/frontend.json]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from bench_engine import HEADLINE, HEADLINE_SIZE, REPOSITORY, by_turns_ms, scene, spread
from vista_model import Parameters
from vista_model.c_engine import CEngine, isas, prepare_reduce, prepare_smooth, reduced_shape

SMOOTHED = ("1 level, smoothed", "3 levels, smoothed")


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
    pair: Sequence[np.ndarray] = (left, right)
    for level in range(levels):
        if level > 0:
            smaller = [np.empty(reduced_shape(image.shape), np.uint8) for image in pair]
            calls += [prepare_reduce(image, out, isa) for image, out in zip(pair, smaller, strict=True)]
            arrays += smaller
            pair = smaller
        matched: Sequence[np.ndarray] = pair
        if smoothed:
            matched = [np.empty_like(image) for image in pair]
            arrays += matched
            calls += [prepare_smooth(image, out, isa) for image, out in zip(pair, matched, strict=True)]
        words = np.empty(matched[0].shape, np.int16)
        arrays.append(words)
        calls.append(CEngine(parameters, isa).prepare(matched[0], matched[1], words))
    return in_turn(calls, arrays)


def compare(isa: str, repetitions: int) -> dict:
    """Levels against one level, turn by turn, and the filters alone beside OpenCV's, on both images."""
    pair = left, right = scene(*HEADLINE_SIZE)
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
        calls["1 level" + check] = prepare_levels(left, right, parameters, isa, 1, False)
        calls["3 levels" + check] = prepare_levels(left, right, parameters, isa, 3, False)
        calls["1 level, smoothed" + check] = prepare_levels(left, right, parameters, isa, 1, True)
        calls["3 levels, smoothed" + check] = prepare_levels(left, right, parameters, isa, 3, True)
    times = by_turns_ms(calls, repetitions)
    np.testing.assert_array_equal(smooth, opencv_smooth)
    np.testing.assert_array_equal(small, opencv_small)
    against = {"smooth": "GaussianBlur", "reduce": "pyrDown"}
    for check in ("", ", check"):
        against |= {f"{what}{check}": f"1 level{check}" for what in ("3 levels", *SMOOTHED)}
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


def table_of(results: list[dict]) -> dict:
    names = {"smooth": "smoothing; ratio to `GaussianBlur`", "reduce": "level 1; ratio to `pyrDown`"}
    names |= {name: name for name in results[0]["ms"] if "level" in name}

    def cell(one: dict, name: str) -> str:
        text, ratio = f"{one['ms'][name]['median']:.2f}", one["ratio"].get(name)
        return text + (f"; {ratio['median']:.2f} ({ratio['p10']:.2f} to {ratio['p90']:.2f})" if ratio else "")

    return {
        "name": "frontend",
        "heads": ["ms; ratio to one level", *(one["isa"] for one in results)],
        "rows": [[text, *(cell(one, name) for one in results)] for name, text in names.items()],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=63)
    parser.add_argument("--out", type=Path, default=REPOSITORY / "build" / "bench" / "frontend.json")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    print(
        f"front end beside OpenCV {cv2.__version__}, both images, one thread; ratios to OpenCV, to one level"
    )
    results = [compare(isa, options.repetitions) for isa in isas()]
    for result in results:
        print("\n".join(front_end_rows(result)))
    options.out.parent.mkdir(parents=True, exist_ok=True)
    content = {"tables": [table_of(results)], "figures": {"opencv": cv2.__version__, "isas": results}}
    options.out.write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
