"""Lines of JSON in C: the numbers are those that Python writes, and nothing is written beyond its memory."""

from __future__ import annotations

import json
import math
import struct

import numpy as np
import pytest
from random_seed import seeded
from stage_library import ffi, lib, status_name

VALUES = """
    0 -0.0 -0.0004 0.0005 0.0015 1e-5 4.9e-5 1.5e-5 -2e-6 4e-7 0.5 1 -1 100 123456 2.675 1.005
    999999999.9999999 1e9 -1e9 1234567890.1234567 1e15 1e16 1.5e16 -1e17 1e22 1e23 1.7e308 5e-324
    0.30000000000000004 nan inf -inf"""


def written(value: float, digits: int) -> str:
    text, json_c = ffi.new("char[]", 400), ffi.new("vista_json *")
    json_c.text, json_c.capacity = text, 400
    lib.vista_json_put_number(json_c, value, digits)
    assert not json_c.full
    return ffi.string(text).decode()


def expected(value: float, digits: int) -> str:
    return json.dumps(round(value, digits) + 0.0 if math.isfinite(value) else None)


@pytest.mark.parametrize("value", [float(text) for text in VALUES.split()])
@pytest.mark.parametrize("digits", range(1, 7))
def test_numbers_by_hand(value: float, digits: int) -> None:
    assert written(value, digits) == expected(value, digits)


def test_numbers_at_random() -> None:
    """Numbers are of the usual size, near ties, of any size, and of any bits."""
    random = seeded(1)
    for _ in range(3000):
        digits = int(random.integers(1, 7))
        tie = (int(random.integers(-(10**6), 10**6)) + 0.5) / 10**digits
        (bits,) = struct.unpack("<d", random.bytes(8))
        large = float(random.normal()) * 10.0 ** random.uniform(-9, 20)
        for value in (float(random.normal(0, 100)), tie, float(np.nextafter(tie, 0)), bits, large):
            assert written(value, digits) == expected(value, digits), (value.hex(), digits)


def test_a_line_needs_its_room() -> None:
    """One byte less than it takes is refused, and nothing beyond is touched."""
    c_result, directions = ffi.new("vista_result *"), ffi.new("vista_directions *")
    health, length = ffi.new("vista_line_health *"), ffi.new("size_t *")
    c_result.motion.pose.rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    room = ffi.new("char[]", b"\x55" * 4000)
    assert lib.vista_line_write(c_result, directions, health, 3, 5, False, room, 4000, length) == lib.VISTA_OK
    needed = length[0] + 1
    assert json.loads(ffi.string(room))["t_ns"] == 5
    for capacity in (needed, needed - 1, needed // 2, 1, 0):
        room = ffi.new("char[]", b"\x55" * 4000)
        status = lib.vista_line_write(c_result, directions, health, 3, 5, False, room, capacity, length)
        assert status_name(status) == ("VISTA_OK" if capacity == needed else "VISTA_ERROR_MEMORY")
        assert bytes(ffi.buffer(room))[capacity:4000] == b"\x55" * (4000 - capacity)


def test_reasons_are_named_once_and_the_worse_state_counts() -> None:
    health = ffi.new("vista_line_health *")
    names = [ffi.new("char[]", f"reason_{k}".encode()) for k in range(20)]
    lib.vista_line_health_add(health, lib.VISTA_HEALTH_BLIND, names[0])
    lib.vista_line_health_add(health, lib.VISTA_HEALTH_DEGRADED, names[0])
    assert (health.state, health.reason_count) == (lib.VISTA_HEALTH_BLIND, 1)
    for name in names:
        lib.vista_line_health_add(health, lib.VISTA_HEALTH_DEGRADED, name)
    assert (health.state, health.reason_count) == (lib.VISTA_HEALTH_BLIND, lib.VISTA_LINE_REASONS)


def test_a_frame_without_directions_says_so() -> None:
    c_result, length = ffi.new("vista_result *"), ffi.new("size_t *")
    room, health = ffi.new("char[]", 4000), ffi.new("vista_line_health *")
    c_result.motion.pose.rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    status = lib.vista_line_write(c_result, ffi.NULL, health, 3, 5, False, room, 4000, length)
    assert status == lib.VISTA_OK
    assert json.loads(ffi.string(room))["directions"] is None


def test_tracks_that_are_not_confirmed_are_written_when_asked_for() -> None:
    c_result, length = ffi.new("vista_result *"), ffi.new("size_t *")
    room, health = ffi.new("char[]", 4000), ffi.new("vista_line_health *")
    c_result.motion.pose.rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    obstacles = ffi.new("vista_obstacle[]", [{"id": 1, "confirmed": True}, {"id": 2}])
    c_result.obstacles, c_result.obstacle_count = obstacles, 2
    c_result.obstacle_bytes = ffi.sizeof("vista_obstacle")
    for all_tracks, ids in ((False, [1]), (True, [1, 2])):
        status = lib.vista_line_write(c_result, ffi.NULL, health, 3, 5, all_tracks, room, 4000, length)
        assert status == lib.VISTA_OK
        assert [o["id"] for o in json.loads(ffi.string(room))["obstacles"]] == ids
