"""Regions as boxes of pixels, measured through the stages before them."""

from __future__ import annotations

import numpy as np
from stage_library import LEVEL_UP, Stages, ffi, lib

GREY = np.full((240, 320), 90, np.uint8)


def verdict(region) -> str:
    return ffi.string(lib.vista_region_verdict_name(region.verdict)).decode()


def box(center, half_width: float, half_height: float) -> np.ndarray:
    v, u = np.mgrid[:240, :320]
    return (np.abs(u - center[0]) <= half_width) & (np.abs(v - center[1]) <= half_height)


def label_cells(stages: Stages, masks: list[np.ndarray]) -> np.ndarray:
    """Region k are the cells that lie in mask k for the most part; the label of every pixel."""
    f = stages.foveation
    stages.label[:] = -1
    for k, mask in enumerate(masks):
        inside = np.bincount(f.cell_of_pixel.ravel(), mask.ravel(), f.node_count)
        center = np.rint([f.center_v, f.center_u]).astype(int).clip(0, [[239], [319]])
        small = mask[tuple(center)] & (f.pixel_count == 0)
        stages.label[(2 * inside > f.pixel_count) | small] = k
    stages.segmentation.region_count = stages.segmentation.obstacle_count = len(masks)
    return stages.label[f.cell_of_pixel]


def measure(stages: Stages, words: np.ndarray, masks: list[np.ndarray], up=LEVEL_UP) -> list:
    stages.foveate(GREY, words)
    stages.find_surfaces(up)
    label_cells(stages, masks)
    return stages.measure_regions(words, up)
