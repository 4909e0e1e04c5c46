"""Regions of edges along the rows are unknown; other edges, and textures, are left to other tests."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from random_seed import seeded
from region_cases import box, measure, verdict
from stage_library import Stages, camera, lib, words_of

NOISE = 2.0
WHERE = box((160, 100), 70, 12)


def band(random: np.random.Generator, incline_deg: float) -> np.ndarray:
    """Straight edges at one inclination, with a smooth random profile of brightness across them."""
    v, u = np.mgrid[:240, :320]
    turned = np.radians(incline_deg)
    across_px = (v - 100) * np.cos(turned) - (u - 160) * np.sin(turned)
    profile = cv2.GaussianBlur(random.uniform(40, 220, (1, 1001)), (0, 0), 1.5).ravel()
    return np.interp(across_px, np.arange(-500, 501), profile)


def judge(stages: Stages, image: np.ndarray, noise: float) -> None:
    stages.see(image=image, noise=noise)
    lib.vista_row_edges_judge(stages.frame, stages.cells, stages.regions)


def judged(grey: np.ndarray, random: np.random.Generator, noise: float = NOISE) -> str:
    """The verdict of a region that is accepted by its words, of an image with that noise."""
    stages = Stages(camera())
    words = words_of(np.where(WHERE, 12.0, 2.0), random, 0.1)
    region = measure(stages, words, [WHERE])[0]
    assert verdict(region) == "ACCEPTED"
    noisy = np.clip(grey + random.normal(0, noise, grey.shape), 0, 255).astype(np.uint8)
    judge(stages, noisy, noise)
    found = verdict(stages.regions.items[0])
    assert stages.regions.accepted_count == (found == "ACCEPTED")
    return found


@pytest.mark.parametrize("noise", [0.5, 1.5, 3.0])
def test_edges_along_the_rows_tell_nothing(noise: float) -> None:
    """The limit is at atan(1 / 8) = 7.1 degrees without noise, of which a tenth counts as gradients along the
    rows: the contrast of the drawn profiles is several times the strongest noise here."""
    random = seeded(1)
    for _ in range(5):
        incline_deg = random.uniform(-4, 4)
        assert judged(band(random, incline_deg), random, noise) == "UNKNOWN", incline_deg


@pytest.mark.parametrize("noise", [0.5, 2.0, 6.0])
def test_steeper_edges_tell_their_disparity(noise: float) -> None:
    random = seeded(2)
    for _ in range(5):
        incline_deg = random.choice([-1, 1]) * random.uniform(13, 90)
        assert judged(band(random, incline_deg), random, noise) == "ACCEPTED", incline_deg


def test_textures_tell_their_disparity() -> None:
    """Also those that are three times as long as they are high, as a board of wood is grained."""
    random = seeded(3)
    for stretch in (1.0, 3.0):
        grain = cv2.GaussianBlur(random.normal(0, 1, (240, 320)), (0, 0), 2.0 * stretch, sigmaY=2.0)
        assert judged(120 + 20 * grain / grain.std(), random) == "ACCEPTED"


def test_an_upright_end_is_enough() -> None:
    """A plank along a row, both of whose ends are seen."""
    random = seeded(4)
    plank = np.where(box((160, 100), 25, 5), 60.0, 150.0)
    assert judged(cv2.GaussianBlur(plank, (0, 0), 0.8), random) == "ACCEPTED"


def test_noise_alone_is_no_edge() -> None:
    """Chance matches of what has no texture are for other tests to judge."""
    random = seeded(5)
    for noise in (1.0, 5.0, 12.0):
        assert judged(np.full((240, 320), 120.0), random, noise) == "ACCEPTED"


def test_plain_regions_have_no_words_to_judge() -> None:
    random = seeded(6)
    stages = Stages(camera())
    measure(stages, words_of(np.where(WHERE, 12.0, 2.0), random, 0.1), [WHERE])
    stages.regions.items[0].plain = True
    image = np.clip(band(random, 0.0), 0, 255).astype(np.uint8)
    judge(stages, image, 0.5)
    assert verdict(stages.regions.items[0]) == "ACCEPTED"
    stages.regions.items[0].plain = False
    judge(stages, image, 0.5)
    assert verdict(stages.regions.items[0]) == "UNKNOWN"
