"""Ground of sampled flights: what a texel shows is what lies in it."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from vista_eval.worlds.sampled.grounds import COVERS
from vista_eval.worlds.sampled.laying import MOST_STRETCH, TEXEL_PER_RANGE, Patch, albedo_of

FINE_M = 0.03
TEXELS = 48  # of a patch, along each side


def true_means(patch: Patch, cover: str, seed: int) -> np.ndarray:
    """Of each texel, from points FINE_M apart all over it."""
    lines = []
    for (low_m, high_m), texel_m in ((patch.x_m, patch.texel_m * patch.stretch), (patch.y_m, patch.texel_m)):
        each = int(np.ceil(texel_m / FINE_M))
        lines.append((low_m + (np.arange(TEXELS * each) + 0.5) * (high_m - low_m) / (TEXELS * each), each))
    (x, rows), (y, columns) = lines
    fine = COVERS[cover].albedo(x.astype(np.float32)[:, None], y.astype(np.float32)[None, :], seed)
    return fine.reshape(TEXELS, rows, TEXELS, columns).mean(axis=(1, 3))


@pytest.mark.parametrize("cover", COVERS)
def test_far_ground_has_no_more_contrast_than_its_texels_means(cover: str) -> None:
    """At 60 m and at 120 m, where a texel is up to twelve times as long as it is wide."""
    random = seeded(1)
    seed = int(random.integers(1 << 30))
    for range_m, stretch in ((60.0, MOST_STRETCH // 2), (120.0, MOST_STRETCH)):
        texel_m = TEXEL_PER_RANGE * range_m
        x_m, y_m = float(random.uniform(0, 50)), float(random.uniform(-10, 10))
        ends_m = x_m + TEXELS * texel_m * stretch, y_m + TEXELS * texel_m
        patch = Patch((x_m, ends_m[0]), (y_m, ends_m[1]), texel_m, stretch)
        expected = true_means(patch, cover, seed)
        laid = albedo_of(patch, cover, 1.0, seed, None)
        assert laid.shape == expected.shape
        assert 0.6 < laid.std() / expected.std() < 1.7, f"at {range_m} m"
