"""Pixels of an obstacle that are the ground before its foot leave its region; all others keep theirs."""

from __future__ import annotations

import numpy as np
from random_seed import seeded
from stage_library import camera, ffi, frame_view, lib, parameters, set_frame

WIDTH, HEIGHT, NONE = 160, 120, -1
GROUND_M = 0.2  # of footing.c


class Foot:
    """Regions in columns, one a verdict or more, over a plane of ground."""

    def __init__(self, random: np.random.Generator, count: int) -> None:
        self.camera = camera(WIDTH, HEIGHT)
        self.frame = frame_view(parameters(), self.camera)
        self.slope = random.uniform(-0.02, 0.02), random.uniform(0.2, 0.5)
        self.surfaces = ffi.new(
            "vista_surfaces *", {"ground_found": True, "ground": [random.uniform(-4, 4), *self.slope]}
        )
        self.items = ffi.new("vista_region[]", count)
        for item in self.items:
            item.verdict = random.choice([lib.VISTA_REGION_ACCEPTED, lib.VISTA_REGION_HORIZONTAL])
            item.disparity_px = random.uniform(4, 20)
            item.slope_u, item.slope_v = random.uniform(-0.05, 0.05, 2)
            item.mean_u_px, item.mean_v_px = random.uniform((0, 0), (WIDTH, HEIGHT))
        self.items[0].verdict = lib.VISTA_REGION_ACCEPTED
        self.regions = ffi.new("vista_regions *", {"items": self.items, "count": count})
        self.label = np.sort(random.integers(NONE, count, (HEIGHT, WIDTH)).astype(np.int32), axis=1)
        self.refinement = ffi.new("vista_refinement *")
        self.refinement.label = ffi.cast("int32_t *", self.label.ctypes.data)

    def clear(self, words: np.ndarray) -> None:
        set_frame(self.frame, "words", words)
        lib.vista_footing_clear(self.frame, self.surfaces, self.regions, self.refinement)

    def ground_px(self) -> np.ndarray:
        v, u = np.mgrid[:HEIGHT, :WIDTH]
        c = self.camera
        return (
            self.surfaces.ground.offset
            + self.slope[0] * (u - c.center_u_px)
            + self.slope[1] * (v - c.center_v_px)
        )


def test_ground_leaves_and_nothing_else() -> None:
    random, left = seeded(1), np.zeros(2, int)
    for _ in range(20):
        foot = Foot(random, 6)
        ground, before = foot.ground_px(), foot.label.copy()
        words = np.rint(16 * np.maximum(ground + random.normal(0, 2, ground.shape), 0)).astype(np.int16)
        words[random.random(words.shape) < 0.4] = -16
        foot.clear(words)

        c, v, u = foot.camera, *np.mgrid[:HEIGHT, :WIDTH]
        normal = np.array([*foot.slope, foot.surfaces.ground.offset / c.focal_px]) / c.baseline_m
        low, beneath, safe = (np.zeros(before.shape, bool) for _ in range(3))
        for k in range(6):
            item = foot.items[k]
            if item.verdict != lib.VISTA_REGION_ACCEPTED:
                continue
            surface = (
                item.disparity_px + item.slope_u * (u - item.mean_u_px) + item.slope_v * (v - item.mean_v_px)
            )
            range_m = c.focal_px * c.baseline_m / item.disparity_px
            height_m = (1 - ground / np.maximum(words / 16, 1e-3)) / np.linalg.norm(normal)
            excess_m = height_m - min(GROUND_M, 0.06 * range_m)
            own = before == k
            low |= own & (words > 0) & (excess_m < 0) & (words / 16 > surface - 1.5)
            beneath |= own & (words <= 0) & (ground > np.maximum(surface + 0.5, 0))
            safe |= own & ((np.abs(excess_m) > 1e-3) | (words <= 0)) & (np.abs(ground - surface - 0.5) > 1e-3)
            safe &= (np.abs(ground) > 1e-3) & (np.abs(words / 16 - surface + 1.5) > 1e-3)
        expected = np.where(low | beneath, NONE, before)
        same = foot.label == expected
        assert np.all(same[safe | (before == NONE)])
        judged = np.isin(before, [k for k in range(6) if foot.items[k].verdict != lib.VISTA_REGION_ACCEPTED])
        assert np.all(same[judged])
        left += np.array([np.count_nonzero(low & safe), np.count_nonzero(beneath & safe)])
    assert left.min() > 1000


def test_without_a_plane_of_ground_nothing_leaves() -> None:
    foot = Foot(seeded(2), 4)
    foot.surfaces.ground_found = False
    before = foot.label.copy()
    foot.clear(np.full((HEIGHT, WIDTH), -16, np.int16))
    assert np.array_equal(foot.label, before)
