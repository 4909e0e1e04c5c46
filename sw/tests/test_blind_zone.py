"""Something too near to match is noticed by texture that is not matched; sky, bare walls and what is matched
are not noticed."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from random_seed import seeded
from stage_arena import ffi, lib, status_name
from stage_library import INVALID, image_struct
from track_library import BASELINE, CENTER, FOCAL, camera, matched, params
from vista.engine import StereoEngine

WIDTH, HEIGHT, CANDIDATES, BLOCK = 640, 480, 64, 11
RADIUS_M = 2.0
AREA = {
    "disparity_max_px": CANDIDATES - 1.0,
    "margin_left_px": CANDIDATES - 1.0 + BLOCK // 2,
    "margin_px": float(BLOCK // 2),
}


class Watch:
    """A blind_zone from frame to frame."""

    def __init__(self, **changes: float) -> None:
        self.params, self.camera = params("blind_zone", **changes), camera(WIDTH, HEIGHT)
        self.state = ffi.new("vista_blind_zone *")

    def look(self, grey: np.ndarray, words: np.ndarray, radius_m: float = RADIUS_M) -> str:
        images = image_struct("image", grey), image_struct("disparity_image", words)
        return status_name(
            lib.vista_blind_zone_update(
                self.params, self.camera, matched(**AREA), radius_m, *images, self.state
            )
        )


def pair(random: np.random.Generator, shift_px: int, grain_px: float) -> tuple[np.ndarray, np.ndarray]:
    """A textured wall at one disparity, with the noise of two sensors."""
    wall = cv2.GaussianBlur(random.normal(size=(HEIGHT, WIDTH + shift_px)), (0, 0), grain_px)
    wall = 120.0 + 40.0 * wall / wall.std()
    views = [
        wall[:, :WIDTH],
        wall[:, shift_px:],
    ]  # what is at u in the left image is at u - shift in the right one
    return tuple(np.clip(v + random.normal(0, 2, v.shape), 0, 255).astype(np.uint8) for v in views)


def disparity(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return StereoEngine(num_disparities=CANDIDATES, block_size=BLOCK).compute(left, right)


@pytest.mark.parametrize("grain_px", [1.0, 2.0, 4.0])
@pytest.mark.parametrize(("shift_px", "too_near"), [(20, False), (60, False), (80, True), (150, True)])
def test_a_wall_is_too_near_from_the_range_limit_on(shift_px: int, too_near: bool, grain_px: float) -> None:
    left, right = pair(seeded(1), shift_px, grain_px)
    watch = Watch()
    assert watch.look(left, disparity(left, right)) == "VISTA_OK"
    assert watch.state.window == too_near
    assert watch.state.range_m == pytest.approx(FOCAL * BASELINE / (CANDIDATES - 1))


def test_sky_and_bare_walls_say_nothing() -> None:
    random = seeded(2)
    grey = np.clip(random.normal(200, 3, (HEIGHT, WIDTH)), 0, 255).astype(np.uint8)
    watch = Watch()
    watch.look(grey, np.full(grey.shape, INVALID, np.int16))
    assert watch.state.textured_fraction < 0.01
    assert watch.state.window == 0


def test_fractions_are_those_of_the_disc() -> None:
    """In numpy, over every second row."""
    random = seeded(3)
    grey = random.integers(0, 256, (HEIGHT, WIDTH), np.uint8)
    words = np.where(random.random(grey.shape) < 0.7, random.integers(100, 200, grey.shape), INVALID)
    words = words.astype(np.int16)
    for radius_m in (0.5, 2.0, 9.0):
        watch = Watch(contrast=100)
        watch.look(grey, words, radius_m)
        v, u = np.mgrid[:HEIGHT, :WIDTH]
        reach_px = radius_m * AREA["disparity_max_px"] / BASELINE
        inside = np.hypot(u - CENTER[0], v - CENTER[1]) <= reach_px
        inside &= (u >= AREA["margin_left_px"] + BLOCK + 1) & (u <= WIDTH - 1 - AREA["margin_px"] - BLOCK - 1)
        inside &= (v >= AREA["margin_px"]) & (v <= HEIGHT - 1 - AREA["margin_px"])
        inside &= (v - v[inside].min()) % 2 == 0
        step = np.abs(np.roll(grey, -1, 1).astype(int) - np.roll(grey, 1, 1))
        textured = inside & (step >= 100)
        assert watch.state.textured_fraction == pytest.approx(textured.sum() / inside.sum())
        aside = np.stack([np.roll(words, BLOCK + 1, 1), np.roll(words, -BLOCK - 1, 1)]).astype(int)
        alike = (aside >= 0) & (np.abs(aside - words) <= 16)
        is_matched = (words >= 0) & alike.any(axis=0)
        assert watch.state.unmatched_fraction == pytest.approx(np.mean(~is_matched[textured]))


def test_it_takes_m_of_n_frames() -> None:
    grey = seeded(4).integers(0, 256, (HEIGHT, WIDTH), np.uint8)
    unmatched, clear = np.full(grey.shape, INVALID, np.int16), np.full(grey.shape, 160, np.int16)
    watch, found = Watch(confirm_hits=3, confirm_window=5), []
    for letter in "x.x.xx....x":
        watch.look(grey, unmatched if letter == "x" else clear)
        found.append(watch.state.occupied)
    assert found == [False] * 4 + [True] * 3 + [False] * 4


def test_wrong_arguments_are_refused() -> None:
    watch, grey = Watch(), np.zeros((HEIGHT, WIDTH), np.uint8)
    assert watch.look(grey, np.zeros((HEIGHT, WIDTH - 1), np.int16)) == "VISTA_ERROR_SIZE"
    assert watch.look(grey[1:], np.zeros((HEIGHT, WIDTH), np.int16)) == "VISTA_ERROR_SIZE"
    images = image_struct("image", grey), image_struct("disparity_image", np.zeros(grey.shape, np.int16))
    pointers = [watch.params, watch.camera, matched(), RADIUS_M, *images, watch.state]
    for i in (0, 1, 2, 4, 5, 6):
        arguments = pointers.copy()
        arguments[i] = ffi.NULL
        assert status_name(lib.vista_blind_zone_update(*arguments)) == "VISTA_ERROR_ARGUMENT"
