"""The sensor's noise against its own model, and what makes a flight's digest change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from vista_eval.cache import content_sha256
from vista_eval.render.motion import solids_at
from vista_eval.render.rig import LEFT, RIGHT
from vista_eval.render.scene import Scene, Sphere, Sway, thing
from vista_eval.render.sensor import Sensor, expose
from vista_eval.sensor_noise import noisy_image

SENSOR = Sensor()


@pytest.mark.parametrize("radiance", [0.02, 0.2, 0.7])
def test_noise_is_that_of_the_electrons(radiance: float) -> None:
    """Shot noise sqrt(N), read noise, and 1/12 for the 8 bits; 120,000 pixels put 1 % on a variance."""
    grey = expose(SENSOR, np.full((300, 400), radiance), LEFT, (1,)).astype(float)
    electrons = radiance * SENSOR.full_well_e
    per_electron = 255 / SENSOR.full_well_e
    assert grey.mean() == pytest.approx(electrons * per_electron, abs=0.02)
    variance = (electrons + SENSOR.read_noise_e**2) * per_electron**2 + 1 / 12
    assert grey.var() == pytest.approx(variance, rel=0.03)


def test_cameras_differ_in_gain_and_clip() -> None:
    radiance = np.array([[0.5] * 4000, [1.6] * 4000])
    left, right = (expose(SENSOR, radiance, camera, (1, camera)).astype(float) for camera in (LEFT, RIGHT))
    assert right[0].mean() / left[0].mean() == pytest.approx(1.03, abs=2e-3)
    assert np.all(left[1] == 255) and np.all(right[1] == 255)


@pytest.mark.parametrize("sigma", [2.0, 10.0])
def test_added_noise_has_its_sigma_and_a_seed_for_each_image(sigma: float) -> None:
    flat = np.full((300, 400), 128, np.uint8)
    images = [
        noisy_image(flat, sigma, (1, frame, camera)).astype(float) for frame in (0, 1) for camera in (0, 1)
    ]
    for image in images:
        assert image.std() == pytest.approx(np.hypot(sigma, 1 / 12**0.5), rel=0.02)
    correlation = np.corrcoef([image.ravel() for image in images])
    assert np.abs(correlation - np.eye(4)).max() < 0.02
    np.testing.assert_array_equal(images[0], noisy_image(flat, sigma, (1, 0, 0)))
    burnt = noisy_image(np.full((50, 50), 254, np.uint8), sigma, (2,))
    assert burnt.max() == 255 and burnt.min() < 254


def scene(albedo: float = 0.5, x_m: float = 0.0) -> Scene:
    ball = Sphere("ball", (x_m, 0.0, 5.0), 1.0, np.full((8, 8), albedo, np.float32))
    return Scene((thing("ball", "ball", [ball]),), to_sun=(-0.6, 0.4, 0.7))


def test_a_digest_stands_for_the_content() -> None:
    reference = content_sha256(scene(), (1, 4))
    assert content_sha256(scene(), (1, 4)) == reference
    swaying = replace(scene().things[0], sway=Sway(0.1, 0.5))
    others = [
        (scene(albedo=0.51), (1, 4)),
        (scene(x_m=1e-3), (1, 4)),
        (replace(scene(), exposure=1.1), (1, 4)),
        (Scene((swaying,), scene().to_sun), (1, 4)),
        (scene(), (2, 4)),
    ]
    digests = {content_sha256(*other) for other in others}
    assert len(digests) == len(others) and reference not in digests


def test_things_are_in_place_at_the_last_frame_and_sway_about_it() -> None:
    still = scene().things[0]
    moving = replace(still, velocity_m_s=(0.0, 2.0, 0.0))
    assert solids_at(still, -3.0) == still.solids
    assert solids_at(moving, 0.0)[0].center_m == pytest.approx((0.0, 0.0, 5.0))
    assert solids_at(moving, -3.0)[0].center_m == pytest.approx((0.0, -6.0, 5.0))
    swaying = replace(still, sway=Sway(0.1, 0.5))
    offsets = np.array([solids_at(swaying, -t)[0].center_m for t in np.arange(0, 20, 0.1)]) - [0, 0, 5]
    assert 0.09 < np.abs(offsets[:, 1]).max() <= 0.1
    assert np.abs(offsets[:, [0, 2]]).max() <= 0.03
    assert np.abs(offsets.mean(axis=0)).max() < 0.02
