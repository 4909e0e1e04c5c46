"""Health: what of a frame makes it degraded or blind, and what ordinary frames are."""

from __future__ import annotations

import math

import board_flight as scene
import cv2
import numpy as np
import pytest
from board_flight import board_flight
from pipeline_library import CALIBRATION, Frame, Pipeline
from random_seed import seeded
from stage_library import Stages, camera, ffi, image_struct, lib
from track_library import flight_path, matched, motion
from vista import StereoEngine
from vista.geometry import Pose
from vista.pipeline import Pipeline as PythonPipeline

WIDTH, HEIGHT = 160, 120
AREA = (slice(5, HEIGHT - 5), slice(36, WIDTH - 5))  # of track_library.MATCHED


def textured(sigma: float = 0.0) -> np.ndarray:
    """Blobs as large as cells, with noise of that many grey levels."""
    random = seeded(1)
    blobs = cv2.GaussianBlur(random.normal(size=(HEIGHT, WIDTH)), (0, 0), 4.0)
    image = 128.0 + 40.0 * blobs / blobs.std() + random.normal(0.0, sigma, blobs.shape)
    return np.clip(image, 0, 255).astype(np.uint8)


def words(fraction: float) -> np.ndarray:
    """That share of the matched pixels has a disparity, and none of the others."""
    image = np.full((HEIGHT, WIDTH), -16, np.int16)
    inside = image[AREA].reshape(-1)
    inside[: math.ceil(fraction * inside.size)] = 80
    image[AREA] = inside.reshape(image[AREA].shape)
    return image


def judge(
    image: np.ndarray, disparity: np.ndarray, *, how=None, area=None, up=None, radius_m=2.0, **changes: float
):
    """State, reasons, the struct, and the valid fraction. up: in the camera, if known."""
    stages = Stages(camera(WIDTH, HEIGHT))
    stages.parameters.obstacle_map.collision_radius_m = radius_m
    for name, value in changes.items():
        setattr(stages.parameters.health, name, value)
    stages.foveate(image, disparity)
    how, noise = how or motion(), ffi.new("vista_image_noise *")
    lib.vista_image_noise_measure(image_struct("image", image), noise)
    stages.see(up, up_known=up is not None, matched=area or matched(), noise=noise.sigma)
    stages.see(motion=how, path=flight_path(how))
    health, fraction = ffi.new("vista_health *"), ffi.new("double *")
    lib.vista_health_judge(stages.frame, stages.cells, health, fraction)
    state = ffi.string(lib.vista_health_state_name(health.state)).decode()
    numbers = [k for k in range(lib.VISTA_HEALTH_REASON_COUNT) if health.reasons >> k & 1]
    names = [ffi.string(lib.vista_health_reason_name(k)).decode() for k in numbers]
    return state, names, health, fraction[0]


@pytest.mark.parametrize(
    ("fraction", "state", "reasons"),
    [
        (1.0, "healthy", []),
        (0.101, "healthy", []),
        (0.099, "degraded", ["few_disparities"]),
        (0.021, "degraded", ["few_disparities"]),
        (0.019, "blind", ["no_disparities"]),
        (0.0, "blind", ["no_disparities"]),
    ],
)
def test_disparities_that_are_few(fraction: float, state: str, reasons: list[str]) -> None:
    disparity = words(fraction)
    found = judge(textured(), disparity, degraded_fraction=0.1, blind_fraction=0.02)
    assert found[:2] == (state, reasons)
    assert found[2].matched_fraction == pytest.approx(fraction, abs=1e-3)
    assert found[3] == np.mean(disparity >= 0)


@pytest.mark.parametrize(
    ("grey", "noise", "state"),
    [(0, 0.0, "blind"), (255, 0.0, "blind"), (90, 3.0, "blind"), (90, 20.0, "blind"), (90, 8.0, "healthy")],
)
def test_an_image_of_one_grey_level_is_blind(grey: float, noise: float, state: str) -> None:
    """However well chance has matched it: the noise of the sensor is no contrast."""
    image = np.clip(seeded(2).normal(grey, noise, (HEIGHT, WIDTH)), 0, 255).astype(np.uint8)
    if state == "healthy":
        image[:, : WIDTH // 2] //= 2
    found = judge(image, words(0.6))
    assert found[:2] == (state, [] if state == "healthy" else ["no_contrast"])


@pytest.mark.parametrize(
    ("source", "restarted", "reasons"),
    [
        ("POSE", False, []),
        ("STANDS", False, []),
        ("UNTOLD", False, []),  # nobody gave a pose: nothing is missing
        ("CARRIED_ON", False, ["motion_unknown"]),
        ("REFUSED", False, ["pose_jump"]),
        ("POSE", True, ["pose_jump"]),
    ],
)
def test_poses_that_are_missing_or_jump(source: str, restarted: bool, reasons: list[str]) -> None:
    how = motion(source=getattr(lib, f"VISTA_MOTION_{source}"), restarted=restarted)
    state = "degraded" if reasons else "healthy"
    assert judge(textured(), words(0.5), how=how)[:2] == (state, reasons)
    assert judge(textured(), words(0.0), how=how)[:2] == ("blind", ["no_disparities", *reasons])


@pytest.mark.parametrize(
    ("sigma", "state", "reasons"),
    [(0.0, "healthy", []), (8.0, "blind", ["no_disparities", "noise"])],
)
def test_in_noise_words_that_chance_explains_do_not_count(
    sigma: float, state: str, reasons: list[str]
) -> None:
    """Any disparity somewhere, in a tenth of the image and more, as noise makes of a plain view."""
    random = seeded(4)
    chance = np.where(
        random.random((HEIGHT, WIDTH)) < 0.14, random.integers(0, 31 * 16, (HEIGHT, WIDTH)), -16
    )
    found = judge(textured(sigma), chance.astype(np.int16))
    assert found[:2] == (state, reasons)
    assert found[2].matched_fraction == pytest.approx(0.14, abs=0.02)
    assert judge(textured(sigma), words(0.12))[0] == "healthy"  # as many that agree


@pytest.mark.parametrize(
    ("sigma", "states"), [(1.0, {"healthy"}), (8.0, {"degraded", "blind"}), (20.0, {"blind"})]
)
def test_noise_that_hides_what_there_is_to_see(sigma: float, states: set[str]) -> None:
    """A weakly textured wall, 5 grey levels of contrast, before two noisy cameras."""
    random, engine = seeded(5), StereoEngine(num_disparities=32, block_size=11)
    wall = cv2.GaussianBlur(random.normal(size=(HEIGHT, WIDTH + 12)), (0, 0), 2.0)
    wall = 100.0 + np.arange(WIDTH + 12) / 4.0 + 5.0 * wall / wall.std()
    left, right = (
        np.clip(view + random.normal(0.0, sigma, view.shape), 0, 255).astype(np.uint8)
        for view in (wall[:, :WIDTH], wall[:, 12:])
    )
    found = judge(left, engine.compute(left, right))
    assert found[0] in states
    assert ("noise" in found[1]) == (found[0] != "healthy")


LEVEL = (0.0, -1.0, 0.0)


def hidden(columns: slice, rows: slice, share: float = 0.0) -> np.ndarray:
    """Disparities everywhere but in a part of the image, where only that share of the pixels has one."""
    disparity, random = words(1.0), seeded(6)
    part = disparity[rows, columns]
    part[random.random(part.shape) >= share] = -16
    return disparity


EVERYWHERE, AHEAD = slice(None), slice(52, 108)
BELOW, ABOVE = slice(HEIGHT // 2, HEIGHT), slice(0, HEIGHT // 2)


@pytest.mark.parametrize(
    ("part", "velocity", "up", "reasons"),
    [
        ((AHEAD, BELOW), None, LEVEL, ["ground_unseen"]),
        ((AHEAD, BELOW, 0.1), None, LEVEL, ["ground_unseen"]),  # what chance finds on a plain wall
        ((AHEAD, BELOW, 0.4), None, LEVEL, []),  # ground with little texture
        ((AHEAD, BELOW), None, None, []),  # nobody knows where the horizon is
        ((AHEAD, BELOW), (4.0, 0.0, 30.0), LEVEL, []),  # flown past, to the right
        ((slice(110, WIDTH), BELOW), (4.0, 0.0, 30.0), LEVEL, ["ground_unseen"]),
        ((EVERYWHERE, ABOVE), None, LEVEL, []),  # sky
        ((EVERYWHERE, BELOW), None, (0.0, -0.8, 0.6), []),  # the horizon is below the view
        ((AHEAD, EVERYWHERE), (30.0, 0.0, 0.1), LEVEL, []),  # flown out of the view
    ],
)
def test_something_that_cannot_be_matched_hides_the_ground_ahead(
    part: tuple, velocity: tuple | None, up: tuple | None, reasons: list[str]
) -> None:
    """However much is seen beside it."""
    disparity = hidden(*part)
    found = judge(textured(), disparity, how=motion(velocity=velocity), up=up, ground_fraction=0.2)
    assert found[:2] == ("degraded" if reasons else "healthy", reasons)
    assert judge(textured(), disparity, how=motion(velocity=velocity), up=up, ground_fraction=0.0)[1] == []


def test_in_noise_the_ground_counts_where_disparities_agree() -> None:
    random = seeded(7)
    chance = np.where(random.random((HEIGHT, WIDTH)) < 0.4, random.integers(0, 31 * 16, (HEIGHT, WIDTH)), -16)
    disparity = words(1.0)
    disparity[BELOW] = chance[BELOW]
    assert judge(textured(), disparity, up=LEVEL)[1] == []
    assert judge(textured(8.0), disparity, up=LEVEL)[1] == ["ground_unseen"]


def test_every_reason_has_a_name_and_a_text() -> None:
    count = lib.VISTA_HEALTH_REASON_COUNT
    for function in (lib.vista_health_reason_name, lib.vista_health_reason_text):
        texts = {ffi.string(function(k)) for k in range(count)}
        assert len(texts) == count and all(texts) and ffi.string(function(count)) not in texts


# ---- in the chain ----


def test_the_board_flight_is_healthy_and_its_drop_out_is_not() -> None:
    pipeline = Pipeline()
    for index, source in enumerate(board_flight()):
        frame = Frame(source)
        if index == 9:
            frame.c.pose = ffi.NULL
        assert pipeline.process(frame) == "VISTA_OK"
        health = pipeline.result.health
        expected = 1 << lib.VISTA_HEALTH_MOTION_UNKNOWN if index == 9 else 0
        assert health.reasons == expected and (health.state == lib.VISTA_HEALTH_DEGRADED) == (index == 9)


@pytest.mark.parametrize("view", ["black", "lens cap"])
def test_a_covered_lens_is_blind_and_keeps_its_tracks(view: str) -> None:
    pipeline, engine, random = PythonPipeline(CALIBRATION), StereoEngine(num_disparities=64), seeded(3)
    sources = board_flight()
    poses = [Pose(scene.WORLD_FROM_CAMERA, source.position_m) for source in sources]
    for source, pose in zip(sources[:10], poses, strict=False):
        seen = pipeline.process(source.left, source.words, source.t_ns, pose)
    assert seen.health.state == "healthy"
    shape = (2, scene.HEIGHT, scene.WIDTH)
    dark = np.clip(random.normal(8.0, 0.0 if view == "black" else 3.0, shape), 0, 255).astype(np.uint8)
    covered = pipeline.process(dark[0], engine.compute(dark[0], dark[1]), sources[10].t_ns, poses[10])
    assert covered.health.state == "blind" and "no_contrast" in covered.health.reasons
    assert len(covered.health.texts) == len(covered.health.reasons)
    assert [o.id for o in covered.obstacles if o.confirmed] == [o.id for o in seen.obstacles if o.confirmed]
