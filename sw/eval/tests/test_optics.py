"""Each fault of lens and sensor does to a picture what it is called."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from random_seed import seed_of
from vista_eval.render.course import Course, rotation_from_angles
from vista_eval.render.flight import Flight, exposure_of
from vista_eval.render.optics import Exposure, FlawedSensor, dirt, image_motion_px, through_lens
from vista_eval.render.rig import LEFT, RIGHT, Rig, View
from vista_eval.render.scene import Scene
from vista_eval.render.sensor import Sensor, expose

RIG = Rig(width_px=320, height_px=240, focal_px=500.0, baseline_m=0.4572)
SHAPE = RIG.height_px, RIG.width_px


def pose(x_m: float = 0.0, yaw_deg: float = 0.0, camera: int = LEFT) -> np.ndarray:
    body = np.eye(4)
    body[:3, :3] = rotation_from_angles(0.0, 0.0, yaw_deg)
    body[0, 3] = x_m
    return body @ RIG.body_from_camera(camera)


def still(
    camera: int = LEFT, depth_m: float = 20.0, to_sun: tuple[float, float, float] = (-1, 0, 1)
) -> Exposure:
    middle = pose(camera=camera)
    return Exposure(RIG, camera, middle, middle, middle, np.full(SHAPE, depth_m), to_sun, 1)


def points(random: np.random.Generator) -> np.ndarray:
    """Single bright pixels, 40 px apart."""
    image = np.zeros(SHAPE, np.float32)
    image[20::40, 20::40] = random.uniform(1, 2)
    return image


def test_without_faults_nothing_changes() -> None:
    image = np.random.default_rng(seed_of("none")).random(SHAPE, np.float32)
    np.testing.assert_array_equal(through_lens(FlawedSensor(), image, still()), image)


def test_defocus_makes_a_disc_of_a_point_in_one_camera() -> None:
    """The second moment of a disc of radius r is r^2 / 4 along each axis, and all the light is kept."""
    image = np.zeros(SHAPE, np.float32)
    image[120, 160] = 3.0
    lens = FlawedSensor(defocus_px=(0.0, 2.5))
    np.testing.assert_array_equal(through_lens(lens, image, still(LEFT)), image)
    blurred = through_lens(lens, image, still(RIGHT))
    v, u = np.indices(SHAPE)
    assert blurred.sum() == pytest.approx(3.0, rel=1e-4)
    assert (blurred * (u - 160)).sum() == pytest.approx(0.0, abs=1e-3)
    for offset in (u - 160, v - 120):
        assert (blurred * offset**2).sum() / 3 == pytest.approx(2.5**2 / 4 + 1 / 12, rel=0.06)


def test_the_image_moves_as_the_camera_does() -> None:
    """Forward by 0.2 m at 20 m, everything moves away from the middle by 1 %; a turn to the left by 0.1
    degrees moves everything to the right by f times that, near or far."""
    ahead = replace(still(), opens=pose(-0.1), closes=pose(0.1))
    motion = image_motion_px(ahead)
    v, u = np.indices(SHAPE)
    np.testing.assert_allclose(motion[..., 0], 0.01 * (u - 159.5), atol=2e-3)
    np.testing.assert_allclose(motion[..., 1], 0.01 * (v - 119.5), atol=2e-3)
    far = replace(still(depth_m=np.inf), opens=pose(yaw_deg=-0.05), closes=pose(yaw_deg=0.05))
    motion = image_motion_px(far)
    assert motion[120, 160] == pytest.approx([500 * np.radians(0.1), 0.0], abs=1e-3)


def test_motion_smears_along_the_motion_only_and_keeps_the_middle() -> None:
    """A turn by 0.6 degrees is 5.24 px wide: a line across it becomes as wide, a line along it stays."""
    turning = replace(still(), opens=pose(yaw_deg=-0.3), closes=pose(yaw_deg=0.3))
    upright, level = np.zeros(SHAPE, np.float32), np.zeros(SHAPE, np.float32)
    upright[:, 160], level[120, :] = 1.0, 1.0
    lens = FlawedSensor(exposure_s=0.01)
    row = through_lens(lens, upright, turning)[120]
    u = np.arange(RIG.width_px)
    assert row.sum() == pytest.approx(1.0, rel=0.02)
    assert (row * u).sum() == pytest.approx(160.0, abs=0.1)
    # The variance of a box, of the taps' spacing and of the linear interpolation.
    assert (row * (u - 160) ** 2).sum() == pytest.approx(5.236**2 / 12, abs=0.3)
    column = through_lens(lens, level, turning)[:, 160]
    assert column[120] > 0.97
    still_row = through_lens(lens, upright, still())[120]
    assert still_row[160] == 1.0


def test_vignetting_darkens_the_corners_by_its_share() -> None:
    seen = through_lens(FlawedSensor(vignetting=0.4), np.ones(SHAPE, np.float32), still())
    assert seen[0, 0] == seen[-1, -1] == pytest.approx(0.6, abs=1e-3)
    assert seen[120, 160] == pytest.approx(1.0, abs=1e-3)
    radius = np.hypot(*(np.indices(SHAPE).T - [119.5, 159.5]).T)
    order = np.argsort(radius.ravel())
    assert np.all(np.diff(seen.ravel()[order]) < 1e-6)


def test_glare_veils_what_is_near_the_sun_in_both_cameras_alike() -> None:
    black, lens = np.zeros(SHAPE, np.float32), FlawedSensor(glare=0.5)
    ahead = (1.0, 0.1, 0.12)
    left, right = (through_lens(lens, black, still(camera, to_sun=ahead)) for camera in (LEFT, RIGHT))
    np.testing.assert_array_equal(left, right)
    place = np.unravel_index(np.argmax(left), SHAPE)
    assert place == pytest.approx((119.5 - 500 * 0.12, 159.5 - 500 * 0.1), abs=1.5)
    assert left.max() == pytest.approx(0.5, rel=0.1) and left.min() > 0.01
    behind = through_lens(lens, black, still(to_sun=(-1.0, 0.1, 0.3)))
    assert behind.max() == 0.0
    aside = through_lens(lens, black, still(to_sun=(0.6, 0.8, 0.3)))
    assert 0 < aside.max() < 0.2 * left.max()


def test_dirt_lies_on_one_lens_and_stays_there() -> None:
    image = np.ones(SHAPE, np.float32)
    lens = FlawedSensor(dirt=(0.0, 0.1))
    np.testing.assert_array_equal(through_lens(lens, image, still(LEFT)), image)
    first, second = (through_lens(lens, image, still(RIGHT)) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    other = through_lens(lens, image, replace(still(RIGHT), seed=2))
    assert np.any(other != first)
    assert first.min() < 0.8 and first.max() <= 1.0
    for seed in range(5):
        covered = (dirt(SHAPE, 0.1, (seed, RIGHT)) > 0.1).mean()
        assert 0.1 <= covered < 0.16


@pytest.mark.parametrize("grey", [1.0, 4.0, 10.0])
def test_noise_is_as_strong_as_asked_in_the_dark(grey: float) -> None:
    black = np.full((300, 400), 0.2, np.float32)
    sensor = Sensor().with_noise(grey)
    image = expose(sensor, black, LEFT, (seed_of("noise"), 0)).astype(float)
    shot = np.sqrt(0.2 * sensor.full_well_e) * 255 / sensor.full_well_e
    assert image.std() == pytest.approx(np.sqrt(grey**2 + shot**2 + 1 / 12), rel=0.03)


def test_rows_of_the_right_camera_are_off_as_asked() -> None:
    rig = replace(RIG, right_roll_deg=0.0).with_rows_off(0.7)
    nominal, mounted = rig.body_from_camera(RIGHT), rig.body_from_mounted_camera(RIGHT)
    point = np.array([20.0, 0.0, 0.0, 1.0])
    (_, v0), (u, v1) = (rig.project((np.linalg.inv(p) @ point)[:3]) for p in (nominal, mounted))
    assert v1 - v0 == pytest.approx(0.7, abs=0.01)
    assert u == pytest.approx(rig.project((np.linalg.inv(nominal) @ point)[:3])[0], abs=0.01)


def test_what_is_too_bright_is_clipped_after_the_lens() -> None:
    """Defocus spreads the light of what is clipped: it is done before, not after."""
    image = np.zeros(SHAPE, np.float32)
    image[100:104, 100:104] = 50.0
    seen = through_lens(FlawedSensor(defocus_px=(3.0, 3.0)), image, still())
    grey = expose(Sensor(), seen, LEFT, (1,))
    assert grey[102, 105] == 255 and cv2.countNonZero((grey == 255).astype(np.uint8)) > 30


class EmptyScene:
    """The part of a renderer that an exposure needs."""

    scene = Scene((), to_sun=(-1.0, 0.0, 0.0))

    def view(self, world_from_camera: np.ndarray) -> View:
        return View(np.full(SHAPE, np.inf), np.zeros(SHAPE, np.int32))


def test_the_shutter_opens_on_the_course_that_is_flown() -> None:
    """Only the last 5 of a flight of 20 frames are flown: its first frame is the sixteenth of the whole."""
    whole = Course(6.0, 10.0, last_range_m=20.0, frames=20, rate_hz=10.0, sway_scale=0.0)
    flight = Flight("f", "f", "dev", whole, lambda altitude_m, seed: EmptyScene.scene, rig=RIG)
    flown, lens = replace(whole, frames=5), FlawedSensor(exposure_s=0.01)
    exposure = exposure_of(EmptyScene(), flight, lens, flown, LEFT, 0)
    places_m = [pose[0, 3] for pose in (exposure.opens, exposure.middle, exposure.closes)]
    assert places_m == pytest.approx([-24.05, -24.0, -23.95])
