"""Regions of pixels: against numpy, pixel by pixel, and on edges that run through cells."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import INVALID, Stages, camera

NONE = -1
TIE = -99  # of the pixel's two best regions rounding decides
POINT_SIZE_PX = 1.5
# Of refinement.c.
SIGMA_LEVELS, CONTRAST_LIMIT, MIXED_PENALTY, COMPACTNESS = 10.0, 3.0, 0.75, 0.5
SIGMA_DISPARITY_PX, DISPARITY_LIMIT = 0.5, 2.0


def prepared(
    stages: Stages, image: np.ndarray, label: np.ndarray, words: np.ndarray | None = None
) -> np.ndarray:
    """region_of_pixel of cells that are labelled so."""
    words = np.full(image.shape, INVALID, np.int16) if words is None else words
    stages.foveate(image, words)
    stages.label[:] = label
    stages.refine(image)
    return stages.region_of_pixel


def neighbours(stages: Stages, node: int) -> list[int]:
    f = stages.foveation
    return [int(i) for i in f.head[f.tail == node]]


def farther(stages: Stages, word: int, node: int) -> float:
    """What it costs a pixel of that word to join a cell that is nearer."""
    if word < 0 or stages.disparity_px[node] < 0:
        return 0.0
    return min(max(float(stages.disparity_px[node]) - word / 16, 0.0) / SIGMA_DISPARITY_PX, DISPARITY_LIMIT)


def expected(stages: Stages, image: np.ndarray, words: np.ndarray) -> np.ndarray:
    """The definition in cut/refinement.h, a pixel at a time."""
    f, label = stages.foveation, stages.label
    border = np.zeros(f.node_count, bool)
    border[f.tail[label[f.tail] != label[f.head]]] = True
    found = label[f.cell_of_pixel].copy()
    for node in np.flatnonzero(border):
        if node == 0 or f.size_px[node] < POINT_SIZE_PX:
            continue
        candidates = [int(node), *(i for i in neighbours(stages, node) if i != 0)]
        for v, u in zip(*np.nonzero(f.cell_of_pixel == node), strict=True):
            costs = [
                min(abs(float(image[v, u]) - stages.intensity[i]) / SIGMA_LEVELS, CONTRAST_LIMIT)
                + farther(stages, int(words[v, u]), i)
                + MIXED_PENALTY * border[i]
                + COMPACTNESS
                * ((u - f.center_u[i]) ** 2 + (v - f.center_v[i]) ** 2)
                / float(f.size_px[i]) ** 2
                for i in candidates
            ]
            order = np.argsort(costs, kind="stable")
            nearest = {int(label[candidates[k]]) for k in order if costs[k] - costs[order[0]] < 1e-4}
            found[v, u] = nearest.pop() if len(nearest) == 1 else TIE
    return found


@pytest.mark.parametrize("size", [(96, 72), (64, 90)])
def test_pixels_join_the_cell_that_numpy_finds(size: tuple[int, int]) -> None:
    random = seeded(1)
    changes = {
        "foveation.sector_count": int(random.choice([24, 48, 96])),
    }
    stages = Stages(camera(*size), changes)
    image = random.integers(0, 256, (size[1], size[0]), dtype=np.uint8)
    label = random.integers(NONE, 4, stages.foveation.node_count).astype(np.int32)
    label[random.random(label.size) < 0.6] = 1  # cells away from any border, too
    words = random.integers(0, 160, image.shape).astype(np.int16)
    words[random.random(image.shape) < 0.3] = INVALID
    found = prepared(stages, image, label, words)
    wanted = expected(stages, image, words)
    sure = wanted != TIE
    assert np.array_equal(found[sure], wanted[sure])
    assert sure.mean() > 0.9 and np.any(found != stages.label[stages.foveation.cell_of_pixel])


def test_a_region_ends_where_the_image_does_not_where_the_cells_do() -> None:
    """A dark disc on bright ground, the cells labelled by their centres: they draw steps, pixels a disc."""
    stages = Stages(camera())
    u, v = np.meshgrid(np.arange(320), np.arange(240))
    disc = np.hypot(u - 250, v - 90) <= 30
    image = np.where(disc, 50, 200).astype(np.uint8)
    f = stages.foveation
    label = (np.hypot(f.center_u - 250, f.center_v - 90) <= 30).astype(np.int32)
    found = prepared(stages, image, label)
    by_cells = label[f.cell_of_pixel]
    assert np.mean(by_cells != disc) > 0.003
    assert np.mean(found != disc) < 0.25 * np.mean(by_cells != disc)


def test_what_is_farther_leaves_a_near_region_and_nothing_is_drawn_into_one() -> None:
    """Words end where a thing does not: they know its background, but blocks make the thing too large."""
    stages = Stages(camera())
    u, v = np.meshgrid(np.arange(320), np.arange(240))
    disc = np.hypot(u - 250, v - 90) <= 30
    image = np.full((240, 320), 90, np.uint8)
    words = np.where(disc, 16 * 20, 16 * 5).astype(np.int16)
    f = stages.foveation
    label = (np.hypot(f.center_u - 250, f.center_v - 90) <= 30).astype(np.int32)
    found = prepared(stages, image, label, words)
    by_cells = label[f.cell_of_pixel]
    beyond = (by_cells == 1) & ~disc
    assert beyond.any() and np.mean(found[beyond] == 1) < 0.3
    flat = prepared(stages, image, label)
    assert np.mean(found[disc] == 1) == pytest.approx(np.mean(flat[disc] == 1), abs=0.01)


def test_without_borders_the_cells_decide() -> None:
    stages = Stages(camera(120, 90))
    image = seeded(2).integers(0, 256, (90, 120), dtype=np.uint8)
    for label in (NONE, 0, 3):
        assert np.all(prepared(stages, image, np.full(stages.foveation.node_count, label, np.int32)) == label)


def test_flat_images_leave_the_boundaries_near_those_of_the_cells() -> None:
    """Nothing to follow: no pixel goes farther than to the cell beside its own."""
    stages = Stages(camera(160, 120))
    f = stages.foveation
    label = (f.center_u > 80).astype(np.int32)
    found = prepared(stages, np.full((120, 160), 90, np.uint8), label)
    by_cells = label[f.cell_of_pixel]
    moved = found != by_cells
    assert np.all(f.size_px[f.cell_of_pixel[moved]] >= POINT_SIZE_PX)
    assert moved.mean() < 0.05
