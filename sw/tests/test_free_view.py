"""Which level directions are free, against what geometry says of simple views."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from board_flight import UP_WORLD, WORLD_FROM_CAMERA, board_flight
from mavlink_link import AXES, FIRST_DEG, rotation
from pipeline_library import Pipeline
from random_seed import seeded
from stage_library import INVALID, camera, ffi, frame_view, lib, parameters, status_name, told_by
from vista.pipeline import Directions

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 640, 480, 500.0, 0.5
RADIUS_M, LENGTH_M = 2.0, 100.0
CHANGES = {"obstacle_map.collision_radius_m": RADIUS_M, "obstacle_map.collision_length_m": LENGTH_M}
LEVEL = (0.0, -1.0, 0.0)
middles_deg = FIRST_DEG + np.arange(lib.VISTA_DIRECTIONS) + 0.5
HALF_VIEW_DEG = np.degrees(np.arctan(0.5 * (WIDTH - 1) / FOCAL_PX))


def free_m(words: np.ndarray, *args, **changes) -> np.ndarray:
    return seen(words, *args, **changes)[0]


def seen(
    words: np.ndarray, verdicts=("HORIZONTAL",), regions=None, up=LEVEL, **changes: float
) -> tuple[np.ndarray, np.ndarray]:
    """free_m and blocked_m. regions: the number of each pixel's, all of them of the first unless given."""
    height, width = words.shape
    known = parameters(CHANGES | {f"obstacle_map.{name}": value for name, value in changes.items()})
    items = ffi.new("vista_region[]", len(verdicts))
    for item, name in zip(items, verdicts, strict=True):
        item.verdict = getattr(lib, f"VISTA_REGION_{name}")
    numbers = np.ascontiguousarray(np.zeros(words.shape) if regions is None else regions, np.int32)
    frame = frame_view(known, camera(width, height, FOCAL_PX, BASELINE_M), words=words, up_camera=up)
    directions = ffi.new("vista_directions *")
    told = told_by(frame, items, numbers)
    lib.vista_free_view(frame, told, directions)
    return np.array(list(directions.free_m)), np.array(list(directions.blocked_m))


def rays() -> np.ndarray:
    """(height, width, 3): unit vectors in the camera."""
    v, u = np.indices((HEIGHT, WIDTH))
    ray = np.stack([u - (WIDTH - 1) / 2, v - (HEIGHT - 1) / 2, np.full((HEIGHT, WIDTH), FOCAL_PX)], axis=-1)
    return ray / np.linalg.norm(ray, axis=-1, keepdims=True)


def word_at(z_m: float) -> int:
    return round(16 * FOCAL_PX * BASELINE_M / z_m)


FAR = np.full((HEIGHT, WIDTH), 16, np.int16)
DARK = np.full((HEIGHT, WIDTH), INVALID, np.int16)


@pytest.mark.parametrize("verdict", ["ACCEPTED", "HORIZONTAL", "TOO_FAR", "TOO_SMALL"])
def test_what_is_judged_and_far_is_free_in_the_whole_view_and_nowhere_else(verdict: str) -> None:
    inside = np.abs(middles_deg) < HALF_VIEW_DEG
    np.testing.assert_array_equal(free_m(FAR, (verdict,)), np.where(inside, LENGTH_M, 0.0))


@pytest.mark.parametrize("verdict", ["UNKNOWN", "TOO_FEW_PIXELS", "INCONSISTENT"])
def test_what_cannot_be_judged_is_not_free(verdict: str) -> None:
    assert not free_m(FAR, (verdict,)).any()


def test_without_disparities_or_regions_nothing_is_free() -> None:
    assert not free_m(DARK).any()
    assert not free_m(FAR, regions=-np.ones(FAR.shape)).any()


def test_a_board_ends_what_is_free_in_its_columns() -> None:
    random = seeded(1)
    for _ in range(10):
        z_m = random.uniform(12.0, 60.0)
        first, last = np.sort(random.uniform(-25.0, 25.0, 2))
        azimuth_deg = np.degrees(np.arctan2(rays()[..., 0], rays()[..., 2]))
        board = (azimuth_deg >= first) & (azimuth_deg <= last)
        words = np.where(board, word_at(z_m), 16).astype(np.int16)
        found, blocked_m = seen(words, ("TOO_FAR", "ACCEPTED"), board)
        # Disparities tell of depth along the axis; of what is a tenth behind a station nothing is told.
        depth_m = z_m / np.cos(np.radians(middles_deg))
        behind = (middles_deg > first + 0.2) & (middles_deg < last - 0.2)
        assert (found[behind] <= depth_m[behind] / 0.88).all()
        assert (found[behind] >= depth_m[behind] - 5.0).all()
        beside = (np.abs(middles_deg) < HALF_VIEW_DEG) & (
            (middles_deg < first - 0.2) | (middles_deg > last + 0.2)
        )
        assert (found[beside] == LENGTH_M).all()
        np.testing.assert_allclose(blocked_m[behind], depth_m[behind], rtol=0.04)
        assert not blocked_m[beside].any()


@pytest.mark.parametrize("aside_m", [3.0, -6.0])
def test_a_wall_along_the_path_blocks_each_column_where_it_is(aside_m: float) -> None:
    """Upright, at all heights; with words as an engine has them, in sixteenths of a pixel."""
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = aside_m / rays()[..., 0]
    z_m = scale * rays()[..., 2]
    on_wall = (scale > 0.0) & (z_m < 60.0)
    words = np.where(on_wall, np.round(16 * FOCAL_PX * BASELINE_M / np.where(on_wall, z_m, 1.0)), 16)
    _, blocked_m = seen(words.astype(np.int16), ("TOO_FAR", "ACCEPTED"), on_wall)
    azimuth_deg = middles_deg * np.sign(aside_m)
    within = (azimuth_deg > 7.0) & (azimuth_deg < HALF_VIEW_DEG - 1.0)
    truth_m = abs(aside_m / np.sin(np.radians(middles_deg)))
    within &= (truth_m < 50.0) & (truth_m > 6.0)
    assert within.sum() > 10
    np.testing.assert_allclose(blocked_m[within], truth_m[within], rtol=0.02)
    assert not blocked_m[middles_deg * aside_m < 0.0].any()


@pytest.mark.parametrize("roll_deg, pitch_deg", [(0.0, 0.0), (20.0, -8.0), (-30.0, 5.0), (0.0, 12.0)])
def test_directions_are_level_whatever_the_attitude(roll_deg: float, pitch_deg: float) -> None:
    """Only a band of 6 degrees about the horizon shows anything."""
    ned_from_camera = rotation(roll_deg, pitch_deg, 0.0) @ AXES
    directions = rays() @ ned_from_camera.T
    elevation_deg = np.degrees(np.arcsin(-directions[..., 2]))
    azimuth_deg = np.degrees(np.arctan2(directions[..., 1], directions[..., 0]))
    words = np.where(np.abs(elevation_deg) < 6.0, 16, INVALID).astype(np.int16)
    up = ned_from_camera.T @ [0.0, 0.0, -1.0]
    found = free_m(words, up=up)
    level = azimuth_deg[np.abs(elevation_deg) < 6.0]
    in_view = (middles_deg > level.min() + 8.0) & (middles_deg < level.max() - 8.0)
    assert in_view.sum() > 30 and (found[in_view] == LENGTH_M).all()
    outside = (middles_deg < level.min() - 1.0) | (middles_deg > level.max() + 1.0)
    assert not found[outside].any()
    if abs(roll_deg) > 10.0:
        assert (free_m(words, up=LEVEL)[in_view] < 50.0).any()


def test_a_camera_that_looks_up_or_down_has_no_level_directions() -> None:
    for up in ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)):
        assert not free_m(FAR, up=up).any()


def test_what_is_below_the_aircraft_does_not_end_what_is_free() -> None:
    v = np.indices((HEIGHT, WIDTH))[0]
    z_m = 20.0
    below = v > (HEIGHT - 1) / 2 + FOCAL_PX * 3.0 / z_m  # from 3 m below on
    words = np.where(below, word_at(z_m), 16).astype(np.int16)
    inside = np.abs(middles_deg) < HALF_VIEW_DEG - 1.0
    assert (free_m(words, ("TOO_FAR", "ACCEPTED"), below)[inside] == LENGTH_M).all()


def directions_of(pipeline: Pipeline):
    directions = ffi.new("vista_directions *")
    assert status_name(lib.vista_pipeline_directions(pipeline.handle, directions)) == "VISTA_OK"
    return directions


def test_a_flight_at_a_board_is_free_beside_it_and_not_through_it() -> None:
    *ahead, last = board_flight()[:4]
    pipeline = Pipeline()
    before = directions_of(pipeline)
    assert not before.up_known and not any(before.free_m) and not any(before.blocked_m)
    pipeline.fly(ahead)
    at_board = directions_of(pipeline)
    assert at_board.up_known
    np.testing.assert_allclose(list(at_board.up_camera), WORLD_FROM_CAMERA.T @ UP_WORLD, atol=1e-9)
    assert max(at_board.free_m) > 20.0 and max(at_board.blocked_m) > 20.0
    pipeline.fly([replace(last, words=np.full_like(last.words, INVALID))])
    unseen = directions_of(pipeline)
    assert not any(unseen.free_m) and not any(unseen.blocked_m)


def test_python_and_c_agree_on_the_columns() -> None:
    assert (Directions.FIRST_DEG, Directions.COLUMNS) == (FIRST_DEG, lib.VISTA_DIRECTIONS)


def test_null_is_refused() -> None:
    status = lib.vista_pipeline_directions(ffi.NULL, ffi.new("vista_directions *"))
    assert status_name(status) == "VISTA_ERROR_ARGUMENT"
