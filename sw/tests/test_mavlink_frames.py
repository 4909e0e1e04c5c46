"""What a link takes: frames of a result, and what it refuses or leaves out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from board_flight import WORLD_FROM_CAMERA, board_flight
from mavlink_link import START_NS, UNKNOWN, Link, Thing, clear_sectors, obstacle_sectors
from pipeline_library import Pipeline
from stage_library import ffi, lib, status_name

AHEAD = Thing(np.array([0.0, 0.0, 10.0]))

REFUSED = {
    "min_distance_m": [0.0, -1.0, 41.0, math.nan],
    "max_distance_m": [0.0, 656.0, math.inf],
    "half_height_m": [-1.0, math.nan],
    "angle_offset_deg": [2.5, 185.0, math.nan],
    "stale_s": [0.0, 0.6, math.nan],
    "system_id": [0, 256],
    "component_id": [0, 256],
    "mount_yaw_deg": [181.0, math.nan],
    "mount_pitch_deg": [-91.0, math.inf],
    "mount_roll_deg": [math.nan],
    "autopilot": [2],
    "sectors": [2],
}


@pytest.mark.parametrize(
    "name, value", [(name, value) for name, values in REFUSED.items() for value in values]
)
def test_a_configuration_out_of_range_is_refused(name: str, value) -> None:
    assert Link("px4", changes={name: value}).status == "VISTA_ERROR_RANGE"


def test_frames_out_of_order_are_refused_and_change_nothing() -> None:
    link = Link("px4")
    assert link.update([AHEAD]) == "VISTA_OK"
    for earlier_ns in (0, 1):
        assert link.update([], 100.0, t_ns=link.now_ns - earlier_ns) == "VISTA_ERROR_ORDER"
    assert list(obstacle_sectors(link.one("OBSTACLE_DISTANCE"))) == [0]
    assert link.update([], t_ns=-1) == "VISTA_ERROR_RANGE"


def test_a_clock_that_goes_back_and_too_little_room_are_refused() -> None:
    link = Link("px4")
    link.poll()
    count, room = ffi.new("int32_t *"), ffi.new("uint8_t[]", lib.VISTA_MAVLINK_BYTES)
    for now_ns, capacity, expected in (
        (link.now_ns - 1, len(room), "ORDER"),
        (link.now_ns, len(room) - 1, "MEMORY"),
    ):
        status = lib.vista_mavlink_next(link.c, now_ns, room, capacity, count)
        assert status_name(status) == f"VISTA_ERROR_{expected}"


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_left_out_and_nothing_is_clear_then(number: float) -> None:
    link = Link("px4")
    bad = Thing(np.array([number, 0.0, 5.0]))
    link.update([bad, AHEAD], 100.0)
    message = link.one("OBSTACLE_DISTANCE")
    assert list(obstacle_sectors(message)) == [0] and not clear_sectors(message)


@pytest.mark.parametrize("number", [lib.VISTA_ID_TOO_NEAR, 1])
@pytest.mark.parametrize("far_m", [1e200, 1.7e308])
def test_what_is_absurdly_far_is_nowhere(number: int, far_m: float) -> None:
    link = Link("px4")
    assert link.update([Thing(np.array([far_m, 0.0, far_m]), id=number)], health="degraded") == "VISTA_OK"
    distances = set(link.one("OBSTACLE_DISTANCE").distances)
    assert distances <= {UNKNOWN, 30}  # what is too near to match may be in any direction


# ---- from a result of the pipeline ----


def test_a_frame_of_a_result_has_its_obstacles_in_the_camera() -> None:
    pipeline = Pipeline()
    flight = board_flight()
    pipeline.fly(flight)
    directions = ffi.new("vista_directions *")
    assert status_name(lib.vista_pipeline_directions(pipeline.handle, directions)) == "VISTA_OK"
    room = ffi.new("vista_mavlink_obstacle[]", 8)
    frame = ffi.new("vista_mavlink_frame *")
    result = pipeline.result
    status = lib.vista_mavlink_frame_of(result, directions, START_NS, room, len(room), frame)
    assert status_name(status) == "VISTA_OK"
    confirmed = [o for o in result.obstacles[0 : result.obstacle_count] if o.confirmed]
    assert frame.obstacle_count == len(confirmed) >= 1
    position_m = flight[-1].position_m
    for mine, theirs in zip(room, confirmed, strict=False):
        expected_m = WORLD_FROM_CAMERA.T @ (np.array(list(theirs.position_m)) - position_m)
        np.testing.assert_allclose(list(mine.position_camera_m), expected_m, atol=1e-9)
        assert (mine.id, mine.width_m, mine.height_m) == (theirs.id, *theirs.extent_m)
    assert frame.collision.valid and frame.collision.id == result.nearest_collision.id
    velocity_m_s = WORLD_FROM_CAMERA.T @ np.array(list(result.motion.velocity_m_s))
    np.testing.assert_allclose(list(frame.collision.velocity_camera_m_s), velocity_m_s, atol=1e-9)
    link = Link("px4")
    assert status_name(lib.vista_mavlink_update(link.c, frame)) == "VISTA_OK"
    ahead_cm = link.one("OBSTACLE_DISTANCE").distances[0]
    assert ahead_cm == pytest.approx(100 * np.linalg.norm(list(room[0].position_camera_m)), abs=60)


def test_more_obstacles_than_room_leaves_the_farthest_out() -> None:
    pipeline = Pipeline()
    pipeline.fly(board_flight())
    frame = ffi.new("vista_mavlink_frame *")
    arguments = pipeline.result, ffi.new("vista_directions *"), START_NS, ffi.NULL, 0, frame
    assert status_name(lib.vista_mavlink_frame_of(*arguments)) == "VISTA_OK"
    assert frame.obstacle_count == 0
