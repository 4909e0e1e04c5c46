"""Something too near to match is noticed by texture that is not matched; sky, bare walls, noise, texture that
repeats itself and what is matched are not noticed."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from random_seed import seeded
from shared_data import SHARED_DATA
from stage_library import INVALID, ffi, frame_view, image_struct, lib, status_name
from track_library import BASELINE, CENTER, FOCAL, camera, matched, parameters_with
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
        self._parameters = parameters_with("blind_zone", **changes)
        self.params, self.state = self._parameters.blind_zone, ffi.new("vista_blind_zone *")

    def look(
        self,
        grey: np.ndarray,
        words: np.ndarray,
        radius_m: float = RADIUS_M,
        noise: float | None = None,
        **area: float,
    ) -> None:
        measured = ffi.new("vista_image_noise *")
        assert status_name(lib.vista_image_noise_measure(image_struct("image", grey), measured)) == "VISTA_OK"
        self._parameters.obstacle_map.collision_radius_m = radius_m
        where, lens = matched(**AREA | area), camera(WIDTH, HEIGHT)
        seen = {"image": grey, "words": words, "noise": measured.sigma if noise is None else noise}
        lib.vista_blind_zone_update(frame_view(self._parameters, lens, matched=where, **seen), self.state)


def grainy(random: np.random.Generator, grain_px: float, contrast: float = 40.0) -> np.ndarray:
    wall = cv2.GaussianBlur(random.normal(size=(HEIGHT, WIDTH + 160)), (0, 0), grain_px)
    return 120.0 + contrast * wall / wall.std()


def pair(
    random: np.random.Generator, wall: np.ndarray, shift_px: float, sigma: float = 2.0
) -> tuple[np.ndarray, np.ndarray]:
    """Two cameras' views of a wall at one disparity, with the noise of two sensors."""
    v, u = np.indices((HEIGHT, WIDTH), np.float32)
    shifted = cv2.remap(wall.astype(np.float32), u + np.float32(shift_px), v, cv2.INTER_LINEAR)
    views = wall[:, :WIDTH], shifted  # what is at u in the left image is at u - shift in the right one
    return tuple(noisy(random, view, sigma) for view in views)


def noisy(random: np.random.Generator, image: np.ndarray, sigma: float) -> np.ndarray:
    return np.clip(np.rint(image + random.normal(0.0, sigma, image.shape)), 0, 255).astype(np.uint8)


def disparity(left: np.ndarray, right: np.ndarray, candidates: int = CANDIDATES) -> np.ndarray:
    return StereoEngine(num_disparities=candidates, block_size=BLOCK).compute(left, right)


@pytest.mark.parametrize("grain_px", [1.0, 2.0, 4.0])
@pytest.mark.parametrize(("shift_px", "too_near"), [(20, False), (60, False), (80, True), (150, True)])
def test_a_wall_is_too_near_from_the_range_limit_on(shift_px: int, too_near: bool, grain_px: float) -> None:
    random = seeded(1)
    left, right = pair(random, grainy(random, grain_px), shift_px)
    watch = Watch()
    watch.look(left, disparity(left, right))
    assert watch.state.window == too_near
    assert watch.state.range_m == pytest.approx(FOCAL * BASELINE / (CANDIDATES - 1))


def test_sky_and_bare_walls_say_nothing() -> None:
    random = seeded(2)
    grey = np.clip(random.normal(200, 3, (HEIGHT, WIDTH)), 0, 255).astype(np.uint8)
    watch = Watch()
    watch.look(grey, np.full(grey.shape, INVALID, np.int16))
    assert watch.state.textured_fraction < 0.01
    assert watch.state.window == 0


@pytest.mark.parametrize("sigma", [6.0, 8.0, 10.0])
def test_noise_is_no_texture(sigma: float) -> None:
    """A bare wall beside a weakly textured one, at a range that the engine matches: noise alone steps by 16
    grey levels from sigma 5.8 on, and nothing of it is matched."""
    random = seeded(5)
    wall = grainy(random, 3.0, contrast=4.0)
    wall[:, WIDTH // 2 :] = 120.0
    left, right = pair(random, wall, 20.0, sigma)
    watch = Watch()
    watch.look(left, disparity(left, right))
    assert watch.state.textured_fraction < 0.05
    assert watch.state.window == 0
    step = np.abs(left[:, 2:].astype(int) - left[:, :-2])
    assert np.mean(step >= 16) > 0.05  # against grey levels alone it would have texture


@pytest.mark.parametrize("sigma", [4.0, 8.0])
@pytest.mark.parametrize("grain_px", [1.0, 2.0])
def test_a_wall_that_is_too_near_is_noticed_under_noise(grain_px: float, sigma: float) -> None:
    random = seeded(6)
    left, right = pair(random, grainy(random, grain_px), 100.0, sigma)
    watch = Watch()
    watch.look(left, disparity(left, right))
    assert watch.state.window == 1


@pytest.mark.skipif(not SHARED_DATA.is_dir(), reason="no shared data")
@pytest.mark.parametrize("sigma", [0.0, 6.0])
def test_a_real_scene_beyond_the_candidates_is_too_near(sigma: float) -> None:
    """Cones and masks, disparities 20 to 60, before an engine of 16 candidates."""
    folder, random = SHARED_DATA / "middlebury" / "cones", seeded(10)
    views = [cv2.imread(str(folder / name), cv2.IMREAD_GRAYSCALE) for name in ("im2.png", "im6.png")]
    left, right = (noisy(random, view, sigma) for view in views)
    left, right = (
        cv2.copyMakeBorder(x, 0, HEIGHT - x.shape[0], 0, WIDTH - x.shape[1], 0) for x in (left, right)
    )
    watch = Watch()
    watch.look(left, disparity(left, right, 16), disparity_max_px=15.0, margin_left_px=15.0 + BLOCK // 2)
    assert watch.state.window == 1


def test_fractions_are_those_of_the_disc() -> None:
    """The fractions are worked out in numpy, over every second row."""
    random = seeded(3)
    grey = random.integers(0, 256, (HEIGHT, WIDTH), np.uint8)
    words = np.where(random.random(grey.shape) < 0.7, random.integers(100, 200, grey.shape), INVALID)
    words = words.astype(np.int16)
    for radius_m in (0.5, 2.0, 9.0):
        watch = Watch()
        watch.look(grey, words, radius_m, noise=0.0)
        v, u = np.mgrid[:HEIGHT, :WIDTH]
        reach_px = radius_m * AREA["disparity_max_px"] / BASELINE
        inside = np.hypot(u - CENTER[0], v - CENTER[1]) <= reach_px
        inside &= (u >= AREA["margin_left_px"] + BLOCK + 1) & (u <= WIDTH - 1 - AREA["margin_px"] - BLOCK - 1)
        inside &= (v >= AREA["margin_px"]) & (v <= HEIGHT - 1 - AREA["margin_px"])
        inside &= (v - v[inside].min()) % 2 == 0
        step = np.abs(np.roll(grey, -1, 1).astype(int) - np.roll(grey, 1, 1))
        textured = inside & (step >= 16)
        assert watch.state.textured_fraction == pytest.approx(textured.sum() / inside.sum())
        aside = np.stack([np.roll(words, BLOCK + 1, 1), np.roll(words, -BLOCK - 1, 1)]).astype(int)
        alike = (aside >= 0) & (np.abs(aside - words) <= 16)
        is_matched = (words >= 0) & alike.any(axis=0)
        assert watch.state.unmatched_fraction == pytest.approx(np.mean(~is_matched[textured]))


def test_it_takes_m_of_n_frames() -> None:
    random = seeded(4)
    grey, _ = pair(random, grainy(random, 2.0), 0.0)
    unmatched, clear = np.full(grey.shape, INVALID, np.int16), np.full(grey.shape, 160, np.int16)
    watch, found = Watch(confirm_hits=3, confirm_window=5), []
    for letter in "x.x.xx....x":
        watch.look(grey, unmatched if letter == "x" else clear)
        found.append(watch.state.occupied)
    assert found == [False] * 4 + [True] * 3 + [False] * 4
