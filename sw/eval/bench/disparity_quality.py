"""Density and bad-3 of every pyramid level, and of what the host makes of them, on KITTI 2012 pairs, beside
OpenCV's StereoBM and SGBM.

FOLDER holds image_0, image_1 and disp_noc as the data set has them. The host's combination was chosen on the
half named dev; the other is named test. --out is for
`scripts/make_tables.py --save disparity-quality=FILE.json`.

    disparity_quality.py FOLDER [--half dev] [--out build/bench/disparity_quality.json]
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import Image, StereoEngine
from vista.geometry import Calibration
from vista.pipeline import Pipeline
from vista_eval.dataset.stereo_pair import split_of
from vista_eval.metrics.disparity_quality import (
    Counts,
    Pixels,
    Quality,
    at_full_size,
    count,
    finest,
    quality,
)
from vista_eval.metrics.standing_points import Share
from vista_eval.report.table import Table, aligned, fixed, with_interval, write_measurement

DISPARITIES = 64
LEVELS = 4
KITTI_UNITS_PER_PX = 256


def vista_levels(smooth: bool) -> Callable[[Image, Image], dict[str, Pixels]]:
    stereo = asdict(engine_parameters(parameters.defaults()))
    engine = StereoEngine(**stereo | {"num_disparities": DISPARITIES, "levels": LEVELS, "smooth": smooth})

    def match(left: Image, right: Image) -> dict[str, Pixels]:
        words = engine.compute_levels(left, right)
        levels = [at_full_size(one, k, left.shape) for k, one in enumerate(words)]
        end = ", smoothed" if smooth else ""
        named = {f"level {k}{end}": level for k, level in enumerate(levels)}
        return named | {f"finest of {n} levels{end}": finest(levels[:n]) for n in (3, 4)}

    return match


def host_words(smooth: bool) -> Callable[[Image, Image], dict[str, Pixels]]:
    """What the host makes of 1, 2 and 3 levels. It works in pixels: any camera does."""
    values = parameters.defaults()
    values["stereo"]["num_disparities"] = DISPARITIES
    stereo = asdict(engine_parameters(values))
    engine = StereoEngine(**stereo | {"levels": 3, "smooth": smooth})
    pipelines: dict[tuple[int, ...], Pipeline] = {}

    def match(left: Image, right: Image) -> dict[str, Pixels]:
        height, width = left.shape
        if left.shape not in pipelines:
            camera = Calibration(width, height, width / 2, width / 2, height / 2, 0.5)
            pipelines[left.shape] = Pipeline(camera, values)
        levels, named = engine.compute_levels(left, right), {}
        for n in (1, 2, 3):
            pipelines[left.shape].reset()
            words = pipelines[left.shape].process(left, levels[:n], 0).words
            name = f"host, {n} level{'s' * (n > 1)}{', smoothed' if smooth else ''}"
            named[name] = at_full_size(words, 0, left.shape)
        return named

    return match


def opencv(name: str, matcher: cv2.StereoMatcher) -> Callable[[Image, Image], dict[str, Pixels]]:
    def match(left: Image, right: Image) -> dict[str, Pixels]:
        words = matcher.compute(left, right).astype(np.int16, copy=False)
        return {name: at_full_size(words, 0, left.shape)}

    return match


def block_matcher(check: bool) -> cv2.StereoBM:
    """A block matcher with the parameters of the engine; its own left/right check on or off."""
    stereo = engine_parameters(parameters.defaults())
    matcher = cv2.StereoBM.create(DISPARITIES, stereo.block_size)
    matcher.setPreFilterType(cv2.STEREO_BM_PREFILTER_XSOBEL)
    matcher.setPreFilterCap(stereo.prefilter_cap)
    matcher.setTextureThreshold(stereo.texture_threshold)
    matcher.setUniquenessRatio(stereo.uniqueness_ratio)
    matcher.setDisp12MaxDiff(1 if check else -1)
    matcher.setSpeckleWindowSize(0)
    return matcher


def semi_global_matcher(mode: int) -> cv2.StereoSGBM:
    """OpenCV's usual setting: penalties 8 and 32 times the block's pixels, uniqueness 10 %, check 1 px."""
    block = 5
    return cv2.StereoSGBM.create(
        minDisparity=0,
        numDisparities=DISPARITIES,
        blockSize=block,
        P1=8 * block**2,
        P2=32 * block**2,
        disp12MaxDiff=1,
        preFilterCap=63,
        uniquenessRatio=10,
        mode=mode,
    )


def read_image(path: Path, flags: int) -> np.ndarray:
    image = cv2.imread(str(path), flags)
    if image is None:
        raise SystemExit(f"disparity_quality: cannot read {path}")
    return image


def read_truth(path: Path) -> Pixels:
    units = read_image(path, cv2.IMREAD_UNCHANGED)
    return np.where(units == 0, np.nan, units / KITTI_UNITS_PER_PX)


def evaluate(folder: Path, half: str | None) -> dict[str, dict[str, Quality]]:
    """Quality by method: of all measured pixels, of those that level 0 can see, and of those nearer."""
    methods = [
        vista_levels(smooth=False),
        vista_levels(smooth=True),
        host_words(smooth=False),
        host_words(smooth=True),
        opencv("StereoBM", block_matcher(check=False)),
        opencv("StereoBM, check", block_matcher(check=True)),
        opencv("StereoSGBM", semi_global_matcher(cv2.STEREO_SGBM_MODE_SGBM)),
        opencv("StereoSGBM, 3 ways", semi_global_matcher(cv2.STEREO_SGBM_MODE_SGBM_3WAY)),
    ]
    counts: dict[str, dict[str, list[Counts]]] = defaultdict(lambda: defaultdict(list))
    found = sorted(path.name for path in (folder / "disp_noc").glob("*.png"))
    names = [name for index, name in enumerate(found) if half in (None, split_of(index))]
    if not names:
        raise SystemExit(f"disparity_quality: no pairs with measured disparities in {folder}")
    for name in names:
        left, right = (read_image(folder / f"image_{i}" / name, cv2.IMREAD_GRAYSCALE) for i in (0, 1))
        truth = read_truth(folder / "disp_noc" / name)
        near = truth > DISPARITIES - 1
        for match in methods:
            for method, disparity in match(left, right).items():
                counts[method]["all"].append(count(disparity, truth))
                counts[method]["in range"].append(count(disparity, truth, ~near))
                counts[method]["near"].append(count(disparity, truth, near))
    return {method: {part: quality(ones) for part, ones in parts.items()} for method, parts in counts.items()}


def table(results: dict[str, dict[str, Quality]]) -> str:
    def interval(share: Share) -> str:
        return f"{share.value:.3f} ({share.low:.3f} .. {share.high:.3f})"

    rows: list[tuple[str, ...]] = [
        ("", "density", "bad-3", "density in range", "bad-3", "density near", "bad-3")
    ]
    for method, parts in results.items():
        cells = [interval(parts["all"].density), interval(parts["all"].bad)]
        for part in ("in range", "near"):
            cells += [f"{parts[part].density.value:.3f}", f"{parts[part].bad.value:.3f}"]
        rows.append((method, *cells))
    return aligned(rows)


def table_of(methods: dict[str, dict[str, Any]]) -> Table:
    rows = []
    for method, parts in methods.items():
        near = [fixed(parts["near"][key]["value"], 3) for key in ("density", "bad")]
        rows.append((method, *(with_interval(parts["all"][key]) for key in ("density", "bad")), *near))
    heads = ("method", "density", "bad-3", "density of near pixels", "bad-3 of these")
    return Table("disparity-quality", heads, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--out", type=Path, default=Path("build/bench/disparity_quality.json"))
    parser.add_argument("--half", choices=("dev", "test"), help="these pairs only (default: all)")
    options = parser.parse_args()
    results = evaluate(options.folder, options.half)
    pairs = next(iter(results.values()))["all"].pairs
    print(f"{pairs} pairs, {DISPARITIES} candidates; in range: up to {DISPARITIES - 1} px, near: more")
    print(table(results))
    exact = {method: {part: asdict(one) for part, one in parts.items()} for method, parts in results.items()}
    methods = json.loads(json.dumps(exact), parse_float=lambda digits: round(float(digits), 6))
    settings = parameters.defaults()["words"]
    document = {
        "half": options.half,
        "pairs": pairs,
        "words": settings,
        "disparities": DISPARITIES,
        "levels": LEVELS,
        "opencv": cv2.__version__,
        "methods": methods,
    }
    write_measurement(options.out, [table_of(methods)], document)


if __name__ == "__main__":
    main()
