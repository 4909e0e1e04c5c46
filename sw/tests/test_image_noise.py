"""The noise of an image is estimated from the image alone: pictures with known noise added."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from random_seed import seeded
from shared_data import SHARED_DATA
from stage_library import ffi, image_struct, lib, status_name

SIGMAS = (0.0, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0)
REAL = {  # folder, what lies in it
    "KITTI odometry": ("kitti_odometry", "**/image_0/*.png"),
    "KITTI 2012": ("kitti2012", "*_0/*_10.png"),
    "EuRoC": ("euroc_v101", "**/cam0/data/*.png"),
    "Middlebury": ("middlebury", "*/im2.png"),
}


def estimate(image: np.ndarray) -> float:
    noise = ffi.new("vista_image_noise *")
    assert status_name(lib.vista_image_noise_measure(image_struct("image", image), noise)) == "VISTA_OK"
    return noise.sigma


def noisy(image: np.ndarray, sigma: float, seed: int = 1) -> np.ndarray:
    return np.clip(np.rint(image + seeded(seed).normal(0.0, sigma, image.shape)), 0, 255).astype(np.uint8)


def scene(texture: float, flat_share: float) -> np.ndarray:
    """Shaded sky over boards of texture and sharp edges, 640x480."""
    random = seeded(2)
    v, u = np.mgrid[:480, :640]
    image = 150.0 + 0.05 * u + 0.1 * v
    for _ in range(40):
        u0, v0 = random.integers(0, 600), random.integers(int(480 * flat_share), 480)
        image[v0 : v0 + random.integers(10, 120), u0 : u0 + random.integers(10, 120)] = random.uniform(
            30, 220
        )
    below = cv2.GaussianBlur(random.normal(size=image.shape), (0, 0), 1.0)
    rows = v >= 480 * flat_share
    return np.where(rows, image + texture * below / below.std(), image)


@pytest.mark.parametrize("texture", [0.0, 10.0, 40.0])
@pytest.mark.parametrize("sigma", SIGMAS)
def test_flat_parts_tell_the_noise_whatever_the_rest_shows(sigma: float, texture: float) -> None:
    """A third of the picture is sky."""
    assert estimate(noisy(scene(texture, 0.34), sigma)) == pytest.approx(sigma, rel=0.12, abs=0.4)


@pytest.mark.parametrize("sigma", [2.0, 6.0, 10.0])
def test_clipped_parts_do_not_hide_it(sigma: float) -> None:
    """Neither a burnt-out sky nor the black border of a rectified image."""
    image = scene(5.0, 0.34)
    image[:240] = 300.0
    image[:, :60] = -60.0
    image[240:, 300:] = 120.0
    assert estimate(noisy(image, sigma)) == pytest.approx(sigma, rel=0.15, abs=0.4)


def test_where_all_is_clipped_there_is_what_is_left_of_it() -> None:
    assert estimate(np.full((100, 100), 255, np.uint8)) == 0.0
    assert 1.0 < estimate(noisy(np.zeros((240, 320)), 8.0)) < 8.0


@pytest.mark.parametrize("sigma", [4.0, 8.0])
def test_rectification_does_not_hide_it(sigma: float) -> None:
    """Interpolation halves the noise of pixels and of their steps alike, and joins neighbours."""
    v, u = np.indices((480, 640), np.float32)
    image = cv2.remap(noisy(scene(10.0, 0.34), sigma), 0.997 * u + 0.4, 0.997 * v + 0.3, cv2.INTER_LINEAR)
    flat = image[:150].astype(int)
    step = np.std(flat[:, 2:] - flat[:, :-2]) / np.sqrt(2.0)
    assert estimate(image) == pytest.approx(step, rel=0.25)


def test_a_picture_of_texture_alone_is_taken_for_noisy_but_keeps_its_texture() -> None:
    """Foliage from edge to edge, as fine as pixels: what four sigmas of the estimate leave of it is still
    more than the blind-zone check asks for."""
    foliage = noisy(scene(40.0, 0.0), 2.0)
    steps = np.abs(foliage[:, 2:].astype(int) - foliage[:, :-2])
    assert estimate(foliage) > 10.0
    assert np.mean(steps >= 4.0 * estimate(foliage)) > 0.05


def files_of(name: str) -> list[Path]:
    folder, pattern = REAL[name]
    found = sorted((SHARED_DATA / folder).glob(pattern))[::2]  # of KITTI 2012 the development half
    return found[:: max(1, len(found) // 8)][:8]


@pytest.mark.parametrize("name", REAL)
def test_noise_added_to_real_images_is_measured(name: str) -> None:
    """The image's own noise adds in squares; sigma 6 and more is within a quarter in every picture."""
    images = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in files_of(name)]
    images = [image for image in images if image is not None]
    if not images:
        pytest.skip(f"no shared data of {name}")
    for image in images:
        found = [estimate(noisy(image, sigma)) for sigma in SIGMAS]
        print(name, " ".join(f"{value:.2f}" for value in found))
        # One more grey level is seen, but on top of four and more it may not fill a bin of the histogram.
        assert found[1] > found[0] or (found[0] > 4.0 and found[1] >= found[0] - 0.06)
        assert np.all(np.diff(found[1:]) > 0.0)
        for sigma, value in zip(SIGMAS, found, strict=True):
            if sigma >= 6.0:
                assert value == pytest.approx(np.hypot(sigma, found[0]), rel=0.2), sigma


def test_small_images_and_strides() -> None:
    wide = noisy(np.full((80, 700), 128.0), 5.0)
    assert estimate(wide) == pytest.approx(5.0, rel=0.15)
    assert estimate(wide[:, 3:640]) == pytest.approx(5.0, rel=0.15)
    assert estimate(wide[:19, :19]) == 0.0
    assert status_name(lib.vista_image_noise_measure(ffi.NULL, ffi.new("vista_image_noise *"))) == (
        "VISTA_ERROR_ARGUMENT"
    )
