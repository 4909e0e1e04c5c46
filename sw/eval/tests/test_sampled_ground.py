"""Ground of sampled flights: what a texel shows is what lies in it."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from vista_eval.worlds.grounds import COVERS
from vista_eval.worlds.laying import MOST_STRETCH, Patch, albedo_of

TEXEL_M = 0.05
FINE_M = 0.025
SHARP = {"asphalt"}  # has lines and joints narrower than TEXEL_M
TEXELS = 48  # of a patch, along each side


def true_means(patch: Patch, cover: str, seed: int) -> np.ndarray:
    """The mean of each texel, from points FINE_M apart all over it."""
    lines = []
    for (low_m, high_m), texel_m in ((patch.x_m, patch.texel_m * patch.stretch), (patch.y_m, patch.texel_m)):
        each = int(np.ceil(texel_m / FINE_M))
        lines.append((low_m + (np.arange(TEXELS * each) + 0.5) * (high_m - low_m) / (TEXELS * each), each))
    (x, rows), (y, columns) = lines
    fine = COVERS[cover].albedo(x.astype(np.float32)[:, None], y.astype(np.float32)[None, :], seed)
    return fine.reshape(TEXELS, rows, TEXELS, columns).mean(axis=(1, 3))


@pytest.mark.parametrize("cover", sorted(COVERS.keys() - SHARP))
def test_long_texels_have_the_contrast_of_their_means(cover: str) -> None:
    """A low flight sees the ground at 30 m like that, twelve times as long as wide: points here and there of
    a texel would make speckles of it."""
    random = seeded(1)
    seed, x_m, y_m = int(random.integers(1 << 30)), random.uniform(0, 50), random.uniform(-10, 10)
    ends_m = x_m + TEXELS * TEXEL_M * MOST_STRETCH, y_m + TEXELS * TEXEL_M
    patch = Patch((x_m, ends_m[0]), (y_m, ends_m[1]), TEXEL_M, MOST_STRETCH)
    expected = true_means(patch, cover, seed)
    laid = albedo_of(patch, cover, 1.0, seed, None)
    assert laid.shape == expected.shape
    assert 0.85 < laid.std() / expected.std() < 1.12
